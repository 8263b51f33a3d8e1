"""What the tables of forecasts and of realism say, in plain sentences: who wins, by how much, and what is unlike real walks."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import pandas as pd

from walklab.errors import InputError
from walklab.evaluation.forecasts import (
    CALIBRATED,
    EXTENDED,
    EXTENDED_EARLIER,
    GAUSSIAN_PROCESS,
    QUADRATIC_REGRESSION,
    REGRESSION,
    STATIC,
)
from walklab.evaluation.paired_tests import BASELINES, BASELINES_EARLIER
from walklab.evaluation.subject_scores import WALKS_LEFT_OUT

Row = dict[Hashable, Any]

GOAL_LOW, GOAL_HIGH = 0.86, 0.94  # of a 90 % interval: set before any scenario was scored


def forecast_findings(scores: pd.DataFrame | None, tests: pd.DataFrame | None) -> list[str]:
    """Which baseline is best in each scenario, how the learned models stand to it, and what the 90 % intervals hold.

    Parameters
    ----------
    scores : of :func:`walklab.evaluation.score_tables.score_table`; another table, or none, gives no sentence
    tests : of :func:`walklab.evaluation.paired_tests.pair_table`; without it the differences are told without intervals

    Raises
    ------
    InputError
        If the tests lack a pair that is told.
    """
    if scores is None or not {"scenario", "hull", "model", "crps_s", "coverage_90", "bias_s"} <= set(scores):
        return []
    found = []
    scenarios = _by_scenario(scores)
    for scenario, rows in scenarios.items():
        if CALIBRATED not in rows or not set(BASELINES) & set(rows):
            continue
        best = min((name for name in BASELINES if name in rows), key=lambda name: rows[name]["crps_s"])
        learned = [name for name in (CALIBRATED, EXTENDED) if name in rows]
        opening = f"{_words(scenario)}: the best baseline that knows only the task is {best} (CRPS {_crps(rows[best])})"
        sentences = [f"{name} has {_crps(rows[name])}{_against(tests, scenario, rows, best, name)}" for name in learned]
        leans = [f"{rows[name]['bias_s']:+.2f} s ({name})" for name in (best, *learned)]
        found.append(". ".join([opening, *sentences, f"Mean forecast minus captured time: {', '.join(leans)}."]))
    return found + _informed(scenarios, tests) + _coverage(scenarios) + trajectory_findings(scores)


def trajectory_findings(scores: pd.DataFrame) -> list[str]:
    """How the learned models' trajectories stand to the planned route, walked in the time of the quadratic log regression.

    Parameters
    ----------
    scores : with ``energy_minus_regression_m`` and its interval, which resamples participants
    """
    if "energy_minus_regression_m_low" not in scores:
        return []
    found = []
    for scenario, rows in _by_scenario(scores).items():
        parts = []
        for name in (CALIBRATED, EXTENDED):
            if name in rows:
                gain, low, high = (-rows[name][f"energy_minus_regression_m{end}"] for end in ("", "_high", "_low"))
                word, low, high = ("less", low, high) if gain > 0 else ("more", -high, -low)
                zero = "excludes" if low > 0 else "includes"
                parts.append(f"that of {name} is {word} by {abs(gain):.4f} m [{low:.4f}, {high:.4f}], which {zero} zero")
        if parts:
            base = f"{rows[QUADRATIC_REGRESSION]['energy_m']:.3f} m" if QUADRATIC_REGRESSION in rows else "known"
            found.append(
                f"{_words(scenario)}, trajectories: the energy score of the planned route, walked in the time of the"
                f" {QUADRATIC_REGRESSION}, is {base}; {'; '.join(parts)}."
            )
    return found


def real_findings(tests: pd.DataFrame | None) -> list[str]:
    """Whether the learned models beat what a sceptic would fit on walks that were left out, every participant counting once.

    Parameters
    ----------
    tests : of :func:`walklab.evaluation.paired_tests.pair_table`; another table, or none, gives no sentence
    """
    if tests is None or "scenario" not in tests or WALKS_LEFT_OUT not in set(tests["scenario"]):
        return []
    rows = tests[(tests["hull"] == "all") & (tests["scenario"] == WALKS_LEFT_OUT)]
    found = []
    for model, others in ((CALIBRATED, BASELINES), (EXTENDED, BASELINES), (EXTENDED_EARLIER, BASELINES_EARLIER)):
        asked = rows[(rows["second"] == model) & rows["first"].isin(others)]
        ahead = asked["participants_difference_s_low"] > 0
        behind = asked["participants_difference_s_high"] < 0
        groups = {"better than": ahead, "worse than": behind, "undecided against": ~(ahead | behind)}
        found += [
            f"{model} is "
            + "; ".join(f"{words} {_names(asked.loc[which, 'first'])}" for words, which in groups.items() if which.any())
            + " (by 95 % intervals of single pairs)."
        ] * bool(len(asked))
        found += [
            f"Against {row['first']} {model} is {_tested(row, 'participants_difference_s')};"
            f" it is better for {row['participants_better']} of {row['participants']} people."
            for row in asked[asked["first"].isin((STATIC, REGRESSION, GAUSSIAN_PROCESS, *BASELINES_EARLIER))].to_dict("records")
            if model != CALIBRATED
        ]
    return found


def _names(models: pd.Series) -> str:
    return ", ".join(str(name) for name in models)


def _by_scenario(scores: pd.DataFrame) -> dict[str, dict[str, Row]]:
    """Scenario -> model -> its scores over all walks."""
    found: dict[str, dict[str, Row]] = {}
    for row in scores[scores["hull"] == "all"].to_dict("records"):
        found.setdefault(str(row["scenario"]), {})[str(row["model"])] = row
    return found


def _informed(scenarios: dict[str, dict[str, Row]], tests: pd.DataFrame | None) -> list[str]:
    """What knows a person's earlier walks, against the best of its like."""
    parts = []
    for scenario, rows in scenarios.items():
        others = [name for name in BASELINES_EARLIER if name in rows]
        if EXTENDED_EARLIER in rows and others:
            best = min(others, key=lambda name: rows[name]["crps_s"])
            both = f"{_crps(rows[EXTENDED_EARLIER])} in {_words(scenario).lower()} against {_crps(rows[best])} of {best}"
            parts.append(both + _against(tests, scenario, rows, best, EXTENDED_EARLIER))
    return [f"With the person's earlier walks, {EXTENDED} and the best regression: {'; '.join(parts)}."] if parts else []


