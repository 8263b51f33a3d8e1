"""Every configuration that ships plans the files that a reader is told to look for."""

import os
from pathlib import Path

import pytest

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).parents[2]

# Arguments, folder under results, and files in it.
PROMISED = {
    "study": (
        (),
        "steering",
        (
            *("claims.csv", "scores.csv", "calibration.csv", "realism.csv", "run.json", "report.html"),
            *(f"figures/{name}.svg" for name in ("scores", "calibration", "pit", "realism", "fig15")),
        ),
    ),
    "replicates": (("--configfile", "config/replicates.yaml"), "replicates", ("claims.csv", "scores.csv", "run.json")),
    "multiverse": (("multiverse",), "multiverse", ("claims.csv", "run.json", "figures/specification_curve.svg")),
    "recovery": (
        ("recovery", "--configfile", "config/recovery.yaml"),
        "recovery",
        ("recovery.csv", "run.json", "figures/recovery.svg"),
    ),
    "cmu": (("--configfile", "config/cmu.yaml"), "cmu", ("scores.csv", "figures/scores.svg", "run.json", "report.html")),
    "resampled": (("--configfile", "config/resampled.yaml"), "resampled", ("claims.csv", "scores.csv", "verdicts.csv")),
}
RECORDED = {"cmu": "cmu_walk_amc", "resampled": ""}  # what must be under WALKLAB_DATA


@pytest.mark.parametrize("name", PROMISED)
def test_a_shipped_configuration_plans_what_is_promised(name, project, monkeypatch):
    data = Path(os.environ.get("WALKLAB_DATA", ROOT / "../shared/data")).resolve()
    monkeypatch.setenv("WALKLAB_DATA", str(data))
    if name in RECORDED and not (data / RECORDED[name]).is_dir():
        pytest.skip(f"no recordings: {data / RECORDED[name]} does not exist; set WALKLAB_DATA")
    if name == "resampled":  # it is compared with a run of the study
        compared = project.folder / "results/steering/claims.csv"
        compared.parent.mkdir(parents=True)
        compared.write_text("id\n")
    arguments, folder, files = PROMISED[name]
    rows = [line.split("\t") for line in project.run(*arguments, "--summary").splitlines()]
    planned = {row[0] for row in rows if row[-1] == "update pending"}
    assert {f"results/{folder}/{file}" for file in files} <= planned
