"""What docs/evidence.md is given: tables and sentences of made-up runs, by the numbers in them."""

from pathlib import Path
from types import ModuleType

import pandas as pd
import pytest
from loading import module_at

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def told() -> ModuleType:
    return module_at(ROOT / "workflow/evidence_forecasts.py")


def pooled(measure: str, model: str, value: float, against: str = "", below_zero: int = 0) -> dict:
    row = {"scenario": "scenario_1", "hull": "all", "measure": measure, "model": model, "against": against}
    return row | {"value": value, "low": value - 0.01, "high": value + 0.01, "below_zero": below_zero, "replicates": 3}


def test_populations_name_the_best_baseline_and_count_who_kept_the_goal(told, tmp_path):
    rows = [
        pooled("crps_s", "P_Stat with residual spread", 0.2),
        pooled("crps_s", "Gaussian process", 0.15),
        pooled("crps_s", "P_Prob (extended)", 0.1),  # no baseline
        pooled("crps_difference_s", "P_Prob (calibrated)", 0.02, "Gaussian process", 1),
        pooled("crps_difference_s", "P_Prob (extended)", -0.05, "Gaussian process", 3),
        pooled("crps_difference_s", "P_Prob (extended)", -0.1, "P_Stat with residual spread", 3),
        pooled("energy_m", "P_Stat with residual spread", 0.01),  # simulates
        pooled("energy_m", "Gaussian process", 0.07),
        pooled("energy_m", "regression", 0.08),
        pooled("energy_m", "regression, earlier walks", 0.06),  # knows more
        pooled("energy_difference_m", "P_Prob (extended)", -0.0104, "Gaussian process", 3),
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "scores.csv")
    for number, share in enumerate((0.85, 0.9, 0.94)):
        folder = tmp_path / str(number) / "score_forecasts"
        folder.mkdir(parents=True)
        row = {"scenario": "scenario_1", "hull": "all", "model": "P_Prob (calibrated)", "coverage_90": share}
        pd.DataFrame([row, row | {"hull": "inside"}, row | {"model": "P_Stat with residual spread"}]).to_csv(
            folder / "scores.csv"
        )
    text = told.replicated_findings(tmp_path)
    assert "the best baseline by its mean CRPS is Gaussian process (0.150 s)" in text
    assert "P_Prob (calibrated) loses: +0.020 s [+0.010, +0.030], less in 1 of 3 populations" in text
    assert "P_Prob (extended) wins: -0.050 s [-0.060, -0.040], less in 3 of 3 populations" in text
    first, second = text.split("\n")
    assert first.endswith("held 86 to 94 % of the walks in 2 of 3 populations.")
    assert "walked in a forecast time, that of Gaussian process is best (0.0700 m)" in second
    assert second.endswith("P_Prob (extended) wins: -0.0104 m [-0.0204, -0.0004], less in 3 of 3 populations.")


def test_populations_tell_who_leans_and_whose_intervals_are_too_wide(told, tmp_path):
    models = ("P_Prob (calibrated)", "P_Prob (extended)", "quadratic log regression", "Gaussian process")
    pd.DataFrame([pooled("bias_s", model, -0.1) for model in models]).to_csv(tmp_path / "scores.csv")
    for number, share in enumerate((0.85, 0.90, 0.95, 0.96)):
        folder = tmp_path / str(number) / "score_forecasts"
        folder.mkdir(parents=True)
        rows = [{"scenario": "scenario_1", "hull": "all", "model": model, "coverage_90": share} for model in models]
        pd.DataFrame(rows).to_csv(folder / "scores.csv")
    row = told.replicated_leans(tmp_path).split("\n")[2]
    assert row == "| P_Prob (calibrated) | -0.100 [-0.110, -0.090] | 91.5 (1 / 1 / 2) |"


def test_the_multiverse_counts_what_holds_everywhere(told, tmp_path):
    names = ["claim", "statement", "specifications", "held", "held_share", "default", "smallest", "largest"]
    rows = [
        ("a", "a", 4, 4, 1.0, 1, 1, 1),
        ("b", "b", 4, 0, 0.0, 1, 1, 1),
        ("crps_reduction_scenario_1", "scenario_1: reduction", 4, 1, 0.25, -0.1, -0.4, 0.2),
    ]
    pd.DataFrame(rows, columns=names).to_csv(tmp_path / "summary.csv")
    first, second = told.multiverse_findings(tmp_path).split("\n")
    assert first == "- Of 3 claims 1 hold in every specification, 1 in none; 1 depend on what is chosen."
    assert second == "- scenario 1: reduction: -0.10 by default, from -0.40 to +0.20 over all; above 0 in 1 of 4."


