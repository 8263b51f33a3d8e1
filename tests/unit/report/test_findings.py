"""The sentences name whom the tables name, with the tables' numbers."""

import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.report.findings import forecast_findings, real_findings, realism_findings


def scores(calibrated: float = 0.3, coverage: float = 0.85) -> pd.DataFrame:
    values = {
        "P_Stat with residual spread": 0.25,
        "Gaussian process": 0.2,
        "P_Prob (calibrated)": calibrated,
        "P_Prob (extended)": 0.15,
    }
    values |= {
        "P_Prob (extended), earlier walks": 0.08,
        "log regression, earlier walks": 0.07,
        "best cell of the walk's own map": 0.01,
    }
    rows = [("scenario_1", "all", name, crps, crps - 0.01, crps + 0.01, coverage) for name, crps in values.items()]
    rows += [("scenario_1", "inside", "P_Stat with residual spread", 0.001, 0.0, 0.1, 0.9)]  # a part of the walks: not asked
    names = ["scenario", "hull", "model", "crps_s", "crps_s_low", "crps_s_high", "coverage_90"]
    return pd.DataFrame(rows, columns=names).assign(bias_s=lambda table: table["crps_s"] - 0.22)


def pairs(difference: float, low: float, high: float) -> pd.DataFrame:
    """Tests of all pairs that are told; that of the Gaussian process and P_Prob (calibrated) as given."""
    names = ["scenario", "hull", "first", "second", "mean_difference_s", "mean_difference_s_low", "mean_difference_s_high"]
    rows = [
        ("scenario_1", "all", "Gaussian process", "P_Prob (calibrated)", difference, low, high),
        ("scenario_1", "all", "Gaussian process", "P_Prob (extended)", 0.05, 0.04, 0.06),
        ("scenario_1", "all", "log regression, earlier walks", "P_Prob (extended), earlier walks", -0.01, -0.02, 0.0),
        ("scenario_1", "inside", "Gaussian process", "P_Prob (calibrated)", 9.0, 9.0, 9.0),
    ]
    floor = {"participants": 10, "p_participants_holm_floor": 0.1}
    return pd.DataFrame(rows, columns=names).assign(p_participants_holm=0.25, p_mixed_holm=0.031, **floor)


def test_the_winner_is_named_with_the_difference_and_its_interval():
    first, *_ = forecast_findings(scores(), pairs(-0.1, -0.17, -0.02))
    assert "best baseline that knows only the task is Gaussian process (CRPS 0.200 s [0.190, 0.210])" in first
    assert "P_Prob (calibrated) has 0.300 s [0.290, 0.310], worse by 0.100 s [0.020, 0.170], which excludes zero" in first
    assert "(p after Holm: 0.031 by the mixed model, 0.25 by the exact test on the means of 10 people, whose smallest" in first
    assert "whose smallest possible is 0.1)" in first
    assert "captured time: -0.02 s (Gaussian process), +0.08 s (P_Prob (calibrated)), -0.07 s (P_Prob (extended))." in first
    assert "P_Prob (extended) has 0.150 s [0.140, 0.160], better by 0.050 s [0.040, 0.060], which excludes zero" in first


def test_trajectories_are_held_against_the_planned_route():
    table = scores().assign(energy_minus_regression_m=0.0, energy_minus_regression_m_low=0.0, energy_minus_regression_m_high=0.0)
    for name, values in (("P_Prob (calibrated)", (0.004, 0.001, 0.007)), ("P_Prob (extended)", (-0.003, -0.007, 0.002))):
        table.loc[(table["model"] == name) & (table["hull"] == "all"), table.columns[-3:]] = values
    found = forecast_findings(table, pairs(-0.1, -0.17, -0.02))[-1]
    assert "that of P_Prob (calibrated) is more by 0.0040 m [0.0010, 0.0070], which excludes zero" in found
    assert "that of P_Prob (extended) is less by 0.0030 m [-0.0020, 0.0070], which includes zero" in found


def test_a_pair_that_was_not_tested_is_an_error_and_not_left_out():
    with pytest.raises(InputError, match="0 rows of Gaussian process against"):
        forecast_findings(scores(), pairs(-0.1, -0.17, -0.02).iloc[1:])
    assert "P_Prob (extended) has 0.150 s [0.140, 0.160], better by 0.050 s." in forecast_findings(scores(), None)[0]


