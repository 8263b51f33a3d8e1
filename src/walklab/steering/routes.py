"""Captured walks as tasks for a planner: routes, and walks packed for re-simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.geometry.scene import Body, Scene, State, Task
from walklab.planning.batch import pack_walks, resample_time
from walklab.planning.protocol import Planner, WalkBatch
from walklab.planning.registry import require_start_supported

Array = NDArray[np.float64]


def task_of(row: pd.Series) -> Task:
    """The task a walk solved: its captured start and end state (7.3)."""
    start = State((row["start_x_m"], row["start_y_m"]), None, row["start_speed_m_s"])
    end = State((row["end_x_m"], row["end_y_m"]), None, row["end_speed_m_s"])
    return Task(start, end)


def find_routes(walks: Sequence[Walk], scenes: Mapping[str, Scene], planner: Planner, body: Body) -> dict[str, Array]:
    """The planned route of every walk, by walk id; a polyline of (n, 2) metres each.

    Raises
    ------
    InputError
        If a walk names an unknown scene, has no route, or moves at its start while the
        planner can only start from standing.
    """
    routes = {}
    for walk in walks:
        name = walk.row["walk"]
        if walk.row["scene"] not in scenes:
            raise InputError(f"walk {name}: column scene: {walk.row['scene']!r} is not among the plan views {sorted(scenes)}")
        task = task_of(walk.row)
        require_start_supported(planner, task, name)
        routes[name] = planner.route(scenes[walk.row["scene"]], task, body)
    return routes


def pack(walks: Sequence[Walk], routes: Mapping[str, Array], planner: Planner) -> WalkBatch:
    """Walks and routes in the form that compiled loops take, captured positions at the planner's step."""
    return pack_walks(
        [resample_time(walk.time_s, walk.position_m, planner.step_s) for walk in walks],
        [routes[walk.row["walk"]] for walk in walks],
        [walk.row["start_speed_m_s"] for walk in walks],
        [walk.row["end_speed_m_s"] for walk in walks],
        [walk.row["length_m"] for walk in walks],
        planner.step_s,
    )