def test_real_walks_are_ranked_without_the_error_floor(told, tmp_path):
    names = ["model", "kind", "crps_s", "crps_minus_reference_s", "crps_minus_reference_s_low", "crps_minus_reference_s_high"]
    rows = [
        ("climatology", "forecast", 0.5, 0.0, 0.0, 0.0),
        ("P_Stat with residual spread", "forecast", 0.3, -0.2, -0.3, -0.1),
        ("task speeds alone", "forecast", 0.2, -0.3, -0.7, 0.1),
        ("best cell", "error floor", 0.01, float("nan"), float("nan"), float("nan")),
    ]
    table = pd.DataFrame(rows, columns=names).assign(walks=47, participants=10, reference="climatology", energy_m=float("nan"))
    table = table.assign(coverage_50=0.4, coverage_80=0.7, coverage_90=0.9, coverage_95=1.0, bias_s=-0.1, median_abs_dt_s=0.25)
    table.assign(crps_s_low=table["crps_s"], crps_s_high=table["crps_s"]).to_csv(tmp_path / "summary.csv")
    text = told.real(tmp_path)
    assert "47 walks of 10 people. The smallest mean CRPS has task speeds alone." in text
    assert "excludes zero: P_Stat with residual spread." in text
    assert "| 40 / 70 / 90 / 100 | -0.10 | 0.25 |" in text
    assert "best cell" not in text


def test_significant_pairs_are_told_by_who_is_ahead(told, tmp_path):
    names = ["scenario", "hull", "first", "second", "mean_difference_s", "p_participants_holm", "p_mixed_holm"]
    rows = [
        ("scenario_1", "all", "regression", "P_Prob (extended)", 0.05, 0.01, 0.2),
        ("scenario_1", "all", "P_Stat with residual spread", "P_Prob (literal)", -0.1, 0.3, 0.001),
        ("scenario_1", "inside", "P_Stat with residual spread", "P_Prob (literal)", -0.1, 0.001, 0.001),
    ]
    table = pd.DataFrame(rows, columns=names).assign(mean_difference_s_low=0, mean_difference_s_high=0, power_are=1)
    table = table.assign(power_participants=1, size_walks=[0.2, 0.4, 0.9], size_participants=0.05)
    table = table.assign(size_mixed=[0.04, 0.06, 0.5], power_mixed=[0.3, 0.9, 0.1])
    table = table.assign(participants=10, p_participants_holm_floor=0.0039)
    (tmp_path / "0/compare_forecasts").mkdir(parents=True)
    table.to_csv(tmp_path / "0/compare_forecasts/tests.csv")
    *_, floor, sizes, power, by_mixed, by_people = told.pairs(tmp_path).split("\n")
    assert "over all 2 pairs" in floor
    assert "means of 10 people cannot go below 0.0039 after it" in floor
    assert "rejects in 20 to 40 %" in sizes
    assert "the mixed model in 4 to 6 %" in sizes
    assert power.endswith("with power 0.30 to 0.90; at least 0.8 for 1 of 2 pairs.")
    table.to_csv(tmp_path / "0/compare_forecasts/trial_tests.csv")
    trials = told.trial_pairs(tmp_path)
    assert "abs. dt, first - second (s)" in trials
    assert trials.endswith("nothing.")
    assert by_people.endswith("participants' means: P_Prob (extended) before regression in scenario 1 (0.01).")
    assert by_mixed.endswith("the mixed model: P_Stat with residual spread before P_Prob (literal) in scenario 1 (0.001).")

    inside, outside = told.split_pairs(tmp_path).split("\n")
    assert "(people: 10 in scenario 1), significant after Holm: P_Stat with residual spread before P_Prob (literal)" in inside
    assert outside.endswith("nothing.")


def test_scores_are_split_by_the_training_range(told, tmp_path):
    rows = [
        (hull, model, crps, crps, crps, coverage, walks)
        for hull, walks in (("all", 9), ("inside", 3), ("outside", 6))
        for model, crps, coverage in (
            ("P_Stat with residual spread", 0.2, 0.5),
            ("best cell of the walk's own map", walks / 100, 0.0),
        )
    ]
    names = ["hull", "model", "crps_s", "crps_s_low", "crps_s_high", "coverage_90", "walks"]
    pd.DataFrame(rows, columns=names).assign(scenario="scenario_1", participants=4).to_csv(tmp_path / "scores.csv")
    header, _, static, oracle = told.split(tmp_path).split("\n")
    assert "scenario 1, inside (3 walks of 4 people) | scenario 1, outside (6 walks of 4 people)" in header
    assert static == "| P_Stat with residual spread | 0.200 [0.200, 0.200] | 0.200 [0.200, 0.200] | 50 / 50 |"
    assert oracle.endswith("| 0.030 [0.030, 0.030] | 0.060 [0.060, 0.060] | - |")


def test_the_page_has_a_place_for_every_table():
    tables = (ROOT / "workflow/evidence.py").read_text().split("TABLES = {")[1].split("\n}")[0]
    page = (ROOT / "docs/evidence.md").read_text()
    names = [line.split('"')[1] for line in tables.splitlines() if '"' in line]
    assert len(names) > 10
    assert [name for name in names if f"<!-- {name} -->" not in page or f"<!-- /{name} -->" not in page] == []
