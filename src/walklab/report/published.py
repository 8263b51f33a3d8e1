"""Ours beside the published numbers, figure by figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from walklab.figures.pages import number_text
from walklab.report.sections import FIGURE_CLAIMS, TABLE_CLAIMS

NAN = float("nan")
SHORT_TEXT = 12


@dataclass(frozen=True)
class Comparison:
    """One published number (or statement) and what this run has in its place.

    Attributes
    ----------
    claim : id in ``claims.csv``; empty for a published input, to which the run may be calibrated
    published : as the paper has it
    ours, low, high : our number and its 95 % interval; NaN where there is none
    verdict : of the claim; empty for an input
    """

    statement: str
    section: str
    published: Any
    ours: float = NAN
    low: float = NAN
    high: float = NAN
    verdict: str = ""
    claim: str = ""
    note: str = ""


def published_text(value: Any) -> str:
    """What the paper has, short: its number, or that it says so in words (the statement has them)."""
    try:
        return number_text(float(value))
    except ValueError:
        return str(value) if 0 < len(str(value)) <= SHORT_TEXT else "in words"


def claimed(claims: pd.DataFrame | None, beginnings: Sequence[str]) -> list[Comparison]:
    """The claims whose ids begin so, in the order of the table."""
    if claims is None:
        return []
    rows = claims[claims["id"].str.startswith(tuple(beginnings))] if beginnings else claims.iloc[:0]
    return [
        Comparison(
            str(row["statement"]),
            f"{row['section']:g}" if isinstance(row["section"], float) else str(row["section"]),
            "" if pd.isna(row["published"]) else row["published"],
            row["ours"],
            row["ours_low"],
            row["ours_high"],
            str(row["verdict"]),
            str(row["id"]),
            "" if pd.isna(row["note"]) else str(row["note"]),
        )
        for row in rows.to_dict("records")
    ]


def beside_figure(
    name: str, paper: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], config: Mapping[str, Any]
) -> list[Comparison]:
    """What the paper publishes of a figure: inputs that ours may be calibrated to, then claims."""
    inputs = _INPUTS[name](paper["inputs"], tables, config) if name in _INPUTS else []
    return inputs + claimed(tables.get("claims"), FIGURE_CLAIMS.get(name, ()))


def beside_table(name: str, tables: Mapping[str, pd.DataFrame]) -> list[Comparison]:
    """The claims that a table answers."""
    return claimed(tables.get("claims"), TABLE_CLAIMS.get(name, ()))


def _only(frame: pd.DataFrame | None, column: str, **where: Any) -> float:
    """The one value of a column where other columns have these values; NaN if the table or the row is missing."""
    if frame is None or column not in frame:
        return NAN
    for key, value in where.items():
        frame = frame[frame[key] == value]
    return float(frame[column].iloc[0]) if len(frame) == 1 else NAN


def _distances(inputs: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], config: Mapping[str, Any]) -> list[Comparison]:
    classes = tables.get("classes")
    if classes is None:
        return []
    stated = classes[classes["published_cumulative_share"].notna()]
    return [
        Comparison(
            f"{row['dataset'].replace('_', ' ')}: share of planned walks up to {row['high_m']:g} m",
            "4.1",
            row["published_cumulative_share"],
            row["cumulative_share"],
        )
        for row in stated.to_dict("records")
    ]


def _captured(inputs: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], config: Mapping[str, Any]) -> list[Comparison]:
    capture, given = tables.get("capture"), inputs["capture"]
    return [
        Comparison(f"experiment 1: {text}", "4.2", given[key], _only(capture, key, dataset="training"))
        for key, text in (("participants", "participants"), ("walks", "walks"), ("total_length_km", "total length (km)"))
    ]


def _scenarios(inputs: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], config: Mapping[str, Any]) -> list[Comparison]:
    capture, given = tables.get("capture"), inputs["evaluation"]
    rows = [Comparison("participants", "7.1", given["participants"], _only(capture, "participants", dataset="scenario_1"))]
    for name in ("scenario_1", "scenario_2"):
        for key, text in (("walks", "walks"), ("total_length_km", "total length (km)")):
            if key in given[name]:
                rows.append(
                    Comparison(f"{name.replace('_', ' ')}: {text}", "7.2", given[name][key], _only(capture, key, dataset=name))
                )
    return rows


def _cells(inputs: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], config: Mapping[str, Any]) -> list[Comparison]:
    count = 1
    for axis in config["space"]:
        count *= len(axis.get("values") or range(axis["count"]))
    return [Comparison("cells of the parameter space", "4.3", inputs["space"]["cells"], count)]


def _entries(inputs: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], config: Mapping[str, Any]) -> list[Comparison]:
    entries = _only(tables.get("density"), "entries", when="after")
    return [Comparison("entries of the blending space", "4.4", inputs["dependencies"]["upsampled_entries"], entries)]


def _references(inputs: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], config: Mapping[str, Any]) -> list[Comparison]:
    table = tables.get("long_distance")
    rows = []
    for distance, figures in inputs["long_distance"]["reference_travel_time_s"].items():
        for statistic in ("median", "iqr"):
            where = {"split": "repetition", "distance_m": distance, "source": "Ref", "statistic": statistic}
            ours, low, high = (_only(table, column, **where) for column in ("value", "low", "high"))
            text = f"{distance} m, captured: {statistic} of the travel time (s)"
            rows.append(Comparison(text, "8.3", figures[statistic], ours, low, high))
    return rows


_INPUTS = {
    "fig03": _distances,
    "fig04": _captured,
    "fig05": _cells,
    "fig06": _entries,
    "fig10": _scenarios,
    "fig15": _references,
}
