"""The compiled part of the grid and of Lazy Theta*; all lengths are in cells unless the name says otherwise.

It is one file because numba's cache of compiled code notices a change in the file of a function, but not in another
file whose functions it calls.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int32]
Cells = tuple[int, int]

# A clearance of minus a micrometre (at 1 cm cells) is rounding, not an overlap.
FREE_CELLS = -1e-4

# The stamp of a vertex where the body does not fit; it is odd, like those of expanded vertices.
BLOCKED = 2**31 - 1

# The open list: a ring of buckets of equal f. Buckets this narrow keep the excess of the path below what the grid itself
# causes; whole cells do not. The f of a vertex is at most 8.5 cells above that of the bucket it is found from: a wrong guess
# of its parent was made next to an expanded vertex (twice 2.83 cells), and it is one step (2.83 cells) further.
BUCKETS_PER_CELL = 32
RING = 512

# Steps of column and row to the nodes around a node: eight around a vertex, four to the corners of the cell of an end.
STEPS_U = np.array([-1, 0, 1, -1, 1, -1, 0, 1, 0, 1, 0, 1])
STEPS_V = np.array([-1, -1, -1, 0, 0, 1, 1, 1, 0, 0, 1, 1])

BEND_RAD = 0.1  # a taut path that turns more at one point gets more points there
BEND_CELLS = 10.0  # how far from a bend the two points are set that round it
BEND_ROUNDS = 3
TIGHTENING_SWEEPS = 4  # in each round


@njit(cache=True)
def clearance_at(clearance: NDArray[np.float32], first: Cells, u: float, v: float) -> float:
    """Clearance (cells) at lattice coordinates ``u = x / cell``, ``v = y / cell``, bilinear between vertices."""
    rows, columns = clearance.shape
    column = min(max(int(np.floor(u)), first[0]), first[0] + columns - 2)
    row = min(max(int(np.floor(v)), first[1]), first[1] + rows - 2)
    right, up = u - column, v - row
    i, j = row - first[1], column - first[0]
    below = (1.0 - right) * clearance[i, j] + right * clearance[i, j + 1]
    above = (1.0 - right) * clearance[i + 1, j] + right * clearance[i + 1, j + 1]
    return (1.0 - up) * below + up * above


@njit(cache=True, error_model="numpy")
def line_of_sight(clearance: NDArray[np.float32], first: Cells, u0: float, v0: float, u1: float, v1: float) -> bool:
    """Whether the line from one point to another (lattice coordinates) is clear.

    The line is walked from disc to disc of free space, in steps of 0.9 of the clearance but at least one cell.
    A step of one cell can cut at most ``cell^2 / (8 r)`` off the round corner of an obstacle grown by r:
    0.05 mm at 1 cm cells and r = 0.25 m. Far from obstacles the clearance of the nearest vertex less its
    largest distance, 0.71 cells, is close enough. Between neighbouring vertices only the ends are checked.
    """
    if clearance_at(clearance, first, u0, v0) < FREE_CELLS or clearance_at(clearance, first, u1, v1) < FREE_CELLS:
        return False
    du, dv = u1 - u0, v1 - v0
    distance = np.sqrt(du * du + dv * dv)
    if distance <= 1.5:
        return True
    du, dv = du / distance, dv / distance
    travelled = 0.0
    while travelled < distance:
        u, v = u0 + travelled * du, v0 + travelled * dv
        here = clearance[int(v - first[1] + 0.5), int(u - first[0] + 0.5)] - 0.71
        if here < 2.0:
            here = clearance_at(clearance, first, u, v)
            if here < FREE_CELLS:
                return False
        travelled += max(0.9 * here, 1.0)
    return True


@njit(cache=True, error_model="numpy")
def _sees_source(
    free: NDArray[np.float32], columns: int, stamps: Integers, expanded: int, column: int, row: int, du: float, dv: float
) -> bool:
    """Whether a vertex sees its source, ``du, dv`` away: :func:`line_of_sight`, shortened by what is known.

    The line is walked from the vertex, from one lattice line to another across its longer side. Where the vertices on both
    sides of it have been expanded with the same source, they see that source, and so does what lies between: an
    obstacle grown by at least a cell cannot fit between them.
    """
    if abs(du) >= abs(dv):
        length, place, drift, across = abs(du), float(row), dv, columns
        line, along = column, (1 if du > 0.0 else -1)
    else:
        length, place, drift, across = abs(dv), float(column), du, 1
        line, along = row * columns, (columns if dv > 0.0 else -columns)
    if length <= 1.0:
        return True
    drift /= length
    step, gone = 1, 1
    while gone < length:
        line += step * along
        place += step * drift
        low = int(place)
        part = place - low
        near = np.uint64(line + low * across)
        far = np.uint64(line + (low + (part > 0.0)) * across)
        if stamps[near] == expanded and stamps[far] == expanded:
            return True
        here = (1.0 - part) * free[near] + part * free[far]
        if here < FREE_CELLS:
            return False
        # Of a slanted line, a step along its longer side is up to 1.41 cells: 0.9 / 1.41 of the clearance.
        step = max(1, int(0.63 * here))
        gone += step
    return True


@njit(cache=True)
def shut(stamps: Integers, columns: int, first: Cells, window: NDArray[np.int64], stamp: int) -> None:
    """Mark the vertices on the border of the window, so that a search never leaves it."""
    west, south, east, north = window[0] - first[0], window[1] - first[1], window[2] - first[0], window[3] - first[1]
    for row in range(south, north + 1):
        stamps[row * columns + west] = stamp
        stamps[row * columns + east] = stamp
    for column in range(west, east + 1):
        stamps[south * columns + column] = stamp
        stamps[north * columns + column] = stamp


@njit(cache=True, error_model="numpy")
def _best_expanded(
    stamps: Integers, base: int, sources: Array, columns: int, cell: Cells, u0: float, v0: float, u: float, v: float, way: Cells
) -> tuple[int, float]:
    """Which of the expanded vertices around a node at (u, v) gives the shortest way there, and the g of that vertex."""
    best, best_g, shortest = -1, np.inf, np.inf
    for k in range(way[0], way[1]):
        stamp = stamps[(cell[1] + STEPS_V[k]) * columns + cell[0] + STEPS_U[k]]
        if base < stamp < BLOCKED and stamp & 1 == 1:
            s = (stamp - base) >> 1
            other_u, other_v = u0 + STEPS_U[k], v0 + STEPS_V[k]
            g = sources[s, 2] + np.sqrt((other_u - sources[s, 0]) ** 2 + (other_v - sources[s, 1]) ** 2)
            whole = g + np.sqrt((other_u - u) ** 2 + (other_v - v) ** 2)
            if whole < shortest:
                best, best_g, shortest = k, g, whole
    return best, best_g


@njit(cache=True, error_model="numpy")
def expand(
    clearance: NDArray[np.float32],
    free: NDArray[np.float32],
    first: Cells,
    ends: Array,
    base: int,
    stamps: Integers,
    source_of: Integers,
    sources: Array,
    heads: Integers,
    entries: Integers,
    progress: NDArray[np.int64],
) -> bool:
    """Expand vertices in the order of f until the goal is reached or none is left; False if it must be given more room first.

    See :func:`walklab.planning.lazy_theta_star.search`. Arrays come as arguments and are never replaced in here: numba counts
    references to what it creates with atomic operations, which took two fifths of the time.
    """
    columns = clearance.shape[1]
    goal, start = clearance.size, clearance.size + 1
    goal_u, goal_v = ends[1, 0], ends[1, 1]
    goal_column, goal_row = int(np.floor(goal_u)) - first[0], int(np.floor(goal_v)) - first[1]
    direct = np.sqrt((ends[0, 0] - goal_u) ** 2 + (ends[0, 1] - goal_v) ** 2)
    around = STEPS_V * columns + STEPS_U
    found = np.empty(9, dtype=np.int32)
    current, last, known, unused, spare = progress[0], progress[1], progress[2], progress[3], progress[4]
    while current <= last:
        entry = heads[current & (RING - 1)]
        if entry < 0:
            current += 1
            continue
        if spare < found.size or known == sources.shape[0]:
            progress[0], progress[1], progress[2], progress[3], progress[4] = current, last, known, unused, spare
            return False
        node = entries[entry, 0]
        heads[current & (RING - 1)], entries[entry, 1] = entries[entry, 1], unused
        unused, spare = entry, spare + 1
        stamp = stamps[node]
        if stamp & 1 == 1:
            continue  # an entry from before the vertex was found again with a smaller f
        s = (stamp - base) >> 1
        source_u, source_v, source_g = sources[s, 0], sources[s, 1], sources[s, 2]
        if node < goal:
            row = node // columns
            column = node - row * columns
            anchor, low, high = node, 0, 8
            u, v = float(column + first[0]), float(row + first[1])
            du, dv = source_u - u, source_v - v
            step_u, step_v = (1 if du > 0.0 else -1), (columns if dv > 0.0 else -columns)
            beside = node + (step_u if abs(du) >= abs(dv) else step_v)
            # The first step of _sees_source, here for speed.
            sighted = stamps[beside] == stamp + 1 and stamps[node + step_u + step_v] == stamp + 1
            if not sighted:
                sighted = _sees_source(free, columns, stamps, stamp + 1, column, row, du, dv)
        else:
            u, v = ends[start - node, 0], ends[start - node, 1]
            column, row = int(np.floor(u)) - first[0], int(np.floor(v)) - first[1]
            anchor, low, high = row * columns + column, 8, 12
            sighted = node == start or line_of_sight(clearance, first, source_u, source_v, u, v)
        u0, v0 = float(column + first[0]), float(row + first[1])
        if not sighted:
            k, g = _best_expanded(stamps, base, sources, columns, (column, row), u0, v0, u, v, (low, high))
            parent = anchor + around[k]
            s = source_of[parent]
            if s >= known or sources[s, 3] != parent:
                s, known = known, known + 1
                source_of[parent] = s
                sources[s, 0], sources[s, 1], sources[s, 2], sources[s, 3] = u0 + STEPS_U[k], v0 + STEPS_V[k], g, parent
            source_u, source_v, source_g = sources[s, 0], sources[s, 1], sources[s, 2]
            stamp = base + 2 * s
        stamps[node] = stamp + 1
        if node == goal:
            break
        count = 0
        for k in range(low, high):
            # Unsigned, numba need not ask whether an index counts from the end: a tenth of the time.
            other_stamp = stamps[np.uint64(anchor + around[np.uint64(k)])]
            if other_stamp < base or (other_stamp & 1 == 0 and other_stamp != stamp):
                found[count] = k
                count += 1
        if 0 <= column - goal_column <= 1 and 0 <= row - goal_row <= 1:
            found[count] = -1
            count += 1
        for j in range(count):
            k = found[j]
            other, other_u, other_v = goal, goal_u, goal_v
            if k >= 0:
                other, other_u, other_v = anchor + around[k], u0 + STEPS_U[k], v0 + STEPS_V[k]
            g = source_g + np.sqrt((source_u - other_u) ** 2 + (source_v - other_v) ** 2)
            other_stamp = stamps[other]
            if other_stamp >= base:
                r = (other_stamp - base) >> 1
                if g >= sources[r, 2] + np.sqrt((sources[r, 0] - other_u) ** 2 + (sources[r, 1] - other_v) ** 2):
                    continue
            stamps[other] = stamp
            f = g + np.sqrt((other_u - goal_u) ** 2 + (other_v - goal_v) ** 2)
            bucket = max(int((f - direct) * BUCKETS_PER_CELL), current)
            last = max(last, bucket)
            entry = unused
            unused, spare = entries[entry, 1], spare - 1
            entries[entry, 0], entries[entry, 1] = other, heads[bucket & (RING - 1)]
            heads[bucket & (RING - 1)] = entry
    progress[0], progress[1], progress[2], progress[3], progress[4] = current, last, known, unused, spare
    return True


@njit(cache=True)
def _pull(grid: Any, points: Array, k: int, way: int) -> float:
    """Move one point as far as its neighbours keep seeing it; the distance moved.

    ``way`` 0 is towards the line between its neighbours, -1 and 1 towards the neighbour before and after.
    """
    x, y = points[k, 0], points[k, 1]
    if way == 0:
        before_x, before_y = points[k - 1, 0], points[k - 1, 1]
        chord_x, chord_y = points[k + 1, 0] - before_x, points[k + 1, 1] - before_y
        along = (x - before_x) * chord_x + (y - before_y) * chord_y
        share = min(max(along / max(chord_x * chord_x + chord_y * chord_y, 1e-12), 0.0), 1.0)
        pull_x, pull_y = before_x + share * chord_x - x, before_y + share * chord_y - y
    else:
        pull_x, pull_y = 0.5 * (points[k + way, 0] - x), 0.5 * (points[k + way, 1] - y)
    for _ in range(8):
        there_x, there_y = x + pull_x, y + pull_y
        if line_of_sight(grid[0], grid[1], points[k - 1, 0], points[k - 1, 1], there_x, there_y) and line_of_sight(
            grid[0], grid[1], there_x, there_y, points[k + 1, 0], points[k + 1, 1]
        ):
            points[k, 0], points[k, 1] = there_x, there_y
            return np.sqrt(pull_x * pull_x + pull_y * pull_y)
        pull_x, pull_y = 0.5 * pull_x, 0.5 * pull_y
    return 0.0


@njit(cache=True)
def _rounded(points: Array) -> Array:
    """A point more on each leg of every bend of more than ``BEND_RAD``, not far from the bend."""
    rounded = np.empty((3 * points.shape[0], 2))
    rounded[0, 0], rounded[0, 1], count = points[0, 0], points[0, 1], 1
    for k in range(1, points.shape[0] - 1):
        x, y = points[k, 0], points[k, 1]
        before_x, before_y = points[k - 1, 0] - x, points[k - 1, 1] - y
        after_x, after_y = points[k + 1, 0] - x, points[k + 1, 1] - y
        turn = np.pi - abs(np.arctan2(before_x * after_y - before_y * after_x, before_x * after_x + before_y * after_y))
        for leg_x, leg_y in ((before_x, before_y), (0.0, 0.0), (after_x, after_y)):
            length = np.sqrt(leg_x * leg_x + leg_y * leg_y)
            if length == 0.0:
                rounded[count, 0], rounded[count, 1], count = x, y, count + 1
            elif turn > BEND_RAD:
                share = min(BEND_CELLS / length, 1.0 / 3.0)
                rounded[count, 0], rounded[count, 1], count = x + share * leg_x, y + share * leg_y, count + 1
    rounded[count, 0], rounded[count, 1] = points[-1, 0], points[-1, 1]
    return rounded[: count + 1]


@njit(cache=True)
def tighten(clearance: NDArray[np.float32], first: Cells, path: Array) -> Array:
    """Pull a path taut around the corners it bends at, (n, 2) array to (m, 2) array, lattice coordinates.

    Sharp bends get a point more on each leg; then each inner point in turn moves towards the line between its neighbours and
    towards each of them, as far (by halves) as both keep seeing it. This is repeated until the path follows round
    corners in small turns. A path never gets longer, and its ends stay.
    """
    grid = (clearance, first)
    points = path
    for _ in range(BEND_ROUNDS):
        points = _rounded(points)
        for _ in range(TIGHTENING_SWEEPS):
            moved = 0.0
            for k in range(1, points.shape[0] - 1):
                for way in (0, -1, 1):
                    moved = max(moved, _pull(grid, points, k, way))
            if moved < 1e-2:
                break
        points = _without_needless(grid, points)
    return points


@njit(cache=True)
def _without_needless(grid: Any, points: Array) -> Array:
    """Drop inner points within a thousandth of a cell of the line between their neighbours, if that line is clear."""
    keep = np.ones(points.shape[0], dtype=np.bool_)
    before = 0
    for k in range(1, points.shape[0] - 1):
        x, y, next_x, next_y = points[before, 0], points[before, 1], points[k + 1, 0], points[k + 1, 1]
        chord_x, chord_y = next_x - x, next_y - y
        across = abs(chord_x * (points[k, 1] - y) - chord_y * (points[k, 0] - x))
        straight = across <= 1e-3 * np.sqrt(chord_x * chord_x + chord_y * chord_y)
        if straight and line_of_sight(grid[0], grid[1], x, y, next_x, next_y):
            keep[k] = False
        else:
            before = k
    return points[keep]
