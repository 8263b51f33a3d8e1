"""Shapes of recorded walks: what the recordings of real people lend to the second generator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture import acclaim
from walklab.capture.foot_markers import STEP_S, ramps, read_feet, step_mean
from walklab.capture.goal_directed import STRAIGHT_RAD, GoalDirectedWalk, read_goal_directed
from walklab.capture.real_shapes import PATH, SHAPES, START, STOP, SWING
from walklab.capture.recording_files import CMU, FEET, GOAL_DIRECTED
from walklab.capture.walks import Walk, check, pair
from walklab.errors import InputError
from walklab.geometry.standing import speeds

Array = NDArray[np.float64]


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
