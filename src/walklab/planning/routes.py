"""Routes: finding them, with one grid per scene and body, and preparing them for the compiled walkers."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.geometry.scene import Body, Scene, Task
from walklab.planning.grid import OccupancyGrid, build_grid
from walklab.planning.lazy_theta_star import SNAP_M, lazy_theta_star

Array = NDArray[np.float64]
Offsets = NDArray[np.int64]


@dataclass(frozen=True)
class RouteFinder:
    """Lazy Theta* routes; a scene is prepared once per body radius and answers all later queries.

    Attributes
    ----------
    cell_m : grid cell (Agethen et al. 2017, section 4.3: 0.01 m)
    snap_m : overlap of a start or end with a grown obstacle that is tolerated
    """

    cell_m: float = 0.01
    snap_m: float = SNAP_M
    _grids: dict[tuple, OccupancyGrid] = field(default_factory=dict, repr=False, compare=False)

    def route(self, scene: Scene, task: Task, body: Body) -> Array:
        """A collision-free polyline from start to end, (n, 2) array, metres.

        Raises
        ------
        InputError
            If an end overlaps an obstacle or there is no way between the ends.
        """
        start, end = task.start.position_m, task.end.position_m
        if not scene.obstacles:
            return np.array([start, end], dtype=float)
        return lazy_theta_star(self.grid(scene, task, body), start, end, self.snap_m)

    def grid(self, scene: Scene, task: Task, body: Body) -> OccupancyGrid:
        """The grid of the scene, grown if the task's ends lie outside."""
        points = [task.start.position_m, task.end.position_m]
        key = (scene.name, body.radius_m, tuple((name, shape.wkb) for name, shape in scene.obstacles.items()))
        grid = self._grids.get(key)
        if grid is None or not grid.covers(points):
            grid = self._grids[key] = build_grid(scene, body.radius_m, points, self.cell_m, grid)
        return grid


@njit(cache=True)
def prepare_route(route_m: Array) -> Array:
    """Points of a route without repeats, their arc length and the direction of the leg that follows.

    Parameters
    ----------
    route_m : (n, 2) array, metres

    Returns
    -------
    (m, 5) array of x, y, arc length, direction x, direction y; the last row repeats the last leg's direction;
    one row if the route has no extent
    """
    prepared = np.zeros((len(route_m), 5))
    # Number by number: assigning slices makes numba compile the text of an error message, which takes seconds.
    prepared[0, 0], prepared[0, 1] = route_m[0, 0], route_m[0, 1]
    count = 1
    for corner in range(1, len(route_m)):
        x, y = route_m[corner, 0], route_m[corner, 1]
        dx, dy = x - prepared[count - 1, 0], y - prepared[count - 1, 1]
        length = math.hypot(dx, dy)
        if length > 0.0:
            prepared[count, 0], prepared[count, 1] = x, y
            prepared[count, 2] = prepared[count - 1, 2] + length
            prepared[count - 1, 3], prepared[count - 1, 4] = dx / length, dy / length
            count += 1
    if count > 1:
        prepared[count - 1, 3], prepared[count - 1, 4] = prepared[count - 2, 3], prepared[count - 2, 4]
    return prepared[:count].copy()


@njit(cache=True)
def prepare_routes(routes_m: Array, offsets: Offsets) -> tuple[Array, Offsets]:
    """Packed routes prepared one by one, and where each begins: :func:`prepare_route` without a call per route."""
    prepared = np.empty((len(routes_m), 5))
    starts = np.zeros(len(offsets), dtype=np.int64)
    for index in range(len(offsets) - 1):
        route = prepare_route(routes_m[offsets[index] : offsets[index + 1]])
        starts[index + 1] = starts[index] + len(route)
        for point in range(len(route)):
            for column in range(5):
                prepared[starts[index] + point, column] = route[point, column]
    return prepared[: starts[-1]].copy(), starts
