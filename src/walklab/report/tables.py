"""Tables as the report shows them: a value and its interval in one cell, units in brackets, four significant digits."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from walklab.evaluation.forecasts import EXTENDED
from walklab.figures.pages import number_text
from walklab.figures.style import read_name
from walklab.report.contents import Contents

LONG_TEXT = 40
UNITS = {"_1_m": "1/m", "_km": "km", "_ms": "ms", "_s": "s", "_m": "m", "_percent": "%"}
# A column and those with its interval, beside `x`, `x_low`, `x_high`.
INTERVALS = {"value": ("low", "high"), "estimate_s": ("low_s", "high_s"), "increase_s": ("increase_low", "increase_high")}
# How a reader is told what the files call otherwise; other names lose their underscores.
HEADINGS = {
    "kth_median": "distance to the k-th nearest, median",
    "kth_p95": "distance to the k-th nearest, 95th percentile",
    "nearest_cv": "distance to the nearest, coefficient of variation",
    "n": "walks",
}
NAMES = {
    "k_nearest": "k nearest",
    "k_nearest_by_participant": "k nearest, participant left out",
    "rbf": "radial basis functions",
    "absolute_first": "absolute errors of P_Stat added up, a car",
    "absolute_second": "absolute errors of P_Prob added up, a car",
    "absolute_reduction": "their reduction",
    "net_first": "signed errors of P_Stat added up, a car",
    "net_second": "signed errors of P_Prob added up, a car",
    "net_reduction": "their reduction, signed",
    "paper_reduction": "reduction by the paper's arithmetic",
}
SMALLEST_P = 0.001


@dataclass(frozen=True)
class Cell:
    """One cell: what is read, what it sorts by, and how it is set (``number``, ``text``, ``long``)."""

    text: str
    sort: str
    kind: str


@dataclass(frozen=True)
class Table:
    """A table to be set: headings and rows of cells; ``file`` is where its data stand."""

    name: str
    title: str
    file: str
    headings: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]


def heading(column: str) -> str:
    """``mean_difference_s`` as ``mean difference (s)``, ``p05`` as ``5th percentile``."""
    if column in HEADINGS:
        return HEADINGS[column]
    if percentile := re.fullmatch(r"(.*?)_?p(\d\d)", column):
        return f"{percentile[1].replace('_', ' ')} {int(percentile[2])}th percentile".strip()
    words = column.replace("crps", "CRPS").replace("iqr", "IQR")
    for ending, unit in UNITS.items():
        if column.endswith(ending) and len(column) > len(ending):
            return f"{words.removesuffix(ending).replace('_', ' ')} ({unit})"
    return words.replace("_", " ")


def table_of(frame: pd.DataFrame, name: str, title: str, file: str) -> Table:
    """A table without its empty columns, intervals beside their values."""
    filled = [str(column) for column in frame.columns if frame[column].notna().any()]
    ends = {column: found for column in filled if (found := _interval(column, filled))}
    inner = {end for pair in ends.values() for end in pair}
    columns = [column for column in filled if column not in inner]
    rows = tuple(tuple(_cell(row, column, ends.get(column)) for column in columns) for row in frame.to_dict("records"))
    return Table(name, title, file, tuple(heading(c) + (" [95 %]" if c in ends else "") for c in columns), rows)


def _cell(row: Mapping[Any, Any], column: str, ends: tuple[str, str] | None) -> Cell:
    low, high = (row[ends[0]], row[ends[1]]) if ends else (None, None)
    return cell_of(row[column], low, high, _is_p(column))


def _interval(column: str, columns: Iterable[str]) -> tuple[str, str] | None:
    low, high = INTERVALS.get(column, (f"{column}_low", f"{column}_high"))
    return (low, high) if {low, high} <= set(columns) else None


def _is_p(column: str) -> bool:
    """``p``, ``shapiro_p``, ``p_walks_holm``; not ``pit_distance`` nor ``p_participants_holm_floor``, which is exact."""
    return (column == "p" or column.startswith("p_") or column.endswith("_p")) and not column.endswith("_floor")


def cell_of(value: Any, low: Any = None, high: Any = None, probability: bool = False) -> Cell:
    """A number with its interval, or a text; nothing where there is no value."""
    if _missing(value):
        return Cell("", "", "text")
    if isinstance(value, bool) or not isinstance(value, int | float):
        text = ("yes" if value else "no") if isinstance(value, bool) else reader_name(str(value))
        return Cell(text, text, "long" if len(text) > LONG_TEXT else "text")
    return Cell(with_interval(value, low, high, p_text if probability else number_text), repr(float(value)), "number")


def reader_name(text: str) -> str:
    """A name of the files as it is read: ``without_v`` as ``without v``. Sentences, paths and what has capitals stay."""
    if text in NAMES:
        return NAMES[text]
    return text.replace("_", " ") if re.fullmatch(r"[a-z0-9]+(_[a-z0-9]+)+", text) else text


def p_text(value: float) -> str:
    """A p value, of which no more is told than that it is small."""
    return f"< {SMALLEST_P}" if value < SMALLEST_P else number_text(value)


def with_interval(value: Any, low: Any = None, high: Any = None, text_of: Callable[[float], str] = number_text) -> str:
    """``0.15 [0.13, 0.22]``, or the value alone."""
    if _missing(value):
        return ""
    text = text_of(value)
    return text if _missing(low) or _missing(high) else f"{text} [{text_of(low)}, {text_of(high)}]"


def _missing(value: Any) -> bool:
    return value is None or (isinstance(value, float) and value != value)


def descriptions(frames: Mapping[str, pd.DataFrame], beginning: str = "description_") -> dict[str, pd.DataFrame]:
    """Scenario -> its table of errors (or another whose name begins so), of those that a run has."""
    return {
        name.removeprefix(beginning): frame
        for name, frame in frames.items()
        if name.startswith(beginning) and not name.startswith(f"{beginning}by_hull")
    }


def medians(described: Mapping[str, pd.DataFrame], paper: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Median travel-time error of each model in each scenario, ours and published: what the report opens with."""
    rows = []
    for scenario, frame in described.items():
        stated: Mapping[str, Any] = paper["claims"].get(f"{scenario}_abs_dt_s", {})
        for row in frame.to_dict("records"):
            published = stated.get(row["model"], {}).get("median")
            rows.append(
                {"scenario": scenario.replace("_", " "), "model": row["model"], "ours": row["median"], "published": published}
            )
    return rows


