"""Lazy Theta* (Nash, Koenig, Tovey 2010): any-angle shortest paths on a grid.

A vertex first inherits the parent of the vertex that found it, as if it could see that
parent; the line of sight is checked only when the vertex is expanded (``SetVertex``), and if it is
blocked the best expanded neighbour becomes the parent. The compiled search is in ``theta_kernel``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.curves import length
from walklab.geometry.scene import Point
from walklab.planning.grid import Notes, OccupancyGrid, free_point, search_window
from walklab.planning.theta_kernel import RING, Cells, expand, shut, tighten

Array = NDArray[np.float64]

# ASSUME: a start or end that overlaps a grown obstacle by up to 0.10 m is accepted, because people stand closer to racks than
# a disc of the body radius allows and captured positions scatter; the path then leads to it from the nearest free vertex.
SNAP_M = 0.10

ROOM = 1 << 14  # entries of the open list to begin with


def lazy_theta_star(grid: OccupancyGrid, start_m: Point, goal_m: Point, snap_m: float = SNAP_M) -> Array:
    """A short collision-free path for the body that the grid was built for.

    Parameters
    ----------
    grid : must cover both points
    start_m, goal_m : the ends of the path, kept exactly, metres
    snap_m : overlap with an obstacle up to which an end is tolerated

    Returns
    -------
    (n, 2) array, metres; exactly the two ends where they see each other

    Raises
    ------
    InputError
        If an end overlaps an obstacle by more than ``snap_m``, or there is no way between them.

    Notes
    -----
    Nash, Koenig, Tovey 2010, algorithm 2, with an open list of narrow buckets. Its path bends at few vertices, which around
    round corners is about 0.1 % longer than the shortest way, so that it now and then takes the wrong side of an obstacle (0.6 %
    longer in one of 300 random rooms). Therefore both ends are searched from; each path is pulled taut, the shorter one is kept.
    Over 300 random rooms (``make test-all``; in 297 something is in the way) it is then 0.002 % longer than the shortest way
    on average, and more than 0.02 % in two: 0.04 % in a gap hardly wider than the body, 0.03 % where two ways differ by no more.
    """
    begin = free_point(grid, start_m, "start", snap_m)
    end = free_point(grid, goal_m, "end", snap_m)
    if grid.line_of_sight(begin, end):
        path = np.array([begin, end], dtype=float)
    else:
        there = _taut_path(grid, begin, end)
        if not len(there):
            raise InputError(
                f"scene {grid.scene.name}: no way from ({start_m[0]:.3f}, {start_m[1]:.3f}) to ({goal_m[0]:.3f}, {goal_m[1]:.3f})"
                f" for a body radius of {grid.radius_m} m; move an obstacle or an end"
            )
        back = _taut_path(grid, end, begin)[::-1]
        path = back if 0.0 < length(back) < length(there) else there
        path[0], path[-1] = begin, end
    return _without_repeats(np.vstack([start_m, path, goal_m]))


def _taut_path(grid: OccupancyGrid, begin: Point, end: Point) -> Array:
    """The path that a search from one free point to another finds, pulled taut; metres, (0, 2) if there is none."""
    window = np.array(search_window(grid.scene, grid.radius_m, grid.cell_m, [begin, end]), dtype=np.int64)
    ends = np.array([begin, end], dtype=float) / grid.cell_m
    path = search(grid.clearance_cells, grid.first, window, grid.notes, ends)
    return tighten(grid.clearance_cells, grid.first, path) * grid.cell_m if len(path) else path


def _without_repeats(path: Array) -> Array:
    """Drop points that repeat the one before; both ends stay."""
    keep = np.concatenate([[True], np.any(np.diff(path, axis=0) != 0.0, axis=1)])
    kept = path[keep]
    return kept if len(kept) > 1 else path[[0, -1]]


def search(
    clearance: NDArray[np.float32], first: Cells, window: NDArray[np.int64], notes: Notes, ends: Array, room: int = ROOM
) -> Array:
    """The path between two points in lattice coordinates that do not see each other.

    Parameters
    ----------
    clearance, first : see :class:`walklab.planning.grid.OccupancyGrid`
    window : first column, first row, last column, last row; the vertices on its border are not used
    notes : of this grid
    ends : (2, 2) array, start and goal
    room : entries of the open list to begin with

    Returns
    -------
    (n, 2) array from start to goal; (0, 2) if there is no path

    Notes
    -----
    A *source* is a vertex that others have as parent: u, v, g and its node. Source 0 stands for what lies outside the window,
    source 1 for the start. The g of a vertex is that of its source and the distance to it, so it is not stored.
    Each bucket of the open list is a chain of entries (node, next entry), the latest first; unused entries form another.
    """
    base = notes.begin()
    goal, start = clearance.size, clearance.size + 1
    sources = np.zeros((1024, 4))
    sources[0] = 0.0, 0.0, np.inf, -1.0
    sources[1] = ends[0, 0], ends[0, 1], 0.0, start
    heads = np.full(RING, -1, dtype=np.int32)
    entries = np.column_stack([np.zeros(room), np.arange(1, room + 1)]).astype(np.int32)
    entries[0], heads[0] = (start, -1), 0
    notes.stamps[start] = base + 2
    shut(notes.stamps, clearance.shape[1], first, window, base + 1)
    progress = np.array([0, 0, 2, 1, room - 1])  # bucket, last bucket, sources, first unused entry, unused entries
    arrays = (clearance, clearance.ravel(), first, ends, base, notes.stamps, notes.source_of)
    while not expand(*arrays, sources, heads, entries, progress):
        sources = np.concatenate([sources, np.empty_like(sources)])
        size = len(entries)
        entries = np.concatenate([entries, np.column_stack([np.zeros(size), np.arange(size + 1, 2 * size + 1)]).astype(np.int32)])
        entries[-1, 1] = progress[3]
        progress[3:] = size, progress[4] + size
    notes.base = base + 2 * int(progress[2])
    if notes.stamps[goal] < base:
        return np.empty((0, 2))
    path, node = [ends[1]], goal
    while node != start:
        source = sources[(notes.stamps[node] - base) >> 1]
        path.append(source[:2])
        node = int(source[3])
    return np.array(path[::-1])
