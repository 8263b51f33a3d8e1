"""Walks to be played on the page: captured, and simulated with the very parameters that the evaluation drew for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.geometry.plans import Plan
from walklab.planning.protocol import Planner
from walklab.steering.routes import task_of

Array = NDArray[Any]

PER_KIND = 12  # walks of each configuration: from one to the next a viewer sees how much people differ
FRAME_S = 1 / 15
LONGEST_S = 20.0  # a draw that never arrives is shown this long


def chosen(walks: Sequence[Walk], per_kind: int = PER_KIND) -> list[int]:
    """Indices of the walks to show: of each configuration evenly over the recorded ones, so that most participants occur."""
    kinds: dict[str, list[int]] = {}
    for index, walk in enumerate(walks):
        kinds.setdefault(str(walk.row["configuration"]), []).append(index)
    picked = []
    for members in kinds.values():
        places = np.linspace(0, len(members) - 1, min(per_kind, len(members))).round().astype(int)
        picked += [members[place] for place in dict.fromkeys(places.tolist())]
    return picked


def scene_data(
    name: str,
    plan: Plan,
    walks: Sequence[Walk],
    routes: Mapping[str, Array],
    trials: pd.DataFrame,
    planner: Planner,
    space_names: Sequence[str],
    time_limit_s: float,
) -> dict[str, Any]:
    """A scenario's plan view and its shown walks, as plain data for the page.

    Parameters
    ----------
    trials : DataFrame[walk, model, <parameters>, captured_s, simulated_s, dt_s, arrival]

    Returns
    -------
    dict: ``name``, ``frame_s``, ``obstacles``, ``stations``, ``models``, ``parameters`` and ``walks``; positions are whole
    centimetres, x and y in turn
    """
    by_walk = {str(walk): group for walk, group in trials.groupby("walk", sort=False)}
    return {
        "name": name,
        "frame_s": FRAME_S,
        "obstacles": [
            {"name": key, "outline": _centimetres(np.asarray(shape.exterior.coords))}
            for key, shape in plan.scene.obstacles.items()
        ],
        "stations": [{"name": key, "at": _centimetres(np.array([place.position_m]))} for key, place in plan.stations.items()],
        "models": list(dict.fromkeys(trials["model"])),
        "parameters": list(space_names),
        "walks": [
            _walk(walk, routes[str(walk.row["walk"])], by_walk[str(walk.row["walk"])], planner, space_names, time_limit_s)
            for walk in (walks[index] for index in chosen(walks))
            if str(walk.row["walk"]) in by_walk
        ],
    }


def _walk(
    walk: Walk, route: Array, trials: pd.DataFrame, planner: Planner, names: Sequence[str], time_limit_s: float
) -> dict[str, Any]:
    return {
        "walk": str(walk.row["walk"]),
        "participant": str(walk.row["participant"]),
        "configuration": str(walk.row["configuration"]),
        "captured_s": round(float(walk.row["duration_s"]), 3),
        "captured": frames(walk.time_s - walk.time_s[0], walk.position_m),
        "trials": [_trial(walk, route, row, planner, names, time_limit_s) for row in trials.to_dict("records")],
    }


def _trial(
    walk: Walk, route: Array, row: Mapping[Any, Any], planner: Planner, names: Sequence[str], time_limit_s: float
) -> dict[str, Any]:
    parameters = np.array([row[name] for name in names], dtype=float)
    path = planner.follow(route, task_of(walk.row), parameters, min(time_limit_s, LONGEST_S))
    return {
        "model": row["model"],
        "parameters": [round(float(value), 3) for value in parameters],
        "simulated_s": round(float(row["simulated_s"]), 3),
        "dt_s": round(float(row["dt_s"]), 3),
        "arrival": str(row["arrival"]),
        "collided": bool(row["collided"]),
        "path": frames(np.arange(len(path.positions_m), dtype=float) * path.step_s, path.positions_m),
    }


def frames(time_s: Array, position_m: Array) -> list[int]:
    """Positions every ``FRAME_S``, the last one included: x and y in turn, centimetres."""
    count = int(np.ceil(time_s[-1] / FRAME_S)) + 1
    at = np.minimum(np.arange(count) * FRAME_S, time_s[-1])
    return _centimetres(np.column_stack([np.interp(at, time_s, position_m[:, axis]) for axis in (0, 1)]))


def _centimetres(points_m: Array) -> list[int]:
    values: list[int] = np.rint(np.asarray(points_m, dtype=float) * 100).astype(int).ravel().tolist()
    return values
