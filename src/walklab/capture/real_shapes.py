"""What a second generator takes from recordings of real people: path shapes, swings of speed, starts and stops.

One long table holds all of it, so that whoever resamples does not read the recordings again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pandera.pandas as pa
from numpy.typing import NDArray

from walklab.capture.foot_markers import Ramps
from walklab.capture.walks import check
from walklab.errors import InputError
from walklab.storage import read_table, write_table

Array = NDArray[np.float64]

PATH, SWING, START, STOP = "path", "swing", "start", "stop"
SHAPES = pa.DataFrameSchema(
    {
        "kind": pa.Column(str, pa.Check.isin([PATH, SWING, START, STOP]), description="what is resampled"),
        "subject": pa.Column(str, description="who lends the shape, as the recording names the person"),
        "walk": pa.Column(str, description="recorded walk"),
        "distance_m": pa.Column(float, pa.Check.gt(0), coerce=True, description="from its start to its end"),
        "x": pa.Column(float, coerce=True, description="path: along the straight line, in distances; else time (s)"),
        "y": pa.Column(
            float, coerce=True, description="path: to its left, in distances; else speed over the mean of a step or cruising"
        ),
    },
    strict=True,
    ordered=True,
)


@dataclass(frozen=True)
class PathShape:
    """A real path seen from its start towards its end: (n,) arrays along and to the left, in units of the distance."""

    distance_m: float
    along: Array
    aside: Array


@dataclass(frozen=True)
class RealShapes:
    """Everything that is resampled.

    Attributes
    ----------
    paths : straight walks of each subject of the goal-directed walks
    swings : of each subject of the CMU walks, speed over its mean within a step, every ``step_s``
    ramps : start and stop of one person
    """

    paths: Mapping[str, tuple[PathShape, ...]]
    swings: Mapping[str, tuple[Array, ...]]
    ramps: Ramps


def write_shapes(shapes: pd.DataFrame, path: str | Path) -> None:
    """Check and write the table of shapes."""
    write_table(check(shapes, SHAPES, path), path)


def read_shapes(path: str | Path) -> RealShapes:
    """Read the table of shapes.

    Raises
    ------
    InputError
        If the table breaks its schema or holds no walk of a kind.
    """
    return shapes_of(check(read_table(path), SHAPES, path), path)


def shapes_of(table: pd.DataFrame, source: str | Path) -> RealShapes:
    """The shapes of a table; errors as of :func:`read_shapes`."""
    for kind in (PATH, SWING, START, STOP):
        if not (table["kind"] == kind).any():
            raise InputError(f"{source}: column kind: no row is a {kind}; import the shapes again")
    paths: dict[str, tuple[PathShape, ...]] = {}
    swings: dict[str, tuple[Array, ...]] = {}
    for key, part in table.groupby(["kind", "subject", "walk"], sort=True):
        kind, subject, _ = (str(name) for name in key)
        x, y = part["x"].to_numpy(), part["y"].to_numpy()
        if kind == PATH:
            paths[subject] = (*paths.get(subject, ()), PathShape(float(part["distance_m"].iloc[0]), x, y))
        elif kind == SWING:
            swings[subject] = (*swings.get(subject, ()), y)
    start, stop = (table[table["kind"] == kind] for kind in (START, STOP))
    step_s = float(start["x"].iloc[1] - start["x"].iloc[0])
    return RealShapes(paths, swings, Ramps(start["y"].to_numpy(), stop["y"].to_numpy(), step_s, np.nan))
