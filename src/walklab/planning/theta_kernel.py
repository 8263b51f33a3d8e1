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

# A clearance of minus a micrometre (at 1 cm cells) is rounding, not an overlap.
FREE_CELLS = -1e-4

# What Lazy Theta* notes at a vertex; one record keeps what belongs together within one cache line.
NODE = np.dtype(
    [("g", "f8"), ("parent", "i4"), ("bucket", "i4"), ("epoch", "i4"), ("closed", "i4"), ("margin", "f4")], align=True
)

# The open list: a ring of buckets of equal f. Buckets this narrow keep the excess of the path
# below what the grid itself causes; whole cells do not.
BUCKETS_PER_CELL = 32
RING = 4096

BEND_CELLS = 10.0  # how far from a bend the two points are set that round it
TIGHTENING_SWEEPS = 12


@njit(cache=True)
def clearance_at(clearance: NDArray[np.float32], first: tuple[int, int], u: float, v: float) -> float:
    """Clearance (cells) at lattice coordinates ``u = x / cell``, ``v = y / cell``, bilinear between vertices."""
    rows, columns = clearance.shape
    column = min(max(int(np.floor(u)), first[0]), first[0] + columns - 2)
    row = min(max(int(np.floor(v)), first[1]), first[1] + rows - 2)
    right, up = u - column, v - row
    i, j = row - first[1], column - first[0]
    below = (1.0 - right) * clearance[i, j] + right * clearance[i, j + 1]
    above = (1.0 - right) * clearance[i + 1, j] + right * clearance[i + 1, j + 1]
    return (1.0 - up) * below + up * above


@njit(cache=True)
def sight_margin(clearance: NDArray[np.float32], first: tuple[int, int], u0: float, v0: float, u1: float, v1: float) -> float:
    """How far the line from one point to another (lattice coordinates) may be turned about its start and still be clear.

    The line is walked from disc to disc of free space, in steps of 0.9 of the clearance but at least one cell.
    A step of one cell can cut at most ``cell^2 / (8 r)`` off the round corner of an obstacle grown by r:
    0.05 mm at 1 cm cells and r = 0.25 m. A disc of radius c around the point at t covers all lines
    turned by up to ``0.43 c / t_next`` until the next disc, since ``0.9^2 + 0.43^2 < 1``. Far from obstacles the
    clearance of the nearest vertex less its largest distance, 0.71 cells, is close enough. Between neighbouring vertices only
    the ends are checked.

    Returns
    -------
    float, radians (a lower bound); -1 if the line is blocked
    """
    if clearance_at(clearance, first, u0, v0) < FREE_CELLS or clearance_at(clearance, first, u1, v1) < FREE_CELLS:
        return -1.0
    du, dv = u1 - u0, v1 - v0
    distance = np.sqrt(du * du + dv * dv)
    if distance <= 1.5:
        return 0.0
    du, dv = du / distance, dv / distance
    travelled, margin = 0.0, np.inf
    while travelled < distance:
        u, v = u0 + travelled * du, v0 + travelled * dv
        here = clearance[int(v - first[1] + 0.5), int(u - first[0] + 0.5)] - 0.71
        if here < 2.0:
            here = clearance_at(clearance, first, u, v)
            if here < FREE_CELLS:
                return -1.0
        if here > 1.2:
            following = travelled + 0.9 * here
            margin = min(margin, 0.43 * here / following)
        else:
            following = travelled + 1.0
            if travelled > 0.0:
                margin = min(margin, max(here, 0.0) / travelled)
        travelled = following
    return margin


