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

from walklab.capture import acclaim
from walklab.capture.foot_markers import STEP_S, Ramps, ramps, read_feet, step_mean
from walklab.capture.goal_directed import GoalDirectedWalk, read_goal_directed
from walklab.capture.realism import STRAIGHT_RAD
from walklab.capture.recording_files import CMU, FEET, GOAL_DIRECTED
from walklab.capture.walks import Walk, check, pair
from walklab.errors import InputError
from walklab.geometry.standing import speeds
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


def import_shapes(folder: str | Path) -> pd.DataFrame:
    """All shapes of the recordings under a folder, as one table.

    Raises
    ------
    InputError
        If a recording is missing or unreadable.
    """
    root = Path(folder)
    for part in (GOAL_DIRECTED, FEET, CMU):
        if not (root / part).exists():
            raise InputError(f"{root / part}: not there, and resampling needs it; set WALKLAB_DATA to the folder that holds it")
    straight = [walk for walk in read_goal_directed(root / GOAL_DIRECTED) if walk.facing_off_rad <= STRAIGHT_RAD]
    walks, samples = acclaim.import_walks(root / CMU)
    feet = ramps(read_feet(root / FEET))
    pieces = [
        *(_path(walk) for walk in straight),
        *(_swing(walk, feet.step_s) for walk in pair(walks, samples, root / CMU)),
        _ramp(START, feet.start, feet.step_s),
        _ramp(STOP, feet.stop, feet.step_s),
    ]
    return check(pd.concat(pieces, ignore_index=True), SHAPES, root)


def _path(walk: GoalDirectedWalk) -> pd.DataFrame:
    ahead = (walk.position_m[-1] - walk.position_m[0]) / walk.distance_m
    seen = (walk.position_m - walk.position_m[0]) / walk.distance_m
    along, aside = seen @ ahead, seen @ np.array([-ahead[1], ahead[0]])
    return _frame(PATH, f"{walk.subject:02d}", f"{walk.configuration}/{walk.subject:02d}", walk.distance_m, along, aside)


def _swing(walk: Walk, step_s: float) -> pd.DataFrame:
    """Speed relative to its mean over a step, at the rate of the ramps; the ends, where that mean is cut off, are left out."""
    own_s = float(np.mean(np.diff(walk.time_s)))
    speed = speeds(walk.position_m, own_s)
    margin = round(STEP_S / 2 / own_s)
    relative = (speed / step_mean(speed, round(STEP_S / own_s)))[margin:-margin]
    time_s = np.arange(0.0, (len(relative) - 1) * own_s, step_s)
    values = np.interp(time_s, np.arange(len(relative)) * own_s, relative)
    way = float(np.hypot(*(walk.position_m[-1] - walk.position_m[0])))
    return _frame(SWING, str(walk.row["participant"]), str(walk.row["walk"]), way, time_s, values)


def _ramp(kind: str, values: Array, step_s: float) -> pd.DataFrame:
    return _frame(kind, "gaitmap", "gaitmap", 20.0, step_s * np.arange(len(values), dtype=float), values)


def _frame(kind: str, subject: str, walk: str, distance_m: float, x: Array, y: Array) -> pd.DataFrame:
    return pd.DataFrame({"kind": kind, "subject": subject, "walk": walk, "distance_m": distance_m, "x": x, "y": y})


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