def headline(contents: Contents) -> list[dict[str, Any]]:
    """The medians with their intervals, and beside them the CRPS of each model's forecast; then the extended model's.

    The extended model is a forecast only: no single walk of it is drawn, so it has no median.
    """
    frames = contents.frames
    rows = medians(descriptions(frames), contents.paper) if contents.paper else []
    scores = frames.get("scores")
    intervals = {
        (scenario, row["model"]): (row["low"], row["high"])
        for scenario, frame in descriptions(frames, "percentiles_").items()
        for row in frame[frame["statistic"] == "median"].to_dict("records")
    }
    crps = {}
    if scores is not None and "crps_s_low" in scores:
        names = ["crps_s", "crps_s_low", "crps_s_high"]
        everyone = scores[scores["hull"] == "all"]
        crps = {
            (str(row["scenario"]).replace("_", " "), row["model"]): [row[n] for n in names] for row in everyone.to_dict("records")
        }
    found = []
    for scenario in dict.fromkeys(row["scenario"] for row in rows):
        own = [dict(row) for row in rows if row["scenario"] == scenario]
        if (scenario, EXTENDED) in crps:
            own.append({"scenario": scenario, "model": EXTENDED, "ours": None, "published": None})
        for row in own:
            low, high = intervals.get((scenario.replace(" ", "_"), row["model"]), (None, None))
            forecasts = (read_name(row["model"]), f"{row['model']} with residual spread")
            scored = next((crps[scenario, name] for name in forecasts if (scenario, name) in crps), [None] * 3)
            found.append({**row, "low": low, "high": high, "crps": scored})
    return found


SCORE_HEADINGS = (
    "scenario",
    "forecast",
    "knows",
    "CRPS (s) [95 %]",
    "energy score (m) [95 %]",
    "90 % interval holds (%)",
    "bias (s)",
)


def score_rows(scores: pd.DataFrame | None) -> list[tuple[str, ...]]:
    """Proper scores of all forecasts over all walks of a scenario, as texts under :data:`SCORE_HEADINGS`."""
    if scores is None or not {"hull", "crps_s_low", "energy_m_low", "coverage_90", "bias_s"} <= set(scores):
        return []
    return [
        (
            str(row["scenario"]).replace("_", " "),
            read_name(str(row["model"])),
            str(row["information"]),
            with_interval(row["crps_s"], row["crps_s_low"], row["crps_s_high"]),
            with_interval(row["energy_m"], row["energy_m_low"], row["energy_m_high"]) or "no trajectories",
            "one time" if _missing(row["coverage_90"]) else f"{100 * row['coverage_90']:.1f}",
            number_text(row["bias_s"]),
        )
        for row in scores[scores["hull"] == "all"].to_dict("records")
    ]


def verdict_counts(claims: pd.DataFrame | None, order: Sequence[str]) -> list[tuple[str, int]]:
    """How often each verdict was given."""
    if claims is None:
        return []
    counts = claims["verdict"].value_counts()
    return [(name, int(counts.get(name, 0))) for name in order]