@njit(cache=True)
def _position(node: int, rows: int, columns: int, first: tuple[int, int], ends: Array) -> tuple[float, float]:
    """Lattice coordinates of a vertex; the last two nodes are the start and the goal."""
    if node < rows * columns:
        return float(node % columns + first[0]), float(node // columns + first[1])
    if node == rows * columns:
        return ends[0, 0], ends[0, 1]
    return ends[1, 0], ends[1, 1]


@njit(cache=True)
def _grown(entries: NDArray[np.int32]) -> NDArray[np.int32]:
    """The list of entries with twice the room; unused entries are chained behind each other."""
    size = entries.shape[0]
    larger = np.empty((2 * size, 2), dtype=np.int32)
    larger[:size] = entries
    larger[size:, 1] = np.arange(size + 1, 2 * size + 1)
    larger[-1, 1] = -1
    return larger


@njit(cache=True)
def _corners(u: float, v: float, node: int, total: int) -> tuple[int, int, int, int]:
    """First and last column and row of the vertices next to a node: eight around a vertex, four around an end."""
    i, j = int(np.floor(u)), int(np.floor(v))
    return (i - 1, j - 1, i + 1, j + 1) if node < total else (i, j, i + 1, j + 1)


@njit(cache=True)
def _near(ends: Array, end: int, u: float, v: float) -> bool:
    """Whether a vertex is a corner of the cell that the start (0) or the goal (1) lies in."""
    return u - 1.0 < ends[end, 0] < u + 1.0 and v - 1.0 < ends[end, 1] < v + 1.0


@njit(cache=True)
def _neighbours(
    node: int, u: float, v: float, grid: Any, window: NDArray[np.int64], ends: Array, found: NDArray[np.int64], places: Array
) -> int:
    """Fill ``found`` with the nodes next to a node, ``places`` with their coordinates, and return their number."""
    rows, columns, first = grid
    total, count = rows * columns, 0
    west, south, east, north = _corners(u, v, node, total)
    for j in range(max(south, window[1]), min(north, window[3]) + 1):
        for i in range(max(west, window[0]), min(east, window[2]) + 1):
            found[count] = (j - first[1]) * columns + i - first[0]
            places[count, 0], places[count, 1] = i, j
            count += found[count] != node
    if node < total:
        for end in range(2):
            if _near(ends, end, u, v):
                found[count] = total + end
                places[count] = ends[end]
                count += 1
    return count


@njit(cache=True)
def _set_vertex(nodes: Any, node: int, u: float, v: float, epoch: int, found: NDArray[np.int64], places: Array) -> None:
    """Take the best expanded neighbour as parent, after the line of sight to the old one has proved blocked."""
    nodes[node].g = np.inf
    for k in range(found.size):
        other = found[k]
        if nodes[other].epoch == epoch and nodes[other].closed == 1:
            g = nodes[other].g + np.sqrt((places[k, 0] - u) ** 2 + (places[k, 1] - v) ** 2)
            if g < nodes[node].g:
                nodes[node].g = g
                nodes[node].parent = other


@njit(cache=True)
def search(
    clearance: NDArray[np.float32], first: tuple[int, int], window: NDArray[np.int64], nodes: Any, epoch: int, ends: Array
) -> Array:
    """The path between two points in lattice coordinates.

    Parameters
    ----------
    clearance, first : see :class:`walklab.planning.grid.OccupancyGrid`
    window : first column, first row, last column, last row of the vertices that may be used
    nodes : (vertices + 2,) records of type ``NODE``; only those with this ``epoch`` count
    ends : (2, 2) array, start and goal

    Returns
    -------
    (n, 2) array from start to goal; (0, 2) if there is no path

    Notes
    -----
    Each bucket of the open list is a chain of entries (node, next entry); an entry is out of date,
    and dropped when met, if its node has moved to another bucket or has been expanded. A node whose f
    is beyond the ring of buckets waits in the last one and is put back when its turn comes.
    """
    rows, columns = clearance.shape
    grid = (rows, columns, first)
    total = rows * columns
    start, goal = total, total + 1
    goal_u, goal_v = ends[1, 0], ends[1, 1]
    direct = np.hypot(ends[0, 0] - goal_u, ends[0, 1] - goal_v)
    heads = np.full(RING, -1, dtype=np.int32)
    entries = _grown(np.zeros((1024, 2), dtype=np.int32))
    found, places = np.empty(10, dtype=np.int64), np.empty((10, 2))
    free = clearance.ravel()
    entries[0, 0], entries[0, 1], heads[0], unused = start, -1, 0, 1024
    nodes[start].g, nodes[start].parent, nodes[start].epoch, nodes[start].closed = 0.0, start, epoch, 0
    nodes[start].bucket, nodes[start].margin = 0, 0.0
    waiting, current = 1, 0
    while waiting > 0:
        entry = heads[current % RING]
        if entry < 0:
            current += 1
            continue
        node = entries[entry, 0]
        heads[current % RING] = entries[entry, 1]
        if nodes[node].closed == 1 or nodes[node].bucket != current:
            entries[entry, 1], unused, waiting = unused, entry, waiting - 1
            continue
        u, v = _position(node, rows, columns, first, ends)
        bucket = int((nodes[node].g + np.sqrt((u - goal_u) ** 2 + (v - goal_v) ** 2) - direct) * BUCKETS_PER_CELL)
        if bucket > current:
            nodes[node].bucket = min(bucket, current + RING - 1)
            entries[entry, 1] = heads[nodes[node].bucket % RING]
            heads[nodes[node].bucket % RING] = entry
            continue
        entries[entry, 1], unused, waiting = unused, entry, waiting - 1
        count = _neighbours(node, u, v, grid, window, ends, found, places)
        parent = nodes[node].parent
        parent_u, parent_v = _position(parent, rows, columns, first, ends)
        if nodes[node].margin <= 0.0 or node >= total or free[node] < 3.0:
            nodes[node].margin = sight_margin(clearance, first, parent_u, parent_v, u, v)
        if nodes[node].margin < 0.0:
            _set_vertex(nodes, node, u, v, epoch, found[:count], places)
            if nodes[node].g == np.inf:
                nodes[node].epoch = 0
                continue
            parent = nodes[node].parent
            parent_u, parent_v = _position(parent, rows, columns, first, ends)
        nodes[node].closed = 1
        if node == goal:
            return _backtrack(nodes, rows, columns, first, ends)
        parent_g = nodes[parent].g
        for k in range(count):
            other = found[k]
            if nodes[other].epoch == epoch:
                if nodes[other].closed == 1 or nodes[other].parent == parent:
                    continue
                known_g = nodes[other].g
            elif other < total and free[other] < FREE_CELLS:
                continue
            else:
                known_g = np.inf
            other_u, other_v = places[k, 0], places[k, 1]
            distance = np.sqrt((parent_u - other_u) ** 2 + (parent_v - other_v) ** 2)
            g = parent_g + distance
            if g >= known_g:
                continue
            # Seen from the parent, neighbouring vertices are less than 1.5 / (distance - 1.5) apart.
            nodes[other].margin = nodes[node].margin - 1.5 / max(distance - 1.5, 0.1)
            bucket = int((g + np.sqrt((other_u - goal_u) ** 2 + (other_v - goal_v) ** 2) - direct) * BUCKETS_PER_CELL)
            bucket = min(max(bucket, current), current + RING - 1)
            known = nodes[other].epoch == epoch and nodes[other].bucket == bucket
            nodes[other].g, nodes[other].parent, nodes[other].epoch, nodes[other].closed = g, parent, epoch, 0
            if known:
                continue
            nodes[other].bucket = bucket
            if unused < 0:
                unused = entries.shape[0]
                entries = _grown(entries)
            entry = unused
            unused, waiting = entries[entry, 1], waiting + 1
            entries[entry, 0], entries[entry, 1] = other, heads[bucket % RING]
            heads[bucket % RING] = entry
    return np.empty((0, 2))


@njit(cache=True)
def _backtrack(nodes: Any, rows: int, columns: int, first: tuple[int, int], ends: Array) -> Array:
    node, count = rows * columns + 1, 2
    while nodes[node].parent != rows * columns:
        node = nodes[node].parent
        count += 1
    path = np.empty((count, 2))
    node = rows * columns + 1
    for k in range(count - 1, -1, -1):
        path[k, 0], path[k, 1] = _position(node, rows, columns, first, ends)
        node = nodes[node].parent
    return path


@njit(cache=True)
def _clear(grid: Any, p: Array, q: Array) -> bool:
    return sight_margin(grid[0], grid[1], p[0], p[1], q[0], q[1]) >= 0.0


@njit(cache=True)
def _pull(grid: Any, points: Array, k: int, way: int) -> float:
    """Move one point as far as its neighbours keep seeing it; the distance moved.

    ``way`` 0 is towards the line between its neighbours, -1 and 1 towards the neighbour before and after.
    """
    if way == 0:
        chord = points[k + 1] - points[k - 1]
        along = np.sum((points[k] - points[k - 1]) * chord) / max(np.sum(chord * chord), 1e-12)
        pull = points[k - 1] + min(max(along, 0.0), 1.0) * chord - points[k]
    else:
        pull = 0.5 * (points[k + way] - points[k])
    for _ in range(8):
        there = points[k] + pull
        if _clear(grid, points[k - 1], there) and _clear(grid, there, points[k + 1]):
            points[k] = there
            return np.sqrt(np.sum(pull * pull))
        pull = 0.5 * pull
    return 0.0


@njit(cache=True)
def tighten(clearance: NDArray[np.float32], first: tuple[int, int], path: Array) -> Array:
    """Pull a path taut around the corners it bends at, (n, 2) array to (m, 2) array, lattice coordinates.

    Each bend gets a point more on each side with a long leg; then each inner point in turn moves towards the line between
    its neighbours and towards each of them, as far (by halves) as both keep seeing it. A path never gets longer, and its
    ends stay.
    """
    grid = (clearance, first)
    points = np.empty((3 * path.shape[0] - 4, 2))
    points[0], count = path[0], 1
    for k in range(1, path.shape[0] - 1):
        for side in (-1, 0, 1):
            leg = path[k + side] - path[k]
            distance = np.sqrt(leg[0] ** 2 + leg[1] ** 2)
            if side == 0 or distance > 3.0 * BEND_CELLS:
                points[count] = path[k] + BEND_CELLS / max(distance, BEND_CELLS) * leg
                count += 1
    points[count] = path[-1]
    points = points[: count + 1]
    for _ in range(TIGHTENING_SWEEPS):
        moved = 0.0
        for k in range(1, points.shape[0] - 1):
            for way in (0, -1, 1):
                moved = max(moved, _pull(grid, points, k, way))
        if moved < 1e-2:
            break
    return _without_needless(grid, points)


@njit(cache=True)
def _without_needless(grid: Any, points: Array) -> Array:
    """Drop inner points within a thousandth of a cell of the line between their neighbours, if that line is clear."""
    keep = np.ones(points.shape[0], dtype=np.bool_)
    before = 0
    for k in range(1, points.shape[0] - 1):
        chord = points[k + 1] - points[before]
        offset = points[k] - points[before]
        across = abs(chord[0] * offset[1] - chord[1] * offset[0])
        if across <= 1e-3 * np.sqrt(np.sum(chord * chord)) and _clear(grid, points[before], points[k + 1]):
            keep[k] = False
        else:
            before = k
    return points[keep]
