"""Walks and their samples: the two tables every capture ends in and every study starts from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pandera.pandas as pa
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.imports import without
from walklab.storage import read_table, write_table

Array = NDArray[np.float64]

ACCEPTED = ""


def _number(description: str, rule: pa.Check | None = None) -> pa.Column:
    return pa.Column(float, rule, nullable=False, coerce=True, description=description)


def _text(description: str, unique: bool = False) -> pa.Column:
    return pa.Column(str, unique=unique, description=description)


WALKS = pa.DataFrameSchema(
    {
        "walk": _text("name of the walk, such as training/P03/straight_2.0/0004", unique=True),
        "participant": _text("who walked"),
        "scene": _text("name of the plan view, or open for none"),
        "configuration": _text("what was walked, such as straight_2.0, turn_90_3.0 or rack_1-car"),
        "start_s": _number("begin of the walk within its recording", pa.Check.ge(0)),
        "duration_s": _number("last standing frame to first standing frame", pa.Check.ge(0)),
        "length_m": _number("length of the captured, smoothed path", pa.Check.in_range(0, 1000)),
        "curvature_1_m": _number("mean curvature of the captured, smoothed path", pa.Check.ge(0)),
        "height_m": _number("body height", pa.Check.in_range(0.5, 2.5)),
        "start_x_m": _number("where the walk starts"),
        "start_y_m": _number("where the walk starts"),
        "end_x_m": _number("where the walk ends"),
        "end_y_m": _number("where the walk ends"),
        "start_speed_m_s": _number("0 for a standing start", pa.Check.in_range(0, 12)),
        "end_speed_m_s": _number("0 for a standing end", pa.Check.in_range(0, 12)),
        "rejection": _text("empty for an accepted walk, else why it was left out"),
    },
    strict=True,
    ordered=True,
)

SAMPLES = pa.DataFrameSchema(
    {
        "walk": _text("name of the walk"),
        "time_s": _number("time from the start of the walk", pa.Check.ge(0)),
        "x_m": _number("smoothed position of the centre of mass on the floor", pa.Check.in_range(-1000, 1000)),
        "y_m": _number("smoothed position of the centre of mass on the floor", pa.Check.in_range(-1000, 1000)),
    },
    strict=True,
    ordered=True,
)


@dataclass(frozen=True)
class Walk:
    """One accepted walk: a row of the walks table and its samples.

    Attributes
    ----------
    row : the row of the walks table
    time_s : (n,) array from 0
    position_m : (n, 2) array, smoothed
    """

    row: pd.Series
    time_s: Array
    position_m: Array


def check(frame: pd.DataFrame, schema: pa.DataFrameSchema, source: str | Path) -> pd.DataFrame:
    """Hold a table to its schema.

    Raises
    ------
    InputError
        One line with the file, the column, the first offending row and its value.
    """
    try:
        with without("hypothesis"):  # pandera loads it, if it is there, to make up data
            return schema.validate(frame)
    except pa.errors.SchemaError as error:
        raise InputError(f"{source}: {_first_failure(error)}") from error


def _first_failure(error: pa.errors.SchemaError) -> str:
    cases = error.failure_cases
    rule = error.check if isinstance(error.check, str) else getattr(error.check, "error", None) or str(error.check)
    column = getattr(error.schema, "name", None)
    if isinstance(cases, pd.DataFrame) and len(cases) and "index" in cases and pd.notna(cases["index"].iloc[0]):
        case = cases.iloc[0]
        return (
            f"column {column}, row {case['index']}: value {case['failure_case']!r} fails {rule}; correct it or leave the row out"
        )
    detail = cases["failure_case"].iloc[0] if isinstance(cases, pd.DataFrame) and len(cases) else cases
    return f"column {column or detail}: {rule} ({detail}); correct the table's columns"


def write_walks(walks: pd.DataFrame, samples: pd.DataFrame, walks_path: str | Path, samples_path: str | Path) -> None:
    """Check and write both tables."""
    write_table(check(walks, WALKS, walks_path), walks_path)
    write_table(check(samples, SAMPLES, samples_path), samples_path)


def read_walk_table(path: str | Path, accepted_only: bool = True) -> pd.DataFrame:
    """The walks table, checked; accepted walks only unless asked otherwise."""
    walks = check(read_table(path), WALKS, path)
    return walks[walks["rejection"] == ACCEPTED].reset_index(drop=True) if accepted_only else walks


def read_walks(walks_path: str | Path, samples_path: str | Path) -> list[Walk]:
    """All accepted walks with their samples, in the order of the walks table.

    Raises
    ------
    InputError
        If a table breaks its schema, a walk has no samples, or its times do not ascend.
    """
    walks = read_walk_table(walks_path)
    return pair(walks, check(read_table(samples_path), SAMPLES, samples_path), samples_path)


def pair(walks: pd.DataFrame, samples: pd.DataFrame, source: str | Path) -> list[Walk]:
    """The accepted walks of both tables, in the order of the walks table; errors as of :func:`read_walks`."""
    walks = walks[walks["rejection"] == ACCEPTED].reset_index(drop=True)
    rows = samples.groupby("walk", sort=False).indices
    times_s, positions_m = samples["time_s"].to_numpy(), samples[["x_m", "y_m"]].to_numpy()
    result = []
    for _, row in walks[walks["rejection"] == ACCEPTED].iterrows():
        own = rows.get(row["walk"], [])
        if len(own) < 2:
            raise InputError(f"{source}: walk {row['walk']} has fewer than two samples; extract the walks again")
        time_s = times_s[own]
        if np.any(np.diff(time_s) <= 0):
            at = int(np.flatnonzero(np.diff(time_s) <= 0)[0]) + 1
            raise InputError(f"{source}: column time_s, walk {row['walk']}, sample {at}: times must ascend; sort the samples")
        result.append(Walk(row, time_s, np.ascontiguousarray(positions_m[own])))
    return result
