"""Whole simulated walks timed one after the other in double precision: what :mod:`walklab.planning.trace_kernel` cannot take."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.planning.following_kernel import AT_END, Rule, follow_route

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Integers = NDArray[np.int64]


@njit(cache=True)
def travel_steps(positions: Array, least_m: float, moving_start: bool, moving_end: bool) -> int:
    """Steps from the last standing to the first standing frame of a walk that has ended.

    As :func:`walklab.planning.durations.trajectory_travel_time_s`: a frame moves whose neighbours lie ``least_m`` apart;
    before its first frame and after its last the walker stands.
    """
    last = len(positions) - 1
    start, end, found = 0, 0, False
    for frame in range(-1, last + 2):
        before, after = max(frame - 1, 0), min(frame + 1, last)
        dx, dy = positions[after, 0] - positions[before, 0], positions[after, 1] - positions[before, 1]
        if np.sqrt(dx * dx + dy * dy) >= least_m:
            start, end = start if found else frame - 1, frame + 1
            found = True
    return (last if moving_end else end) - (0 if moving_start else start)


@njit(cache=True, nogil=True)
def trace_singles(
    routes: Array, route_offsets: Integers, end_speeds: tuple[Array, Array], order: Integers, cells: Array, rule: Rule,
    least_m: float, frames: Integers, steps: int, found: Singles, places: Singles,
) -> None:  # fmt: skip
    """Fill the rows of the walks in ``order``: ``found`` (walks, cells, 3) and ``places`` (walks, cells, K, 2).

    ``found`` holds travel time in steps, whether the walk ended within ``steps``, and how far from the route's end, metres.
    """
    heading = np.empty(2)
    for walk in order:
        route = routes[route_offsets[walk] : route_offsets[walk + 1]]
        start_speed, end_speed = end_speeds[0][walk], end_speeds[1][walk]
        moving_start, moving_end = start_speed * 2 * rule[3] >= least_m, end_speed * 2 * rule[3] >= least_m
        heading[0], heading[1] = route[0, 3], route[0, 4]
        for cell in range(len(cells)):
            positions, status = follow_route(route, heading, start_speed, end_speed, cells[cell], rule, steps)
            last = len(positions) - 1
            dx, dy = positions[last, 0] - route[-1, 0], positions[last, 1] - route[-1, 1]
            found[walk, cell, 0] = travel_steps(positions, least_m, moving_start, moving_end)
            found[walk, cell, 1] = 1 if status == AT_END else 0
            found[walk, cell, 2] = np.sqrt(dx * dx + dy * dy)
            for k in range(frames.shape[1]):
                at = min(frames[walk, k], last)
                places[walk, cell, k, 0], places[walk, cell, k, 1] = positions[at, 0], positions[at, 1]
