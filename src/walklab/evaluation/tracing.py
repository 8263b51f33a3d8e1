"""Captured walks beside the traces of all cells: what the grid scores need, by walk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.geometry import curves
from walklab.geometry.scene import Task
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.planning.tracing import Traces, trace_cells
from walklab.steering.routes import task_of
from walklab.steering.space import ParameterSpace

Array = NDArray[np.float64]

PLACES = 8
PATIENCE_S, SLOW_M_S = 1.0, 0.5


def score_times(lengths_m: Array) -> Array:
    """(W, 8) times at which trajectories are compared, from the length of the planned route alone.

    A horizon that depended on how long the captured walk took would make the energy score improper: the forecast would be
    judged by a rule that knows the answer.
    """
    # ASSUME: Trajectories are compared up to 1 s + length / (0.5 m/s), by which time nearly all captured walks have ended.
    horizon = PATIENCE_S + np.asarray(lengths_m, dtype=float) / SLOW_M_S
    return np.multiply.outer(horizon, np.arange(1, PLACES + 1) / PLACES)


def captured_places(walks: Sequence[Walk], times_s: Array) -> Array:
    """(W, K, 2) where each person was at these times, standing at the end of the walk after it; metres."""
    return np.stack(
        [
            np.column_stack([np.interp(at, walk.time_s - walk.time_s[0], walk.position_m[:, axis]) for axis in (0, 1)])
            for walk, at in zip(walks, times_s, strict=True)
        ]
    )


def compared_places(walks: Sequence[Walk], routes: Mapping[str, Array]) -> tuple[list[Array], Array, Array]:
    """The walks' own routes, the times (W, 8) at which trajectories on them are compared, and the captured places then."""
    own = [np.asarray(routes[str(walk.row["walk"])], dtype=float) for walk in walks]
    times_s = score_times(np.array([curves.length(route) for route in own]))
    return own, times_s, captured_places(walks, times_s)


def trace_walks(
    walks: Sequence[Walk],
    routes: Mapping[str, Array],
    planner: Planner,
    space: ParameterSpace,
    standing: Standing,
    time_limit_s: float,
) -> tuple[Traces, Array]:
    """Traces of every cell for the walks' tasks and routes, and the captured places at the same times."""
    own, times_s, captured = compared_places(walks, routes)
    tasks = [task_of(walk.row) for walk in walks]
    traces = trace_cells(planner, own, tasks, space.cells, times_s, standing.standing_speed_m_s, time_limit_s)
    return traces, captured


def drawn_energy(
    walks: Sequence[Walk], routes: Mapping[str, Array], planner: Planner, parameters: Array, time_limit_s: float
) -> Array:
    r"""Energy score of the trajectories of drawn parameters, :math:`\bar d(x_i, y) - \frac{1}{2} \bar d(x_i, x_j), i \ne j`.

    It has noise, but no bias by the number of draws. Distances d are those of
    :func:`walklab.evaluation.grid_scores.grid_energy`, between places at the same times. One vector for each walk is a point, and
    the score its distance.

    Parameters
    ----------
    parameters : (W, M, P) for each walk

    Returns
    -------
    (W,) array, metres
    """
    own, times_s, captured = compared_places(walks, routes)
    scores = np.empty(len(walks))
    for row, walk in enumerate(walks):
        frames = np.rint(times_s[row] / planner.step_s).astype(np.int64)
        task = task_of(walk.row)
        drawn = np.stack([_places(planner, own[row], task, values, frames, time_limit_s) for values in parameters[row]])
        near = np.sqrt(((drawn - captured[row]) ** 2).sum(axis=2).mean(axis=1))
        apart = np.sqrt(((drawn[:, None] - drawn[None]) ** 2).sum(axis=3).mean(axis=2))
        scores[row] = near.mean() - 0.5 * apart.sum() / max(len(drawn) * (len(drawn) - 1), 1)
    return scores


def _places(planner: Planner, route: Array, task: Task, values: Array, frames: NDArray[np.int64], time_limit_s: float) -> Array:
    """(K, 2) places at the frames, standing at the end after the last."""
    positions = planner.follow(route, task, values, time_limit_s).positions_m
    return np.asarray(positions[np.minimum(frames, len(positions) - 1)])
