"""Row ``lazy_theta_star`` of the benchmarks: the reference query beside python_motion_planning, on the same grid.

python_motion_planning is under the GPL: it is no dependency, and nothing of it is copied. Install it apart from the project,
``python -m venv /tmp/pmp && /tmp/pmp/bin/pip install python_motion_planning``, and name its packages in
``WALKLAB_BENCH_PACKAGES`` (default ``/tmp/pmp/lib/python*/site-packages``); without it the row is skipped.
"""

from __future__ import annotations

import glob
import os
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from shapely import box

from walklab.geometry.scene import Scene
from walklab.planning.grid import OccupancyGrid, build_grid, search_window
from walklab.planning.lazy_theta_star import lazy_theta_star

HALL = Scene("hall", {"left": box(3, 1, 4, 8), "right": box(6, -1, 7, 6.2)})
START, GOAL = (0.5, 4.0), (9.5, 4.0)
RADIUS_M = 0.25
PACKAGES = os.environ.get("WALKLAB_BENCH_PACKAGES", "/tmp/pmp/lib/python*/site-packages")

Query = Callable[[], Any]


def peer_query(grid: OccupancyGrid) -> Query | None:
    """The same query for python_motion_planning, or None (and the reason printed) where it is absent.

    It gets the occupancy of exactly the vertices that ours may use.
    """
    # At the end of the path: whatever the project has itself is not replaced.
    sys.path.extend(sorted(glob.glob(PACKAGES)))
    try:
        from python_motion_planning.common import TYPES, Grid
        from python_motion_planning.path_planner import LazyThetaStar
    except ImportError as error:
        print(f"lazy_theta_star: no baseline, python_motion_planning cannot be imported from {PACKAGES} ({error})")
        return None
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


def cpu_s(query: Query, rounds: int) -> float:
    """The least CPU time of some rounds."""
    times = []
    for _ in range(rounds):
        before = time.process_time()
        query()
        times.append(time.process_time() - before)
    return min(times)


def measure() -> dict[str, dict[str, Any]]:
    """The row of the table; empty without the baseline. Seconds of CPU time of one query, the grid prepared before."""
    grid = build_grid(HALL, RADIUS_M, [START, GOAL])
    theirs = peer_query(grid)
    if theirs is None:
        return {}

    def ours() -> np.ndarray:
        return lazy_theta_star(grid, START, GOAL)

    ours()
    # The baseline takes so long that one round is enough; ours is measured before and after it.
    before, baseline, after = cpu_s(ours, 15), cpu_s(theirs, 1), cpu_s(ours, 15)
    least = min(before, after)
    name = "python_motion_planning LazyThetaStar"
    row = {"ours": least, "baseline": baseline, "baseline_name": name, "ratio": baseline / least, "unit": "s per query"}
    return {"lazy_theta_star": row}


if __name__ == "__main__":
    print(measure())
