"""The multiverse through the DAG: the default is the study itself, and a lost specification is all that is done again."""

import shutil

import pandas as pd
import pytest

from walklab.runs.comparison import compare
from walklab.runs.io import read_record

pytestmark = pytest.mark.workflow

ARGUMENTS = ("multiverse", "--configfile", "tests/workflow/tiny.yaml")


def test_the_multiverse_contains_the_study_and_resumes(finished_copy):
    finished_copy.run("--cores", "2", *ARGUMENTS)
    folder = finished_copy.folder / "results/tiny/multiverse"
    specifications = pd.read_csv(folder / "specifications.csv")
    assert specifications["specification"].tolist() == [
        "default", "weights-inverse", "weights-uniform", "turn_exponent-low", "turn_exponent-high", "combination-00",
    ]  # fmt: skip
    assert (specifications["outcome"] == "ran").all(), specifications["reason"].tolist()
    claims = pd.read_csv(folder / "claims.csv")

    # The budget allows all walks of this study, so its own claims come out again, to the last digit.
    study = pd.read_csv(finished_copy.folder / "results/tiny/claims.csv").set_index("id")
    own = claims[(claims["specification"] == "default") & (claims["section"] != "beyond the paper")].set_index("claim")
    assert len(own) > 40
    columns = ["ours", "ours_low", "ours_high", "verdict"]
    pd.testing.assert_frame_equal(own[columns], study.loc[own.index, columns], check_names=False, check_exact=True)
    for name in ("weights-uniform", "turn_exponent-high", "combination-00"):
        other = claims[claims["specification"] == name].set_index("claim")["ours"]
        assert not other.equals(own["ours"].reindex(other.index)), f"{name} changed nothing"
    assert (folder / "figures/specification_curve.svg").stat().st_size > 5_000

    record = read_record(folder)
    assert record["run"] == "multiverse"
    assert {stage["part"] for stage in record["stages"] if stage["stage"] == "evaluate_specification"} == set(
        specifications["specification"]
    )
    assert {"claims.csv", "specifications.csv", "summary.csv", "figures/specification_curve.svg"} == set(record["products"])
    other = compare(read_record(finished_copy.folder / "results/tiny"), record)
    assert other.config.empty, "the same configuration"

    before = finished_copy.checksums()
    shutil.rmtree(folder / "evaluate_specification/turn_exponent-low")
    for path in folder.iterdir():  # Snakemake misses no intermediate file while what was made from it is there
        if path.name not in {"list_specifications", "record_population", "evaluate_specification"}:
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    output = finished_copy.run("--cores", "1", *ARGUMENTS)
    assert finished_copy.checksums() == before
    assert "record population" not in output
