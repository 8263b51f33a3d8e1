"""Travel time, arrival and places of every parameter vector on every walk, from tasks and routes alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.geometry.scene import Task
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.lane_kernel import group_cells
from walklab.planning.path_following import TURNS_AT_ONCE, PathFollowing, share_out
from walklab.planning.protocol import Arrival, Planner
from walklab.planning.routes import prepare_routes
from walklab.planning.trace_kernel import COLUMNS, trace_lanes
from walklab.planning.trace_singles import trace_singles

Array = NDArray[np.float64]
Singles = NDArray[np.float32]

STEPS_A_CELL = 300  # of a typical walk; only decides how many threads are worth it


@dataclass(frozen=True)
class Traces:
    """What came of W walks with C parameter vectors each.

    Attributes
    ----------
    travel_s : (W, C) travel times, by the thresholds of the captured ones; the time limit for a walk that reached it
    arrived : (W, C) whether the walk came to its end position
    places_m : (W, C, K, 2) where it was at the K times asked for, standing at its end after it; metres
    """

    travel_s: Singles
    arrived: NDArray[np.bool_]
    places_m: Singles

    def __len__(self) -> int:
        return len(self.travel_s)

    def rows(self, walks: NDArray[np.int64]) -> Traces:
        """Those of some of the walks."""
        return Traces(self.travel_s[walks], self.arrived[walks], self.places_m[walks])


def trace_cells(
    planner: Planner,
    routes: Sequence[Array],
    tasks: Sequence[Task],
    cells: ArrayLike,
    times_s: ArrayLike,
    standing_speed_m_s: float,
    time_limit_s: float,
) -> Traces:
    """Simulate every walk with every parameter vector to its end.

    Path following is traced in compiled lanes (single precision), what does not fit these in compiled code one by one, and any
    other planner by :meth:`~walklab.planning.protocol.Planner.follow`.

    Parameters
    ----------
    routes, tasks : W of them; headings are along the first leg
    cells : (C, P) in the order of ``planner.parameters``
    times_s : (W, K) ascending times at which places are noted, rounded to whole steps
    standing_speed_m_s : below it a walker stands

    Raises
    ------
    InputError
        If routes, tasks and times differ in number or a parameter has no sensible value.
    """
    points = np.ascontiguousarray(np.atleast_2d(cells), dtype=float)
    frames = np.rint(np.atleast_2d(np.asarray(times_s, dtype=float)) / planner.step_s).astype(np.int64)
    if not len(routes) == len(tasks) == len(frames):
        raise InputError(
            f"tracing: {len(routes)} routes, {len(tasks)} tasks and {len(frames)} rows of times; one of each per walk"
        )
    traces = Traces(
        np.empty((len(routes), len(points)), np.float32),
        np.empty((len(routes), len(points)), bool),
        np.empty((len(routes), len(points), frames.shape[1], 2), np.float32),
    )
    left = list(range(len(routes)))
    if isinstance(planner, PathFollowing) and len(routes):
        left = _trace_compiled(planner, routes, tasks, points, frames, standing_speed_m_s, time_limit_s, traces)
    for walk in left:
        for cell, values in enumerate(points):
            trajectory = planner.follow(routes[walk], tasks[walk], values, time_limit_s)
            timeout = trajectory.arrival == Arrival.TIMEOUT
            travel_s = time_limit_s if timeout else trajectory_travel_time_s(trajectory, tasks[walk], standing_speed_m_s)
            traces.travel_s[walk, cell], traces.arrived[walk, cell] = travel_s, trajectory.arrival == Arrival.ARRIVED
            traces.places_m[walk, cell] = trajectory.positions_m[np.minimum(frames[walk], len(trajectory.positions_m) - 1)]
    return traces


def _trace_compiled(
    planner: PathFollowing,
    routes: Sequence[Array],
    tasks: Sequence[Task],
    cells: Array,
    frames: NDArray[np.int64],
    standing_speed_m_s: float,
    time_limit_s: float,
    traces: Traces,
) -> list[int]:
    """Fill the rows of the walks that fit the lanes; the indices of the others."""
    values = planner.kernel_parameters(cells)
    speeds = (
        np.array([task.start.speed_m_s for task in tasks], dtype=float),
        np.array([task.end.speed_m_s for task in tasks], dtype=float),
    )
    packed, offsets = prepare_routes(
        np.ascontiguousarray(np.concatenate(routes), dtype=float), np.cumsum([0, *map(len, routes)]).astype(np.int64)
    )
    plain = (np.diff(offsets) > 1) & np.array([task.start.heading_rad is None for task in tasks])
    fits = plain & planner.in_lanes(values, speeds, packed[offsets[1:] - 1, 2])
    steps = max(math.ceil(time_limit_s / planner.step_s - 1e-9), 0)
    found = np.zeros((len(routes), len(values), COLUMNS), np.float32)
    fixed = (values, np.minimum(values, TURNS_AT_ONCE).astype(np.float32), group_cells(values), planner.rule)
    least_m = 2 * planner.step_s * standing_speed_m_s
    share_out(
        lambda own: trace_lanes(packed, offsets, speeds, own, *fixed, least_m, frames, steps, found, traces.places_m),
        np.flatnonzero(fits),
        STEPS_A_CELL * np.where(np.diff(offsets) > 2, 0.1, 0.02) * len(values),
    )
    traces.places_m[fits] += packed[offsets[1:] - 1, :2][fits][:, None, None, :].astype(np.float32)
    first, last, taken, at_end, missed_m = (found[fits][:, :, column] for column in range(COLUMNS))
    moving = [(speed[fits] >= standing_speed_m_s)[:, None] for speed in speeds]
    begin = np.where(moving[0], 0, first - 1)
    end = np.where(moving[1], taken, last + 1)
    travel_s = np.where(first < 0, 0.0, (end - begin) * planner.step_s)
    traces.travel_s[fits] = np.where(at_end > 0, travel_s, time_limit_s)
    traces.arrived[fits] = (at_end > 0) & (missed_m <= planner.arrival_radius_m)
    singly = plain & ~fits
    share_out(
        lambda own: trace_singles(
            packed, offsets, speeds, own, values, planner.rule, least_m, frames, steps, found, traces.places_m
        ),
        np.flatnonzero(singly),
        np.full(len(routes), STEPS_A_CELL * len(values)),
    )
    taken, at_end, missed_m = (found[singly][:, :, column] for column in range(3))
    traces.travel_s[singly] = np.where(at_end > 0, taken * planner.step_s, time_limit_s)
    traces.arrived[singly] = (at_end > 0) & (missed_m <= planner.arrival_radius_m)
    return [int(walk) for walk in np.flatnonzero(~plain)]
