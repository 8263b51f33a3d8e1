"""Path following of many parameter vectors side by side: :func:`walklab.planning.following_kernel.sweep` in single precision.

The walkers of one captured walk advance together, 16 to a vector instruction of 512 bits. What makes that fast:

- All quantities of a tile of walkers are rows of *one* flat array, a constant distance apart. So the compiler sees that no two
  rows overlap, and vectorises every loop over the walkers without asking again at run time.
- No branches, trigonometry or table look-ups per walker: speed limits are minima and maxima; the legs of the route that any
  walker of the tile can be concerned with are tried one after the other.
- Until the look-ahead point passes the first corner a walker goes straight on, whatever its turning limit: progress and speed
  are all there is to it, and walkers that differ in omega alone are one walker until then.
- A walker that has ended leaves its tile; what its standing still adds to the score is summed up at once.

Nothing is contracted or reassociated (no fused multiply-add), so that single precision gives the same scores on every machine.
Positions are relative to the route's end, where braking is most sensitive to them.

The loops over the walkers of a tile are in :mod:`walklab.planning.lane_loops`; here tiles are filled, led along and emptied.
Loops run to a whole number of vectors; the surplus walkers are computed and ignored. Units are metres and seconds throughout.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.planning.following_kernel import PROPORTIONAL, Rule
from walklab.planning.lane_loops import (
    END_TOLERANCE_M,
    FAR_M,
    FLAGS,
    FRAME,
    GAIN,
    HALF,
    HALF_OMEGA,
    HX,
    HY,
    LANES,
    NEXT,
    ONE,
    PROGRESS,
    ROWS,
    SCORE,
    SPEED,
    TRAVELLED,
    WIDTH,
    ZERO,
    Array,
    B,
    Groups,
    Lanes,
    Single,
    V,
    Walk,
    X,
    Y,
    look_along,
    project,
    score_and_speed,
    turn_and_move,
    walk_straight,
)


@njit(cache=True)
def spread(bits: NDArray[np.int32], count: int) -> tuple[Single, Single]:
    """Least and greatest progress. Numbers not below zero have the order of their bits, and minima of integers vectorise."""
    any_of_them = bits[NEXT]
    least = greatest = any_of_them
    for i in range(vectors(count)):
        own = bits[NEXT + i] if i < count else any_of_them
        least, greatest = min(least, own), max(greatest, own)
    return np.int32(least).view(np.float32), np.int32(greatest).view(np.float32)


@njit(inline="always")
def vectors(count: int) -> int:
    """The next whole number of vectors, in walkers."""
    return (count + WIDTH - 1) // WIDTH * WIDTH


@njit(cache=True)
def leg_at(legs: Lanes, leg: int, at_m: Single) -> int:
    """Index of the leg that holds an arc length, searched forward from ``leg``."""
    while leg + 1 < legs.shape[0] and legs[leg, 1] < at_m:
        leg += 1
    return leg


@njit(cache=True, fastmath=FLAGS)
def standing_score(frames: Lanes, first: int, x: Single, y: Single) -> Single:
    """Sum of the distances of the captured frames from ``first`` on to a point."""
    partial = np.zeros(WIDTH, np.float32)
    whole = first + (frames.shape[1] - first) // WIDTH * WIDTH
    for start in range(first, whole, WIDTH):
        for j in range(WIDTH):
            gx, gy = frames[0, start + j] - x, frames[1, start + j] - y
            partial[j] += np.sqrt(gx * gx + gy * gy)
    total = ZERO
    for j in range(WIDTH):
        total += partial[j]
    for n in range(whole, frames.shape[1]):
        gx, gy = frames[0, n] - x, frames[1, n] - y
        total += np.sqrt(gx * gx + gy * gy)
    return total


@njit(cache=True, error_model="numpy")
def end_point(lanes: Lanes, i: int, legs: Lanes) -> tuple[Single, Single]:
    """Where a walker that has ended stands: its last step is cut at the line through the route's end, across the last leg."""
    x, y, hx, hy = lanes[X + i], lanes[Y + i], lanes[HX + i], lanes[HY + i]
    forward = hx * legs[-1, 4] + hy * legs[-1, 5]
    beyond = x * legs[-1, 4] + y * legs[-1, 5]
    if ZERO < beyond < forward * lanes[TRAVELLED + i]:
        return x - beyond / forward * hx, y - beyond / forward * hy
    return x, y


@njit(cache=True)
def leave(
    lanes: Lanes, count: int, cells_in: NDArray[np.int64], legs: Lanes, frames: Lanes, n: int, total: Single, scores: Array
) -> int:
    """Score the walkers that have ended before frame ``n`` to the last frame and close the gaps; how many walk on."""
    i = 0
    while i < count:
        if lanes[NEXT + i] < total - END_TOLERANCE_M:
            i += 1
            continue
        x, y = end_point(lanes, i, legs)
        scores[cells_in[i]] = lanes[SCORE + i] + standing_score(frames, n, x, y)
        count -= 1
        cells_in[i] = cells_in[count]
        for row in range(0, ROWS * LANES, LANES):
            lanes[row + i] = lanes[row + count]
    return count


