"""Verdicts on constructed cases, the strictness of the file, and the project's own copy of the paper's figures."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import yaml

from walklab.errors import InputError
from walklab.evaluation.claims import check_claims, inconsistency_table, load_paper, published_figures
from walklab.evaluation.production import production_example
from walklab.evaluation.rules import holds, rule_problem
from walklab.evaluation.statistics import by_dataset, compare_pairs, describe, percentile_intervals, reductions

OWN_COPY = Path(__file__).parents[3] / "config" / "papers" / "agethen_steering.yaml"

SMALL: dict[str, Any] = {
    "paper": "A paper",
    "inputs": {},
    "claims": {"error": {"A": 0.5, "B": 0.4}, "statements": [{"id": "better", "section": 7, "text": "B is better"}]},
    "inconsistencies": [{"text": "a and b differ", "reading": "a counts"}],
    "verdicts": [
        {
            "id": "error_a",
            "section": 7.4,
            "statement": "error of A",
            "published": "error.A",
            "ours": {"table": "errors", "where": {"model": "A"}},
            "direction": [],
        },
        {
            "id": "error_b",
            "section": 7.4,
            "statement": "error of B",
            "published": "error.B",
            "ours": {"table": "errors", "where": {"model": "B"}},
            "direction": [{"less_than": {"model": "A"}}],
        },
        {
            "id": "better",
            "section": 7.5,
            "statement": "B is better, by a lot",
            "published": "statements.better",
            "parts": [
                {"less_than": {"model": "A"}, "at": {"table": "errors", "where": {"model": "B"}}},
                {"below": 0.1, "at": {"table": "errors", "where": {"model": "B"}}},
            ],
        },
    ],
}


def write(tmp_path: Path, data: dict[str, Any]) -> Path:
    path = tmp_path / "paper.yaml"
    path.write_text(yaml.safe_dump(data, sort_keys=False))
    return path


def errors(**values: tuple[float, float, float]) -> dict[str, pd.DataFrame]:
    rows = [[model, *numbers] for model, numbers in values.items()]
    return {"errors": pd.DataFrame(rows, columns=["model", "value", "low", "high"])}


@pytest.mark.parametrize(
    ("a", "b", "verdicts"),
    [
        # interval holds the figure, direction holds; one part of two
        ((0.52, 0.45, 0.60), (0.41, 0.35, 0.45), ["reproduced", "reproduced", "partly"]),
        # direction alone; without a direction the interval decides
        ((0.70, 0.65, 0.75), (0.60, 0.55, 0.65), ["not reproduced", "partly", "partly"]),
        # interval holds the figure, but the direction is wrong; no part holds
        ((0.35, 0.30, 0.55), (0.41, 0.35, 0.45), ["reproduced", "not reproduced", "not reproduced"]),
        # equal but for rounding is no direction
        ((0.5, 0.4, 0.6), (0.5 - 1e-12, 0.3, 0.6), ["reproduced", "not reproduced", "not reproduced"]),
        # both parts hold
        ((0.5, 0.4, 0.6), (0.05, 0.04, 0.06), ["reproduced", "partly", "reproduced"]),
        # no interval: the value has to meet the figure itself
        ((0.5, np.nan, np.nan), (0.39, np.nan, np.nan), ["reproduced", "partly", "partly"]),
    ],
)
def test_verdicts(tmp_path: Path, a: tuple, b: tuple, verdicts: list[str]) -> None:
    table = check_claims(load_paper(write(tmp_path, SMALL)), errors(A=a, B=b))
    assert table["verdict"].tolist() == verdicts
    assert list(table.columns) == ["id", "section", "statement", "published", "ours", "ours_low", "ours_high", "verdict", "note"]
    assert table["published"].tolist() == ["0.5", "0.4", ""]


def test_the_note_says_which_part_fails(tmp_path: Path) -> None:
    table = check_claims(load_paper(write(tmp_path, SMALL)), errors(A=(0.5, 0.4, 0.6), B=(0.6, 0.5, 0.7))).set_index("id")
    assert "0.6 is not less than 0.5" in table.loc["error_b", "note"]
    assert "0.6 is not below 0.1" in table.loc["better", "note"]
    assert "0 of 2 parts hold" in table.loc["better", "note"]


def test_the_note_says_when_a_reproduced_effect_may_be_none(tmp_path: Path) -> None:
    data = yaml.safe_load(yaml.safe_dump(SMALL))
    data["verdicts"][1]["direction"] = [{"above": 0}]
    paper = load_paper(write(tmp_path, data))
    wide, narrow = (
        check_claims(paper, errors(A=(0.5, 0.4, 0.6), B=interval)).set_index("id").loc["error_b"]
        for interval in ((0.3, -0.1, 0.7), (0.3, 0.1, 0.7))
    )
    assert wide["verdict"] == narrow["verdict"] == "reproduced"
    assert "includes no effect (-0.1 to 0.7)" in wide["note"]
    assert "no effect" not in narrow["note"]


def test_what_a_run_lacks_is_not_checkable_with_the_reason(tmp_path: Path) -> None:
    paper = load_paper(write(tmp_path, SMALL))
    assert check_claims(paper, {})["note"].str.contains("no table errors").all()
    partial = check_claims(paper, errors(A=(0.5, 0.4, 0.6)))
    assert partial["verdict"].tolist() == ["reproduced", "not checkable", "not checkable"]
    assert "no row model=B" in partial["note"][1]
    unknown = check_claims(paper, errors(A=(np.nan, np.nan, np.nan), B=(0.4, 0.3, 0.5)))
    assert unknown["verdict"][0] == "not checkable"
    assert np.isnan(unknown["ours"][0])


@pytest.mark.parametrize(
    ("compare", "reading", "verdict"),
    [
        ({}, [0.5, 0.7], "reproduced"),  # touches
        ({}, [0.61, 0.7], "not reproduced"),
        ({"compare": "at_most"}, [0.0, 0.4], "reproduced"),
        ({"compare": "at_most"}, [0.0, 0.39], "not reproduced"),
        ({"compare": "at_most"}, [0.9, 0.9], "reproduced"),
    ],
)
def test_readings_of_a_range_and_of_an_upper_limit(tmp_path: Path, compare: dict, reading: list[float], verdict: str) -> None:
    data = copy.deepcopy(SMALL)
    data["verdicts"][0] |= {**compare, "reading": reading}
    assert check_claims(load_paper(write(tmp_path, data)), errors(A=(0.5, 0.4, 0.6), B=(0.4, 0.3, 0.5)))["verdict"][0] == verdict


SWEEP = pd.DataFrame(
    {"k": [1, 2, 3, 4], "value": [10.0, 5.0, 4.0, 3.0], "low": [9.0, 3.9, 3.0, 2.0], "high": [11.0, 6.0, 5.0, 4.0], "shift": -4.0}
)


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ({"greater_than": {"k": 2}}, True),
        ({"greater_than": {"k": 1}, "at": {"k": 2}}, False),
        ({"above": 9.9}, True),
        ({"below": 10}, False),
        ({"magnitude_below": 5}, False),
        ({"magnitude_below": 5, "at": {"table": "sweep", "where": {"k": 1}, "value": "shift"}}, True),
        ({"every_above": 2.9, "at": {"table": "sweep"}}, True),
        ({"every_below": 10, "at": {"table": "sweep"}}, False),
        ({"largest_of": [{"k": 2}, {"k": 3}]}, True),
        ({"largest_of": [{"k": 1}], "at": {"k": 2}}, False),
        ({"within_share_of": {"of": {"k": 3}, "share": 0.25}, "at": {"k": 2}}, True),
        ({"within_share_of": {"of": {"k": 3}, "share": 0.24}, "at": {"k": 2}}, False),
        ({"differs_at_most": {"from": {"k": 3}, "by": 1}, "at": {"k": 2}}, True),
        ({"differs_at_most": {"from": {"k": 1}, "by": 1}, "at": {"k": 2}}, False),
        ({"interval_contains": {"k": 3}, "at": {"k": 2}}, True),
        ({"interval_contains": {"k": 1}, "at": {"k": 2}}, False),
        ({"gain_shrinks": [{"k": 1}, {"k": 2}, {"k": 3}]}, True),
        ({"gain_shrinks": [{"k": 2}, {"k": 3}, {"k": 4}]}, False),
    ],
)
def test_rules(rule: dict[str, Any], expected: bool) -> None:
    assert rule_problem(rule) == ""
    assert holds(rule, {"sweep": SWEEP}, {"table": "sweep", "where": {"k": 1}})[0] is expected


def change(path: str, value: Any) -> Callable[[dict[str, Any]], None]:
    def apply(data: dict[str, Any]) -> None:
        *parents, last = [int(key) if key.isdigit() else key for key in path.split(".")]
        place: Any = data
        for key in parents:
            place = place[key]
        if value is None:
            del place[last]
        else:
            place[last] = value

    return apply


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (change("inputs", None), "needs exactly the keys"),
        (change("verdicts.0.secion", 7), r"verdicts\[0\]: unknown key secion"),
        (change("verdicts.0.statement", None), r"verdicts\[0\]: needs statement"),
        (change("verdicts.0.published", "error.C"), "there is no figure claims.error.C"),
        (change("verdicts.1.id", "error_a"), "id error_a stands twice"),
        (change("verdicts.1.direction", [{"smaller": {"model": "A"}}]), "needs exactly one of"),
        (change("verdicts.1.direction", [{"below": "1e-3"}]), "below needs a number"),
        (change("verdicts.1.direction", [{"less_than": 3}]), "less_than needs what differs"),
        (change("verdicts.1.direction", [{"differs_at_most": {"from": {"model": "A"}}}]), "needs from and by"),
        (change("verdicts.1.direction", [{"gain_shrinks": [{"model": "A"}]}]), "at least 3 rows"),
        (change("verdicts.1.direction", None), "needs direction"),
        (change("verdicts.1.ours", {"where": {"model": "B"}}), "needs table"),
        (change("verdicts.1.ours", {"table": "errors", "were": {}}), "only the keys"),
        (change("verdicts.1.reading", [0.4]), r"is not \[low, high\]"),
        (change("verdicts.1.compare", "roughly"), "is not one of"),
        (change("verdicts.2.parts", None), "needs one of ours"),
        (change("verdicts.2.published", "error.A"), "claims.statements.better has no verdict"),
        (change("claims.error.C", 0.3), "published figure claims.error.C has no verdict"),
        (change("inconsistencies.0.reading", None), r"inconsistencies\[0\]: needs exactly text and reading"),
    ],
)
def test_a_malformed_file_ends_in_one_line(tmp_path: Path, broken: Callable[[dict[str, Any]], None], message: str) -> None:
    data = copy.deepcopy(SMALL)
    broken(data)
    with pytest.raises(InputError, match=message) as caught:
        load_paper(write(tmp_path, data))
    assert "\n" not in str(caught.value)


def test_a_selector_that_fits_no_column_or_several_rows_is_an_error(tmp_path: Path) -> None:
    data = copy.deepcopy(SMALL)
    data["verdicts"][0]["ours"] = {"table": "errors", "where": {"modell": "A"}}
    with pytest.raises(InputError, match="no column modell"):
        check_claims(load_paper(write(tmp_path, data)), errors(A=(1, 1, 1)))
    data["verdicts"][0]["ours"] = {"table": "errors"}
    with pytest.raises(InputError, match="names 2 rows"):
        check_claims(load_paper(write(tmp_path, data)), errors(A=(1, 1, 1), B=(1, 1, 1)))


def test_own_copy_has_a_verdict_for_every_figure_and_a_reading_for_every_inconsistency() -> None:
    data = yaml.safe_load(OWN_COPY.read_text())
    paper = load_paper(OWN_COPY)
    figures = {at for at, _ in published_figures(data["claims"])}
    assert figures == {at for claim in paper.claims for at in claim.published}
    assert len(figures) > 70
    assert len(inconsistency_table(paper)) == len(data["inconsistencies"]) == 14
    unchecked = [claim.id for claim in paper.claims if claim.not_checkable]
    assert unchecked == ["interpolation_ms_100", "interpolation_ms_500", "sample_ms"]


def test_removing_any_verdict_of_the_own_copy_is_noticed_unless_another_covers_its_figure(tmp_path: Path) -> None:
    data = yaml.safe_load(OWN_COPY.read_text())
    published = [entry["published"] for entry in data["verdicts"]]
    alone = [i for i, at in enumerate(published) if published.count(at) == 1]
    for index in alone[::9]:
        shortened = {**data, "verdicts": data["verdicts"][:index] + data["verdicts"][index + 1 :]}
        with pytest.raises(InputError, match="has no verdict"):
            load_paper(write(tmp_path, shortened))


def test_every_verdict_of_the_own_copy_finds_its_rows_in_the_tables_of_a_run(make_trials: Callable[..., pd.DataFrame]) -> None:
    table = check_claims(load_paper(OWN_COPY), _tables(make_trials))
    stuck = table[table["verdict"] == "not checkable"]
    assert set(stuck["id"]) == {"interpolation_ms_100", "interpolation_ms_500", "sample_ms"}
    assert table["verdict"].isin(["reproduced", "partly", "not reproduced", "not checkable"]).all()


def test_the_papers_own_figures_would_be_reproduced() -> None:
    """Fed with the published figures themselves, every figure and statement they decide comes out as reproduced."""
    paper = load_paper(OWN_COPY)
    claims = yaml.safe_load(OWN_COPY.read_text())["claims"]
    rows = [
        ["scenario_1", model, statistic, value]
        for model, values in claims["scenario_1_abs_dt_s"].items()
        for statistic, value in values.items()
    ]
    percentiles = pd.DataFrame(rows, columns=["dataset", "model", "statistic", "value"])
    percentiles["low"], percentiles["high"] = 0.97 * percentiles["value"], 1.03 * percentiles["value"]
    ablations = pd.DataFrame(claims["ablation_median_abs_dt_s"].items(), columns=["variant", "value"])
    sweep = pd.DataFrame(claims["k_sweep"]["median_abs_dt_s"].items(), columns=["k", "value"]).assign(statistic="median")
    timings = pd.DataFrame({"k": [10, 500], "interpolation_ms": [5.0, 184.7]})
    tables = {"percentiles": percentiles, "ablations": ablations, "neighbours": sweep, "neighbour_timings": timings}
    table = check_claims(paper, tables).set_index("id")
    checked = table[table["verdict"] != "not checkable"]
    assert len(checked) == 15 + 7 + 6 + 3
    assert (checked["verdict"] == "reproduced").all()


def _tables(make_trials: Callable[..., pd.DataFrame]) -> dict[str, pd.DataFrame]:
    rng = np.random.default_rng(0)
    base = rng.normal(0, 0.6, 120)
    spread = {"P_Stat": 1.0, "P_Adapt": 0.9, "P_Prob": 0.8}
    trials = {
        name: make_trials({model: factor * base + rng.normal(0, 0.05, 120) for model, factor in spread.items()})
        for name in ("scenario_1", "scenario_2")
    }
    numbers = {"value": 1.0, "low": 0.9, "high": 1.1}
    variants = ["full", *(f"without_{name}" for name in ("length", "curvature", "height", "v", "a", "omega"))]
    long = [(d, source, st) for d in (10.0, 25.0, 50.0) for source in ("Ref", "P_Prob", "P_Stat") for st in ("median", "iqr")]
    methods = [(m, st) for m in ("k_nearest", "k_nearest_by_participant", "rbf") for st in ("mean", "sd")]
    ks = [10, 20, 50, 100, 200, 500]
    return {
        "optimum": pd.DataFrame({"parameter": ["v", "a", "omega"]}).assign(**numbers),
        "percentiles": by_dataset({name: percentile_intervals(table, rng, 50) for name, table in trials.items()}),
        "reductions": by_dataset({name: reductions(table, rng, resamples=50) for name, table in trials.items()}),
        "description": by_dataset({name: describe(table) for name, table in trials.items()}),
        "comparisons": by_dataset({name: compare_pairs(table, rng, resamples=50) for name, table in trials.items()}),
        "production": production_example(trials["scenario_1"], rng, resamples=50),
        "ablations": pd.DataFrame({"variant": variants}).assign(**numbers),
        "leave_one_out": pd.DataFrame(methods, columns=["method", "statistic"]).assign(**numbers),
        "neighbours": pd.DataFrame({"k": ks, "statistic": "median"}).assign(**numbers),
        "neighbour_timings": pd.DataFrame({"k": ks, "interpolation_ms": 1.0, "sample_ms": 1.0}),
        "long_distance": pd.DataFrame(long, columns=["distance_m", "source", "statistic"]).assign(split="repetition", **numbers),
    }
