"""Lazy Theta* (Nash, Koenig, Tovey 2010): any-angle shortest paths on a grid.

A vertex first inherits the parent of the vertex that found it, as if it could see that
parent; the line of sight is checked only when the vertex is expanded (``SetVertex``), and if it is
blocked the best expanded neighbour becomes the parent. The compiled search is in ``theta_kernel``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.scene import Point
from walklab.planning.grid import OccupancyGrid, free_point, search_window
from walklab.planning.theta_kernel import search, tighten

Array = NDArray[np.float64]

# ASSUME: a start or end that overlaps a grown obstacle by up to 0.10 m is accepted, because people stand closer to racks than
# a disc of the body radius allows and captured positions scatter; the path then leads to it from the nearest free vertex.
SNAP_M = 0.10


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
    round corners is about 0.1 % longer than the shortest way; pulling it taut afterwards leaves about 0.03 %.
    """
    begin = free_point(grid, start_m, "start", snap_m)
    end = free_point(grid, goal_m, "end", snap_m)
    if grid.line_of_sight(begin, end):
        path = np.array([begin, end], dtype=float)
    else:
        window = np.array(search_window(grid.scene, grid.radius_m, grid.cell_m, [begin, end]), dtype=np.int64)
        ends = np.array([begin, end], dtype=float) / grid.cell_m
        path = search(grid.clearance_cells, grid.first, window, grid.nodes, grid.next_epoch(), ends)
        if not len(path):
            raise InputError(
                f"scene {grid.scene.name}: no way from ({start_m[0]:.3f}, {start_m[1]:.3f}) to ({goal_m[0]:.3f}, {goal_m[1]:.3f})"
                f" for a body radius of {grid.radius_m} m; move an obstacle or an end"
            )
        path = tighten(grid.clearance_cells, grid.first, path) * grid.cell_m
        path[0], path[-1] = begin, end
    return _without_repeats(np.vstack([start_m, path, goal_m]))


def _without_repeats(path: Array) -> Array:
    """Drop points that repeat the one before; both ends stay."""
    keep = np.concatenate([[True], np.any(np.diff(path, axis=0) != 0.0, axis=1)])
    kept = path[keep]
    return kept if len(kept) > 1 else path[[0, -1]]