def test_an_interval_across_zero_is_said_to_be_so():
    assert "worse by 0.100 s [-0.010, 0.170], which includes zero" in forecast_findings(scores(), pairs(-0.1, -0.17, 0.01))[0]


def test_a_model_that_wins_is_better():
    assert "better by 0.100 s [0.020, 0.170], which excludes zero" in forecast_findings(scores(0.1), pairs(0.1, 0.02, 0.17))[0]


def test_a_model_of_one_time_has_the_spread_of_its_residuals():
    without = scores().query("model != 'Gaussian process'")
    assert "is P_Stat with residual spread (CRPS 0.250 s" in forecast_findings(without, None)[0]


@pytest.mark.parametrize(("coverage", "place"), [(0.85, "outside"), (0.86, "inside"), (0.94, "inside"), (0.95, "outside")])
def test_coverage_is_held_against_the_goal(coverage, place):
    text = forecast_findings(scores(coverage=coverage), None)[-1]
    assert f"{100 * coverage:.1f} % of the walks of scenario 1 ({place}); the goal is 86 to 94 %" in text


def test_those_who_know_the_person_are_compared_with_their_like():
    text = forecast_findings(scores(), None)[1]
    assert (
        "0.080 s [0.070, 0.090] in scenario 1 against 0.070 s [0.060, 0.080] of log regression, earlier walks, worse by 0.010 s"
        in text
    )


def test_another_table_says_nothing():
    assert forecast_findings(None, None) == []
    assert forecast_findings(pd.DataFrame({"model": ["P_Stat"], "crps": [1.0]}), None) == []
    assert realism_findings(None) == []


def test_real_walks_say_whom_each_model_beats_and_whom_not():
    extended, earlier = "P_Prob (extended)", "P_Prob (extended), earlier walks"
    names = ["first", "second", "participants_difference_s", "participants_difference_s_low", "participants_difference_s_high"]
    rows = [
        ("climatology", extended, 0.2, 0.1, 0.3),
        ("regression", extended, 0.02, -0.1, 0.1),
        ("Gaussian process", extended, -0.07, -0.12, -0.01),
        ("regression, earlier walks", earlier, -0.026, -0.05, 0.01),
        ("P_Adapt", "P_Prob (literal)", 9.0, 9.0, 9.0),  # not asked
    ]
    table = pd.DataFrame(rows, columns=names).assign(scenario="walks_left_out", hull="all", participants=10)
    table = table.assign(p_mixed_holm=0.2, p_participants_holm=1.0, p_participants_holm_floor=0.05, participants_better=3)
    overall, line, process, known, with_walks = real_findings(table)
    assert overall.startswith(
        "P_Prob (extended) is better than climatology; worse than Gaussian process; undecided against regression (by 95"
    )
    assert line.startswith("Against regression P_Prob (extended) is better by 0.020 s [-0.100, 0.100], which includes zero")
    assert process.startswith(
        "Against Gaussian process P_Prob (extended) is worse by 0.070 s [0.010, 0.120], which excludes zero"
    )
    assert process.endswith("it is better for 3 of 10 people.")
    assert known == f"{earlier} is undecided against regression, earlier walks (by 95 % intervals of single pairs)."
    assert "worse by 0.026 s [-0.010, 0.050], which includes zero" in with_walks
    assert real_findings(None) == []
    assert real_findings(table.assign(scenario="scenario_1")) == []


def test_realism_tells_the_ratios_of_the_medians():
    names = ["quantity", "synthetic_median", "recorded_median", "n_recorded", "source"]
    rows = [
        ("excess_length", 0.1, 1.9, 10, "A"),
        ("excess_length", 0.2, 1.4, 10, "A"),
        ("excess_length", 0.2, 9.0, 10, "A, within 10 degrees"),
        ("excess_length", 0.2, float("nan"), 0, "A"),
        ("fall_time", 0.85, 2.04, 1, "B"),
    ]
    paths, speeds = realism_findings(pd.DataFrame(rows, columns=names))
    assert paths.endswith("excess length 7 to 19.")
    assert speeds == "Speeds, likewise: time to slow down (one person) 2.4."


def test_without_recordings_nothing_is_said_of_realism():
    row = {
        "quantity": "curvature",
        "synthetic_median": 0.2,
        "recorded_median": float("nan"),
        "n_recorded": 0,
        "source": float("nan"),
    }
    assert realism_findings(pd.DataFrame([row])) == []
