"""Whatever happens to a product's bytes is found, named and told apart from what is whole."""

import os
import re
import subprocess
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from walklab.cli.app import app
from walklab.errors import InputError
from walklab.runs import checksums, cost
from walklab.runs.io import NEEDED
from walklab.storage import write_json

MAPS, CLAIMS = "0/score_maps/1/maps.nc", "claims.csv"
JOBS = {MAPS: "0/score_maps/1", CLAIMS: "0/check_claims"}


def leave(product, folder):
    """What a job leaves when it has written a product."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "log.txt").touch()
    checksums.record([product], folder)
    cost.write(folder)


@pytest.fixture
def run(tmp_path):
    """A stage with a sharded job, and one whose products are shown at the top of the run."""
    (tmp_path / MAPS).parent.mkdir(parents=True)
    (tmp_path / MAPS).write_bytes(bytes(range(256)))
    (tmp_path / CLAIMS).write_text("id\n1\n")
    for product, folder in JOBS.items():
        leave(tmp_path / product, tmp_path / folder)
    return tmp_path


def check(run):
    """Exit code and output of ``walklab check``."""
    done = CliRunner().invoke(app, ["check", str(run)])
    return done.exit_code, done.output


def test_whole_files_pass(run):
    checksums.verify([run / "0/score_maps/1/maps.nc", run / "claims.csv"])
    found = checksums.inspect(run)
    assert found == checksums.Inspection(2, (), (), 0, ())


@pytest.mark.parametrize("name", ["0/score_maps/1/maps.nc", "claims.csv"])
@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda content: content[:-1], "not what was written"),
        (lambda content: bytes([content[0] ^ 128]) + content[1:], "not what was written"),
        (lambda content: b"", "empty"),
    ],
)
def test_damage_is_named_in_one_line_with_what_to_type(run, name, damage, reason):
    path = run / name
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(InputError, match=rf"{name}: damaged .*{reason}.*snakemake --forcerun .*{name}") as caught:
        checksums.verify([path])
    assert "\n" not in str(caught.value)
    (found,) = checksums.inspect(run).damaged
    assert found.path == str(path)
    assert reason in found.reason


def test_every_single_flipped_bit_is_found(run):
    path = run / "0/score_maps/1/maps.nc"
    whole = path.read_bytes()
    for bit in range(0, 8 * len(whole), 7):
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        with pytest.raises(InputError):
            checksums.verify([path])


def test_a_file_that_no_job_wrote_is_not_verified(run):
    (run / "own.csv").write_text("whatever")
    checksums.verify([run / "own.csv"])


@pytest.mark.parametrize("name", ["specifications.csv", "figures/specification_curve.svg"])
def test_what_a_stage_without_replicates_shows_at_the_top_is_verified_too(name, tmp_path):
    product, stage = tmp_path / name, tmp_path / "collect_specifications"
    stage.mkdir()
    product.parent.mkdir(exist_ok=True)
    product.write_text("whole")
    checksums.record([product], stage)
    checksums.verify([product])
    product.write_text("damaged")
    with pytest.raises(InputError, match=f"{name}: damaged"):
        checksums.verify([product])


@pytest.mark.parametrize("stage", ["0/publish_scores", "12/count_claims"])
def test_a_product_that_another_rule_writes_now_is_no_damage(run, stage):
    (run / stage).mkdir(parents=True)
    (run / "claims.csv").write_text("id\n2\n")
    checksums.record([run / "claims.csv"], run / stage)
    checksums.verify([run / "claims.csv"])
    assert checksums.inspect(run).damaged == ()


LOSSES = {
    "emptied checksums": lambda manifest: manifest.write_text(""),
    "cut off checksums": lambda manifest: manifest.write_bytes(manifest.read_bytes()[:40]),
    "garbled checksums": lambda manifest: manifest.write_bytes(b"\xff" * 80),
    "removed checksums": lambda manifest: manifest.unlink(),
}


@pytest.mark.parametrize("product", JOBS)
@pytest.mark.parametrize("loss", LOSSES)
def test_lost_checksums_are_damage_too(loss, product, run):
    manifest = run / JOBS[product] / checksums.MANIFEST
    LOSSES[loss](manifest)
    with pytest.raises(InputError, match=rf"{product}: damaged .*{manifest}.*snakemake --forcerun .*{product}"):
        checksums.verify([run / product])
    exit_code, told = check(run)
    assert exit_code == 1
    assert f"{manifest}: " in told
    assert f"--forcerun {JOBS[product].split('/')[1]}\n" in told


def test_all_checksums_removed_is_damage(run):
    for manifest in run.rglob(checksums.MANIFEST):
        manifest.unlink()
    assert check(run)[0] == 1


def test_checksums_of_someone_elses_data_are_left_to_them(tmp_path):
    (tmp_path / "walks.csv").write_text("whatever")
    (tmp_path / checksums.MANIFEST).write_text("d41d8cd98f00b204e9800998ecf8427e  walks.csv\n")
    checksums.verify([tmp_path / "walks.csv"])


def test_what_the_record_lists_is_checked_too(run):
    products = {CLAIMS: checksums.sha256(run / CLAIMS), "figures/fig11.svg": "0" * 64}
    write_json({key: kinds[0]() for key, kinds in NEEDED.items()} | {"products": products}, run / "run.json")
    assert checksums.inspect(run).missing == (str(run / "figures/fig11.svg"),)
    (run / JOBS[CLAIMS] / checksums.MANIFEST).unlink()
    (run / CLAIMS).write_text("id\n3\n")
    assert str(run / CLAIMS) in {damage.path for damage in checksums.inspect(run).damaged}


def test_a_missing_product_and_a_half_written_file_are_named(run):
    (run / CLAIMS).unlink()
    (run / ".claims.a1b2c3d4.csv").write_text("half")
    found = checksums.inspect(run)
    assert (found.checked, found.damaged) == (1, ())
    exit_code, told = check(run)
    assert exit_code == 1
    assert f"{run / CLAIMS}: missing" in told
    assert f"{run / '.claims.a1b2c3d4.csv'}: left by a job that was killed" in told
    assert f"--forcerun {run / CLAIMS}\n" in told


@pytest.mark.parametrize(("replicate", "exit_code"), [("0", 1), ("1", 0), ("12", 0)])
def test_only_of_many_populations_are_bulky_files_temporary(replicate, exit_code, run):
    for product in ("record_training/0/recording.parquet", "record_scenario/scenario_1/poses.parquet"):
        path = run / replicate / product
        path.parent.mkdir(parents=True)
        path.write_text("bulky")
        leave(path, path.parent)
        path.unlink()
    assert check(run)[0] == exit_code


def test_the_bulky_files_are_those_of_the_rules():
    rules = "".join(path.read_text() for path in (Path(__file__).parents[3] / "workflow/rules").glob("*.smk"))
    bulky = re.findall(r'bulky\(\s*stage\(\s*"(\w+)", "([\w.]+)"', rules)
    assert len(bulky) == rules.count("bulky(") - 1, "all but its definition"
    assert all(checksums.TEMPORARY.search(f"results/replicates/3/{stage}/0/{file}") for stage, file in bulky)


def test_a_checkout_is_no_run(run):
    """``walklab check .`` looks into the runs below, and leaves everything else alone."""
    ours = ("0/score_maps/1/log.txt", MAPS, f"{JOBS[MAPS]}/{checksums.MANIFEST}")
    others = (".gitignore", ".pre-commit-config.yaml", ".venv/lib/log.txt", ".venv/lib/.x.a1b2c3d4.py", "notes.txt")
    for name in others:
        (run / name).parent.mkdir(parents=True, exist_ok=True)
        (run / name).touch()
    future = time.time() + 3600
    for name in (*others, *ours):
        os.utime(run / name, (future, future))
    exit_code, told = check(run)
    assert exit_code == 0
    assert not [name for name in others if name in told]
    dated = {line.split(": ")[0] for line in told.splitlines() if "was dated in the future" in line}
    assert dated == {str(run / name) for name in ours}


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(InputError, match="folder of a run"):
        checksums.inspect(tmp_path)


def test_the_files_are_those_of_sha256sum(run):
    subprocess.run(["sha256sum", "--check", "--strict", checksums.MANIFEST], cwd=run / "0/check_claims", check=True)


def test_only_files_from_the_future_are_dated_back(run):
    now = 1_000_000_000.0
    for path in run.rglob("*"):
        os.utime(path, (now, now))
    late = run / "claims.csv"
    os.utime(late, (now + 3600, now + 3600))
    assert checksums.date_back(run, now) == [str(late)]
    assert late.stat().st_mtime == now
    assert checksums.date_back(run, now) == []
