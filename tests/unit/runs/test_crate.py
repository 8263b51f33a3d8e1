"""A run's RO-Crate: what is in it, and that the profile's own validator accepts it."""

import json
import subprocess
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("rocrate", reason="the extra walklab[tracking] is not installed")

from walklab.runs.crate import PROFILES, write_crate

ROOT = Path(__file__).parents[3]
VALIDATOR = ROOT / ".venv/validator/bin/python"


@pytest.fixture
def crate(run, tmp_path) -> Path:
    assert write_crate(run, ROOT, tmp_path / "study.crate.zip") == 4
    with zipfile.ZipFile(tmp_path / "study.crate.zip") as packed:
        packed.extractall(tmp_path / "crate")
    return tmp_path / "crate"


def test_workflow_configuration_and_products_are_in_it(crate):
    graph = {entity["@id"]: entity for entity in json.loads((crate / "ro-crate-metadata.json").read_text())["@graph"]}
    assert {entry["@id"] for entry in graph["./"]["conformsTo"]} >= set(PROFILES)
    assert graph["./"]["mainEntity"] == {"@id": "Snakefile"}
    assert (crate / "workflow/rules/common.smk").is_file()
    assert json.loads((crate / "configuration.json").read_text())["model"] == {"k": 100}
    action = next(entity for entity in graph.values() if entity["@type"] == "CreateAction")
    assert action["instrument"] == {"@id": "Snakefile"}
    assert action["object"] == [{"@id": "configuration.json"}]
    made = {entry["@id"] for entry in action["result"]}
    assert made == {"results/claims.csv", "results/scores.csv", "results/run.json", "results/figures/fig11.svg"}
    assert all((crate / path).is_file() for path in made)


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