def _coverage(scenarios: dict[str, dict[str, Row]]) -> list[str]:
    parts = []
    for scenario, rows in scenarios.items():
        if CALIBRATED in rows:
            share = rows[CALIBRATED]["coverage_90"]
            place = "inside" if GOAL_LOW <= share <= GOAL_HIGH else "outside"
            parts.append(f"{100 * share:.1f} % of the walks of {_words(scenario).lower()} ({place})")
    goal = f"the goal is {100 * GOAL_LOW:.0f} to {100 * GOAL_HIGH:.0f} %"
    return [f"The 90 % interval of {CALIBRATED} holds {' and '.join(parts)}; {goal}."] if parts else []


def _crps(row: Row) -> str:
    return f"{row['crps_s']:.3f} s [{row['crps_s_low']:.3f}, {row['crps_s_high']:.3f}]"


def _against(tests: pd.DataFrame | None, scenario: str, rows: dict[str, Row], first: str, second: str) -> str:
    """By how much the second is better or worse than the first, with its interval where pairs were tested."""
    gain = rows[first]["crps_s"] - rows[second]["crps_s"]
    if tests is None:
        return f", {_gained(gain)}"
    return f", {_tested(_pair(tests, scenario, first, second), 'mean_difference_s')}"


def _pair(tests: pd.DataFrame, scenario: str, first: str, second: str) -> Row:
    asked = {"scenario": scenario, "hull": "all", "first": first, "second": second}
    found = [row for row in tests.to_dict("records") if all(row[name] == value for name, value in asked.items())]
    if len(found) != 1:
        raise InputError(f"tests: {len(found)} rows of {first} against {second} in {scenario}, not one; compare them again")
    return found[0]


def _gained(gain: float) -> str:
    return f"{'better' if gain > 0 else 'worse'} by {abs(gain):.3f} s"


def _tested(row: Row, measure: str) -> str:
    """A tested difference: interval, and p after Holm of the mixed model beside the exact test, which has a floor."""
    gain, low, high = (row[f"{measure}{end}"] for end in ("", "_low", "_high"))
    if gain <= 0:
        low, high = -high, -low
    zero = "excludes" if low > 0 else "includes"
    return (
        f"{_gained(gain)} [{low:.3f}, {high:.3f}], which {zero} zero (p after Holm: {row['p_mixed_holm']:.2g} by the mixed model,"
        f" {row['p_participants_holm']:.2g} by the exact test on the means of {row['participants']} people,"
        f" whose smallest possible is {row['p_participants_holm_floor']:.2g})"
    )


def _words(scenario: object) -> str:
    return str(scenario).replace("_", " ").capitalize()


def realism_findings(realism: pd.DataFrame | None) -> list[str]:
    """How far the medians of the walks of the run are from those of recordings; of the distances that were recorded."""
    if realism is None or "quantity" not in realism:
        return []
    # Neither the subjects with spikes nor a part of the walks, which have sources of their own with a comma in them.
    rows = realism[(realism["n_recorded"] > 0) & ~realism["source"].astype(str).str.contains(",")]
    ratios = {str(name): part["recorded_median"] / part["synthetic_median"] for name, part in rows.groupby("quantity")}
    found = []
    paths = {"lateral_excursion": "lateral excursion", "excess_length": "excess length", "curvature": "curvature"}
    parts = [f"{words} {_times(ratios[name])}" for name, words in paths.items() if name in ratios]
    if parts:
        found.append(f"Paths: the median of the recorded people is, by distance, that of these walks times: {', '.join(parts)}.")
    speeds = {
        "peak_speed": "peak speed",
        "speed_swing": "swing of speed within a step",
        "lateral_sway": "lateral sway",
        "rise_time": "time to get going",
        "fall_time": "time to slow down (one person)",
    }
    parts = [f"{words} {_times(ratios[name])}" for name, words in speeds.items() if name in ratios]
    if parts:
        found.append(f"Speeds, likewise: {', '.join(parts)}.")
    return found


def _times(ratios: pd.Series) -> str:
    low, high = f"{ratios.min():.3g}", f"{ratios.max():.3g}"
    return low if low == high else f"{low} to {high}"