@njit(cache=True)
def enter(lanes: Lanes, i: int, values: Lanes, cell: int, start: Lanes, group: int, legs: Lanes, step_s: Single) -> None:
    """Give a walker's place in the tile to a cell whose first turn begins."""
    progress = start[group, 1]
    lanes[X + i], lanes[Y + i] = legs[0, 2] + progress * legs[0, 4], legs[0, 3] + progress * legs[0, 5]
    lanes[HX + i], lanes[HY + i] = legs[0, 4], legs[0, 5]
    lanes[NEXT + i], lanes[SPEED + i], lanes[SCORE + i] = progress, start[group, 2], start[group, 3]
    lanes[V + i], lanes[GAIN + i] = values[cell, 0], values[cell, 1] * step_s
    lanes[HALF_OMEGA + i], lanes[B + i] = HALF * values[cell, 2], values[cell, 3]


@njit(cache=True)
def walk_tile(
    lanes: Lanes,
    bits: NDArray[np.int32],
    queue: NDArray[np.int64],
    start: Lanes,
    values: Lanes,
    legs: Lanes,
    frames: Lanes,
    walk: Walk,
    scores: Array,
) -> None:
    """Walk the queued (cell, group) from their first turns, in this order, to the last captured frame.

    ``bits`` are those of ``lanes``, as integers.
    """
    total, _, _, look_ahead, step_s, _ = walk
    cells_in = np.empty(LANES, np.int64)
    count, entered, n = 0, 0, 0
    while n < frames.shape[1]:
        if count == 0 and entered < len(queue):
            n = max(n, int(start[queue[entered, 1], 0]))
        while entered < len(queue) and int(start[queue[entered, 1], 0]) <= n:
            cells_in[count] = queue[entered, 0]
            enter(lanes, count, values, queue[entered, 0], start, queue[entered, 1], legs, step_s)
            count, entered = count + 1, entered + 1
        least, greatest = spread(bits, count)
        size = vectors(count)
        low = leg_at(legs, 0, least)
        first = leg_at(legs, low, least + look_ahead)
        high = leg_at(legs, first, greatest + look_ahead)
        score_and_speed(lanes, size, frames[0, n], frames[1, n], legs, first, walk)
        for leg in range(first + 1, high + 1):
            look_along(lanes, size, legs, leg, walk)
        turn_and_move(lanes, size, walk)
        for leg in range(low, high + 1):
            project(lanes, size, legs, leg, walk)
        n += 1
        if high == len(legs) - 1 and spread(bits, count)[1] >= total - END_TOLERANCE_M:
            count = leave(lanes, count, cells_in, legs, frames, n, total, scores)
            if count == 0 and entered == len(queue):
                return
    for i in range(count):
        scores[cells_in[i]] = lanes[SCORE + i]


@njit(cache=True)
def start_groups(
    lanes: Lanes, values: Lanes, groups: Groups, along: Lanes, aside: Lanes, corner: Single, start_speed: Single, walk: Walk
) -> Lanes:
    """The straight beginning, once per group of equal (v, a, b): (groups, 4) array of frame, progress, speed and score."""
    count = len(groups[1]) - 1
    start = np.empty((count, 4), np.float32)
    for tile in range(0, count, LANES):
        here = min(LANES, count - tile)
        for i in range(vectors(here)):
            cell = groups[0][groups[1][min(tile + i, count - 1)]]
            lanes[PROGRESS + i], lanes[SPEED + i], lanes[SCORE + i], lanes[FRAME + i] = ZERO, start_speed, ZERO, ZERO
            lanes[V + i], lanes[GAIN + i], lanes[B + i] = values[cell, 0], values[cell, 1] * walk[4], values[cell, 3]
        walk_straight(lanes, vectors(here), along, aside, corner, walk)
        for i in range(here):
            start[tile + i, 0], start[tile + i, 1] = lanes[FRAME + i], lanes[PROGRESS + i]
            start[tile + i, 2], start[tile + i, 3] = lanes[SPEED + i], lanes[SCORE + i]
    return start


@njit(cache=True)
def queue_cells(start: Lanes, groups: Groups, last: int, scores: Array) -> NDArray[np.int64]:
    """The cells (and their groups) in the order of their first turns; those without one before the ``last`` frame are scored."""
    begin = np.zeros(last + 2, np.int64)  # where the cells of each frame begin: a counting sort
    for group in range(len(start)):
        begin[int(start[group, 0]) + 1] += groups[1][group + 1] - groups[1][group]
    begin = np.cumsum(begin)
    queue = np.empty((begin[last], 2), np.int64)
    for group in range(len(start)):
        frame = int(start[group, 0])
        for at in range(groups[1][group], groups[1][group + 1]):
            if frame == last:
                scores[groups[0][at]] = start[group, 3]
            else:
                queue[begin[frame], 0], queue[begin[frame], 1] = groups[0][at], group
                begin[frame] += 1
    return queue


