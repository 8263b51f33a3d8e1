"""Recovery of a known distribution as its users run it."""

import pandas as pd
import pytest

from walklab.runs.io import read_record

pytestmark = pytest.mark.workflow


def test_recovery_needs_no_captured_walk_and_leaves_its_table_and_figure(project):
    project.run("recovery", "--cores", "2", "--configfile", "tests/workflow/tiny.yaml", "--config", "run=recovery")
    results = project.folder / "results/recovery"
    table = pd.read_csv(results / "recovery.csv")
    assert set(table[["walks", "resolution"]].itertuples(index=False, name=None)) == {(24, 4), (48, 4), (24, 3)}
    assert set(table["measure"]) == {"ks", "bias", "spread", "energy"}
    assert table.loc[table["measure"] == "ks", "value"].between(0, 1).all()
    assert (results / "figures/recovery.png").stat().st_size > 5_000
    record = read_record(results)
    assert {stage["stage"] for stage in record["stages"]} == {"recover_distribution", "draw_recovery", "record_run"}
    assert {"recovery.csv", "figures/recovery.svg"} <= set(record["products"])
    assert not list(results.rglob("walks.parquet")), "planner walks are never stored as captured ones"
