"""Whole simulated walks of many parameter vectors side by side: when they move, how they end, and where they are at given times.

The walkers go as in :mod:`walklab.planning.lane_kernel`, whose loops these are, but to their end instead of to the last captured
frame, and they are timed instead of scored. Nothing captured is read. Until the first corner comes into view, walkers that
differ in omega alone are one, walked in double precision.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.planning.following_kernel import END_TOLERANCE_M as STRAIGHT_TOLERANCE_M
from walklab.planning.following_kernel import PROPORTIONAL, Rule, next_speed
from walklab.planning.lane_kernel import aligned, end_point, enter, leg_at, legs_of, spread, vectors
from walklab.planning.lane_loops import (
    END_TOLERANCE_M,
    FAR_M,
    FLAGS,
    LANES,
    NEXT,
    ROWS,
    TRAVELLED,
    ZERO,
    Array,
    Groups,
    Lanes,
    Single,
    Walk,
    X,
    Y,
    look_along,
    project,
    score_and_speed,
    turn_and_move,
)

Integers = NDArray[np.int64]

BEFORE, FIRST, LAST = ROWS * LANES, (ROWS + 1) * LANES, (ROWS + 2) * LANES  # rows beside those of the lanes
ALL_ROWS = ROWS + 3
FIRST_MOVING, LAST_MOVING, STEPS, AT_END, MISSED_M = range(5)  # columns of what is found
COLUMNS = 5


@njit(cache=True, fastmath=FLAGS)
def mark(lanes: Lanes, size: int, n: int, least: Single) -> None:
    """Note who moves at frame n: who covers ``least`` metres in the steps before and after it together."""
    at = Single(n)
    for i in range(size):
        before, after = lanes[BEFORE + i], lanes[TRAVELLED + i]
        moves = before + after >= least
        first, last = lanes[FIRST + i], lanes[LAST + i]
        lanes[LAST + i] = at if moves else last
        lanes[FIRST + i] = at if moves and first < ZERO else first


@njit(cache=True)
def last_moving(last: float, steps: int, before_m: float, cut_m: float, least_m: float) -> float:
    """The last moving frame of a walk that ended after ``steps`` with a step cut to ``cut_m``, the one before it uncut."""
    if cut_m >= least_m:
        return float(steps)
    if before_m + cut_m >= least_m:
        return float(steps - 1)
    return min(last, float(steps - 2))


@njit(cache=True)
def straight_start(
    values: Array,
    total: float,
    corner: float,
    speeds: tuple[float, float],
    rule: Rule,
    least_m: float,
    frames: Integers,
    steps: int,
    progress_at: Array,
) -> tuple[float, float, float, float, float, float, bool]:
    """Straight on until the look-ahead point is beyond ``corner``, the route ends, or ``steps`` are taken.

    Fills ``progress_at`` for the frames passed. Returns frame, progress, speed, first and last moving frame, metres of the last
    step, and whether the route ended.
    """
    look_ahead, braking, _, step_s, _ = rule
    progress, speed, before, first, last = 0.0, speeds[0], 0.0, -1.0, -1.0
    n, k = 0, 0
    while n < steps and progress + look_ahead <= corner:
        while k < len(frames) and frames[k] == n:
            progress_at[k] = progress
            k += 1
        new = next_speed(speed, values[0], values[1], values[3], speeds[1], total - progress, braking, step_s)
        travelled = 0.5 * (speed + new) * step_s
        if before + travelled >= least_m:
            last = float(n)
            first = last if first < 0 else first
        n += 1
        if progress + travelled >= total - STRAIGHT_TOLERANCE_M:
            last = last_moving(last, n, before, total - progress, least_m)
            for j in range(k, len(frames)):
                progress_at[j] = total
            return float(n), total, speed, first, last, travelled, True
        progress, speed, before = progress + travelled, new, travelled
    while k < len(frames) and frames[k] == n:
        progress_at[k] = progress
        k += 1
    for j in range(k, len(frames)):  # at the time limit it is still here
        progress_at[j] = progress
    return float(n), progress, speed, first, last, before, False


@njit(cache=True)
def take_out(
    lanes: Lanes, count: int, cells_in: Integers, legs: Lanes, n: int, total: Single, least: Single, frames: Integers,
    found: Lanes, places: Lanes,
) -> int:  # fmt: skip
    """Note how the walkers that have ended before frame ``n`` ended and close the gaps; how many walk on."""
    i = 0
    while i < count:
        if lanes[NEXT + i] < total - END_TOLERANCE_M:
            i += 1
            continue
        cell = cells_in[i]
        x, y = end_point(lanes, i, legs)
        here_x, here_y = lanes[X + i], lanes[Y + i]
        cut = lanes[TRAVELLED + i] - np.sqrt((here_x - x) ** 2 + (here_y - y) ** 2)
        found[cell, FIRST_MOVING] = lanes[FIRST + i]
        found[cell, LAST_MOVING] = last_moving(float(lanes[LAST + i]), n, float(lanes[BEFORE + i]), float(cut), float(least))
        found[cell, STEPS], found[cell, AT_END], found[cell, MISSED_M] = n, 1, np.sqrt(x * x + y * y)
        for k in range(len(frames)):
            if frames[k] >= n:
                places[cell, k, 0], places[cell, k, 1] = x, y
        count -= 1
        cells_in[i] = cells_in[count]
        for row in range(0, ALL_ROWS * LANES, LANES):
            lanes[row + i] = lanes[row + count]
    return count


@njit(cache=True)
def trace_tile(
    lanes: Lanes, bits: NDArray[np.int32], queue: Integers, start: Lanes, values: Lanes, legs: Lanes, walk: Walk, least: Single,
    frames: Integers, steps: int, found: Lanes, places: Lanes,
) -> None:  # fmt: skip
    """Walk the queued (cell, group) from their first turns, in this order, to their ends or the last step."""
    total, _, _, look_ahead, step_s, _ = walk
    cells_in = np.empty(LANES, np.int64)
    count, entered, n, k = 0, 0, 0, 0
    while n < steps and (count > 0 or entered < len(queue)):
        if count == 0:
            n = max(n, int(start[queue[entered, 1], 0]))
        while entered < len(queue) and int(start[queue[entered, 1], 0]) <= n:
            group = queue[entered, 1]
            cells_in[count] = queue[entered, 0]
            enter(lanes, count, values, queue[entered, 0], start, group, legs, step_s)
            lanes[FIRST + count], lanes[LAST + count], lanes[TRAVELLED + count] = (
                start[group, 4],
                start[group, 5],
                start[group, 6],
            )
            count, entered = count + 1, entered + 1
        while k < len(frames) and frames[k] < n:
            k += 1
        if k < len(frames) and frames[k] == n:
            for i in range(count):
                places[cells_in[i], k, 0], places[cells_in[i], k, 1] = lanes[X + i], lanes[Y + i]
        least_m, greatest_m = spread(bits, count)
        size = vectors(count)
        low = leg_at(legs, 0, least_m)
        first = leg_at(legs, low, least_m + look_ahead)
        high = leg_at(legs, first, greatest_m + look_ahead)
        for i in range(size):
            lanes[BEFORE + i] = lanes[TRAVELLED + i]
        score_and_speed(lanes, size, ZERO, ZERO, legs, first, walk)
        for leg in range(first + 1, high + 1):
            look_along(lanes, size, legs, leg, walk)
        turn_and_move(lanes, size, walk)
        for leg in range(low, high + 1):
            project(lanes, size, legs, leg, walk)
        n += 1
        if high == len(legs) - 1 and spread(bits, count)[1] >= total - END_TOLERANCE_M:
            count = take_out(lanes, count, cells_in, legs, n, total, least, frames, found, places)
        mark(lanes, vectors(count), n - 1, least)
    for i in range(count):
        found[cells_in[i], FIRST_MOVING], found[cells_in[i], LAST_MOVING] = lanes[FIRST + i], lanes[LAST + i]
        found[cells_in[i], STEPS], found[cells_in[i], AT_END] = steps, 0
        for j in range(len(frames)):
            if frames[j] >= steps:
                places[cells_in[i], j, 0], places[cells_in[i], j, 1] = lanes[X + i], lanes[Y + i]


@njit(cache=True)
def trace_walk(
    route: Array, speeds: tuple[float, float], values: Array, singles: Lanes, groups: Groups, rule: Rule, least_m: float,
    frames: Integers, steps: int, found: Lanes, places: Lanes,
) -> None:  # fmt: skip
    """Fill ``found`` (cells, 5) and ``places`` (cells, frames, 2), metres about the route's end, for one walk."""
    legs = legs_of(route)
    total = route[-1, 2]
    brake_total = total if rule[1] else float(FAR_M)
    single = (Single(total), Single(brake_total), Single(speeds[1]), Single(rule[0]), Single(rule[3]), rule[2] == PROPORTIONAL)
    corner = route[1, 2] if len(route) > 2 else np.inf
    order, begins = groups
    start = np.empty((len(begins) - 1, 7), np.float32)
    progress_at = np.empty(len(frames))
    waiting = np.zeros(steps + 2, np.int64)
    for group in range(len(begins) - 1):
        one = values[order[begins[group]]]
        frame, progress, speed, first, last, before, ended = straight_start(
            one, total, corner, speeds, rule, least_m, frames, steps, progress_at
        )
        start[group, 0], start[group, 1], start[group, 2], start[group, 3] = frame, progress, speed, 0.0
        start[group, 4], start[group, 5], start[group, 6] = first, last, before
        for at in range(begins[group], begins[group + 1]):
            cell = order[at]
            found[cell, FIRST_MOVING], found[cell, LAST_MOVING] = first, last
            found[cell, STEPS], found[cell, AT_END] = frame, 1.0 if ended else 0.0
            for k in range(len(frames)):
                places[cell, k, 0] = legs[0, 2] + progress_at[k] * legs[0, 4]
                places[cell, k, 1] = legs[0, 3] + progress_at[k] * legs[0, 5]
        if not ended and frame < steps:
            waiting[int(frame) + 1] += begins[group + 1] - begins[group]
    waiting = np.cumsum(waiting)  # where the cells that turn first at each frame begin: a counting sort
    queue = np.empty((waiting[-1], 2), np.int64)
    for group in range(len(begins) - 1):
        frame_n = int(start[group, 0])
        if frame_n < steps and found[order[begins[group]], AT_END] == 0.0:
            for at in range(begins[group], begins[group + 1]):
                queue[waiting[frame_n], 0], queue[waiting[frame_n], 1] = order[at], group
                waiting[frame_n] += 1
    lanes = aligned(ALL_ROWS * LANES)
    bits = lanes.view(np.int32)
    for tile in range(0, len(queue), LANES):
        trace_tile(
            lanes, bits, queue[tile : tile + LANES], start, singles, legs, single, Single(least_m), frames, steps, found, places
        )


@njit(cache=True, nogil=True)
def trace_lanes(
    routes: Array, route_offsets: Integers, end_speeds: tuple[Array, Array], order: Integers, values: Array, singles: Lanes,
    groups: Groups, rule: Rule, least_m: float, frames: Integers, steps: int, found: Lanes, places: Lanes,
) -> None:  # fmt: skip
    """:func:`trace_walk` for the walks in ``order``: fills their rows of ``found`` and ``places``.

    ``frames`` (walks, K) ascending step numbers at which places are noted; ``least_m`` is twice the way of a standing step.
    """
    for walk in order:
        route = routes[route_offsets[walk] : route_offsets[walk + 1]]
        speeds = (end_speeds[0][walk], end_speeds[1][walk])
        trace_walk(route, speeds, values, singles, groups, rule, least_m, frames[walk], steps, found[walk], places[walk])
