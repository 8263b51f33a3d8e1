"""A run's RO-Crate: what is in it, and that the profile's own validator accepts it."""

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("rocrate", reason="the extra walklab[tracking] is not installed")

from walklab.errors import InputError
from walklab.runs.checksums import sha256
from walklab.runs.crate import PROFILES, write_crate

ROOT = Path(__file__).parents[3]
VALIDATOR = ROOT / ".venv/validator/bin/python"


@pytest.fixture
def recording(tmp_path, monkeypatch) -> Path:
    """The only recording under WALKLAB_DATA."""
    path = tmp_path / "data/maroger_laas/human_float32.npz"
    path.parent.mkdir(parents=True)
    path.write_bytes(b"walks")
    monkeypatch.setenv("WALKLAB_DATA", str(tmp_path / "data"))
    return path


@pytest.fixture
def crate(run, recording, tmp_path) -> Path:
    assert write_crate(run, ROOT, tmp_path / "study.crate.zip") == 4
    with zipfile.ZipFile(tmp_path / "study.crate.zip") as packed:
        packed.extractall(tmp_path / "crate")
    return tmp_path / "crate"


def test_workflow_configuration_and_products_are_in_it(crate, recording):
    graph = {entity["@id"]: entity for entity in json.loads((crate / "ro-crate-metadata.json").read_text())["@graph"]}
    assert {entry["@id"] for entry in graph["./"]["conformsTo"]} >= set(PROFILES)
    assert graph["./"]["mainEntity"] == {"@id": "Snakefile"}
    assert (crate / "workflow/rules/common.smk").is_file()
    assert json.loads((crate / "configuration.json").read_text())["model"] == {"k": 100}
    action = next(entity for entity in graph.values() if entity["@type"] == "CreateAction")
    assert action["instrument"] == {"@id": "Snakefile"}
    given = [graph[entry["@id"]] for entry in action["object"]]
    assert given[0]["@id"] == "configuration.json"
    named = {entry["name"]: entry["value"] for entry in given[1:]}
    assert named == {
        "config/scenes/scenario_1.yaml": sha256(ROOT / "config/scenes/scenario_1.yaml"),
        "maroger_laas/human_float32.npz": sha256(recording),
    }
    assert not list(crate.rglob(recording.name)), "recordings are of people"
    made = {entry["@id"] for entry in action["result"]}
    assert made == {"results/claims.csv", "results/scores.csv", "results/run.json", "results/figures/fig11.svg"}
    assert all((crate / path).is_file() for path in made)


def test_what_the_packed_workflow_needs_is_in_it(crate):
    """The packed Snakefile finds its rules, scripts and the package: Snakemake plans the study with nothing else."""
    assert not list(crate.rglob("*.egg-info"))
    planned = subprocess.run(
        [sys.executable, "-m", "snakemake", "--dry-run", "--quiet", "rules", "--cores", "1", "--configfile", "config/small.yaml"],
        cwd=crate,
        env={**os.environ, "PYTHONPATH": str(crate / "src")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert planned.returncode == 0, planned.stdout + planned.stderr


def test_the_code_of_another_commit_is_not_packed(run, tmp_path):
    record = json.loads((run / "run.json").read_text())
    record["commit"] = {"id": "0" * 40, "dirty": False}
    (run / "run.json").write_text(json.dumps(record))
    with pytest.raises(InputError, match=r"made by 000000000000, but the checkout is at .* --root"):
        write_crate(run, ROOT, tmp_path / "study.crate.zip")
    assert not (tmp_path / "study.crate.zip").exists()


@pytest.mark.parametrize(
    ("ran", "now", "told"),
    [
        (False, False, "The code of commit 12."),
        (True, False, "when the run was made: this may"),
        (True, True, "when the run was made and when it was packed: this may"),
    ],
)
def test_a_crate_tells_whether_files_differed_from_the_commit(ran, now, told, run, tmp_path, monkeypatch):
    record = json.loads((run / "run.json").read_text())
    record["commit"] = {"id": "12", "dirty": ran}
    (run / "run.json").write_text(json.dumps(record))
    monkeypatch.setattr("walklab.runs.crate.commit", lambda root: {"id": "12", "dirty": now})
    write_crate(run, ROOT, tmp_path / "study.crate.zip")
    with zipfile.ZipFile(tmp_path / "study.crate.zip") as packed:
        graph = json.loads(packed.read("ro-crate-metadata.json"))["@graph"]
    workflow = next(entity for entity in graph if entity["@id"] == "Snakefile")
    assert workflow["version"] == "12"
    assert told in workflow["description"]


@pytest.mark.skipif(not VALIDATOR.exists(), reason="the validator is not installed: `make .venv/validator/ready`")
def test_the_profiles_validator_accepts_it(crate):
    done = subprocess.run([VALIDATOR, Path(__file__).parent / "validate_crate.py", crate], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(not VALIDATOR.exists(), reason="the validator is not installed: `make .venv/validator/ready`")
def test_the_validator_would_notice_a_missing_instrument(crate):
    path = crate / "ro-crate-metadata.json"
    described = json.loads(path.read_text())
    for entity in described["@graph"]:
        entity.pop("instrument", None)
    path.write_text(json.dumps(described))
    done = subprocess.run([VALIDATOR, Path(__file__).parent / "validate_crate.py", crate], capture_output=True, text=True)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "instrument" in done.stdout