@njit(cache=True)
def aligned(size: int) -> Lanes:
    """Zeros from the beginning of a cache line on, so that no vector lies across two."""
    block = np.zeros(size + WIDTH, np.float32)
    first = -(block.ctypes.data // 4) % WIDTH
    return block[first : first + size]


@njit(cache=True)
def legs_of(route: Array) -> Lanes:
    """Per leg: arc length at its start and end, point where its line has arc length zero, direction; about the route's end."""
    legs = np.zeros((max(len(route) - 1, 1), 6), np.float32)
    legs[0, 4] = ONE  # a route without extent has any direction
    for k in range(len(route) - 1):
        legs[k, 0], legs[k, 1] = route[k, 2], route[k + 1, 2]
        legs[k, 2] = route[k, 0] - route[-1, 0] - route[k, 2] * route[k, 3]
        legs[k, 3] = route[k, 1] - route[-1, 1] - route[k, 2] * route[k, 4]
        legs[k, 4], legs[k, 5] = route[k, 3], route[k, 4]
    return legs


@njit(cache=True)
def about_first_leg(route: Array, captured: Array) -> tuple[Lanes, Lanes]:
    """Where the captured frames are along the first leg, and their squared distance from it."""
    along, aside = np.empty(len(captured), np.float32), np.empty(len(captured), np.float32)
    dx, dy = (route[0, 3], route[0, 4]) if len(route) > 1 else (1.0, 0.0)
    for n in range(len(captured)):
        rx, ry = captured[n, 0] - route[0, 0], captured[n, 1] - route[0, 1]
        along[n], aside[n] = rx * dx + ry * dy, (rx * dy - ry * dx) ** 2
    return along, aside


@njit(cache=True)
def score_walk(
    route: Array, captured: Array, start_speed: float, end_speed: float, values: Lanes, groups: Groups, rule: Rule, scores: Array
) -> None:
    """Sums of the distances between one captured walk and the simulated ones over the captured frames."""
    legs = legs_of(route)
    total = legs[-1, 1]
    brake_total = total if rule[1] else FAR_M
    walk = (total, brake_total, Single(end_speed), Single(rule[0]), Single(rule[3]), rule[2] == PROPORTIONAL)
    frames = np.empty((2, len(captured)), np.float32)
    for n in range(len(captured)):
        frames[0, n], frames[1, n] = captured[n, 0] - route[-1, 0], captured[n, 1] - route[-1, 1]
    lanes = aligned(ROWS * LANES)
    bits = lanes.view(np.int32)
    along, aside = about_first_leg(route, captured)
    corner = legs[0, 1] if len(legs) > 1 else FAR_M
    start = start_groups(lanes, values, groups, along, aside, corner, Single(start_speed), walk)
    queue = queue_cells(start, groups, len(captured), scores)
    for first in range(0, len(queue), LANES):
        walk_tile(lanes, bits, queue[first : first + LANES], start, values, legs, frames, walk, scores)


@njit(cache=True, nogil=True)
def sweep_lanes(
    routes: Array,
    route_offsets: NDArray[np.int64],
    captured: Array,
    captured_offsets: NDArray[np.int64],
    end_speeds: tuple[Array, Array],
    lengths: Array,
    order: NDArray[np.int64],
    values: Lanes,
    groups: Groups,
    rule: Rule,
    scores: Array,
) -> None:
    """Fill the rows of ``scores`` of the walks in ``order``; arguments as in :func:`walklab.planning.following_kernel.sweep`.

    ``values`` are the cells' v, a, omega and b, all finite; ``groups`` is from :func:`group_cells`.
    """
    for walk in order:
        route = routes[route_offsets[walk] : route_offsets[walk + 1]]
        frames = captured[captured_offsets[walk] : captured_offsets[walk + 1]]
        score_walk(route, frames, end_speeds[0][walk], end_speeds[1][walk], values, groups, rule, scores[walk])
        per_sum = rule[3] / lengths[walk]
        for cell in range(len(values)):
            scores[walk, cell] *= per_sum


def group_cells(values: Array) -> Groups:
    """The order of cells that brings those of equal v, a and b together, and where each such group begins (and the last ends)."""
    v, a, _, b = values.T
    cells = np.lexsort((b, a, v))
    changes = np.any(np.diff(values[cells][:, [0, 1, 3]], axis=0) != 0, axis=1)
    return cells, np.concatenate([[0], np.flatnonzero(changes) + 1, [len(cells)]])
