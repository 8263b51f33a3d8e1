"""Row ``lazy_theta_star`` of the benchmarks: the reference query beside python_motion_planning, on the same grid.

python_motion_planning is under the GPL: it is no dependency, and nothing of it is copied. It lives in an environment of its own,
``.venv/peers``, and is measured only here.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from case import Case, Work
from shapely import box

from walklab.geometry.scene import Scene
from walklab.planning.grid import OccupancyGrid, build_grid, search_window
from walklab.planning.lazy_theta_star import lazy_theta_star

HALL = Scene("hall", {"left": box(3, 1, 4, 8), "right": box(6, -1, 7, 6.2)})
START, GOAL = (0.5, 4.0), (9.5, 4.0)
RADIUS_M = 0.25
PEERS = Path(__file__).resolve().parents[1] / ".venv/peers"

Query = Callable[[], Any]


def peer_query(grid: OccupancyGrid) -> Query:
    """The same query for python_motion_planning; it gets the occupancy of exactly the vertices that ours may use."""
    # At the end of the path: whatever the project has itself is not replaced.
    sys.path.extend(map(str, sorted(PEERS.glob("lib/python*/site-packages"))))
    from python_motion_planning.common import TYPES, Grid
    from python_motion_planning.path_planner import LazyThetaStar

    window = search_window(grid.scene, grid.radius_m, grid.cell_m, [START, GOAL])
    low, high = np.subtract(window[:2], grid.first), np.subtract(window[2:], grid.first) + 1
    blocked = grid.blocked[low[1] : high[1], low[0] : high[0]].T

    def planner(occupied: np.ndarray, start: tuple[int, ...], goal: tuple[int, ...]) -> Any:
        room = Grid(bounds=[[0, occupied.shape[0]], [0, occupied.shape[1]]])
        room.type_map[occupied] = TYPES.OBSTACLE
        return LazyThetaStar(map_=room, start=start, goal=goal)

    # Its grid is compiled on first use as well; that must not count.
    planner(np.arange(400).reshape(20, 20) == 210, (2, 10), (18, 10)).plan()
    start, goal = (tuple(round(x / grid.cell_m) - int(w) for x, w in zip(p, window, strict=False)) for p in (START, GOAL))
    ready = planner(blocked, start, goal)
    return lambda: ready.plan()[1]["length"] * grid.cell_m


def reference_query() -> Work:
    """One query, the grid prepared before."""
    grid = build_grid(HALL, RADIUS_M, [START, GOAL])
    theirs = peer_query(grid)

    def baseline_s() -> float:
        # It takes so long that one round is enough.
        start = time.process_time()
        theirs()
        return time.process_time() - start

    name = "python_motion_planning LazyThetaStar"
    return Work(lambda: lazy_theta_star(grid, START, GOAL), 1, "s per query", baseline_s, name, rounds=30)


CASES = [Case("lazy_theta_star", reference_query)]
