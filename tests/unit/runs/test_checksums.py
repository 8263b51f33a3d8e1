"""Whatever happens to a product's bytes is found, named and told apart from what is whole."""

import os
import subprocess

import pytest

from walklab.errors import InputError
from walklab.runs import checksums


@pytest.fixture
def run(tmp_path):
    """A stage with a sharded job, and one whose products are shown at the top of the run."""
    stage = tmp_path / "0/score_maps/1"
    stage.mkdir(parents=True)
    (stage / "maps.nc").write_bytes(bytes(range(256)))
    checksums.record([stage / "maps.nc"], stage)
    (tmp_path / "0/check_claims").mkdir()
    (tmp_path / "claims.csv").write_text("id\n1\n")
    checksums.record([tmp_path / "claims.csv"], tmp_path / "0/check_claims")
    return tmp_path


def test_whole_files_pass(run):
    checksums.verify([run / "0/score_maps/1/maps.nc", run / "claims.csv"])
    found = checksums.inspect(run)
    assert (found.checked, found.damaged, found.missing, found.half_written) == (2, (), (), ())


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


def test_a_missing_product_and_a_half_written_file_are_reported(run):
    (run / "claims.csv").unlink()
    (run / ".claims.a1b2c3d4.csv").write_text("half")
    found = checksums.inspect(run)
    assert found.missing == (str(run / "claims.csv"),)
    assert (found.checked, found.damaged) == (1, ())
    assert found.half_written == (str(run / ".claims.a1b2c3d4.csv"),)


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
