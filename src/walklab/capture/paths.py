"""Paths shaped as people walk them: round the obstacles with room to spare, corners rounded, never quite straight.

This is the generator's own view of space. It shares nothing with the planners that are
fitted later: a visibility graph over softly grown polygons, smoothed along its length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from shapely import Point as ShapelyPoint
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from walklab.errors import InputError
from walklab.geometry.curves import arc_length, resample, smooth
from walklab.geometry.scene import Point, Scene

Array = NDArray[np.float64]

SPACING_M = 0.01
_TOUCH_M = 1e-6


@dataclass(frozen=True)
class Habit:
    """How one person takes corners: metres kept to obstacles, the least of it, where it is given up, rounding."""

    clearance_m: float
    least_clearance_m: float
    freedom_m: float
    rounding_m: float


def habitual_path(scene: Scene, start: Point, end: Point, habit: Habit) -> Array:
    """The path that a person takes from start to end when nothing varies, (n, 2) array every 1 cm.

    Raises
    ------
    InputError
        If the obstacles leave no way from start to end.
    """
    corners = _shortest(_blocked(scene, (start, end), habit), start, end, scene.name)
    path = resample(corners, SPACING_M)
    if len(corners) > 2:
        path = smooth(path, habit.rounding_m / SPACING_M)
    return resample(path, SPACING_M)


def _blocked(scene: Scene, places: Sequence[Point], habit: Habit) -> BaseGeometry:
    """Where the centre of the body does not go: obstacles with the person's clearance, except close to the places themselves."""
    grown = []
    freedom = shapely.union_all([ShapelyPoint(place).buffer(habit.freedom_m, quad_segs=6) for place in places])
    for obstacle in scene.obstacles.values():
        room = min(obstacle.distance(ShapelyPoint(place)) for place in places)
        least = obstacle.buffer(max(min(habit.least_clearance_m, room - 0.01), 0.0), quad_segs=4)
        grown.append(least.union(obstacle.buffer(habit.clearance_m, quad_segs=4).difference(freedom)))
    return shapely.union_all(grown)


def _shortest(blocked: BaseGeometry, start: Point, end: Point, scene_name: str) -> Array:
    direct = shapely.linestrings([start, end])
    shrunk = blocked.buffer(-_TOUCH_M) if not blocked.is_empty else blocked
    shapely.prepare(shrunk)
    if not shapely.intersects(shrunk, direct):
        return np.array([start, end], dtype=float)
    nodes = np.vstack([np.array([start, end], dtype=float), shapely.get_coordinates(_outlines(blocked))])
    first, second = np.triu_indices(len(nodes), k=1)
    lines = shapely.linestrings(np.stack([nodes[first], nodes[second]], axis=1))
    free = ~shapely.intersects(shrunk, lines)
    lengths = np.hypot(*(nodes[first] - nodes[second]).T)
    keep = free & (lengths > 0)
    graph = coo_matrix((lengths[keep], (first[keep], second[keep])), shape=(len(nodes), len(nodes)))
    distance, previous = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    if not np.isfinite(distance[1]):
        raise InputError(f"scene {scene_name}: no way from {start} to {end}; move the stations or the obstacles apart")
    chain = [1]
    while chain[-1] != 0:
        chain.append(int(previous[chain[-1]]))
    return nodes[chain[::-1]]


def _outlines(blocked: BaseGeometry) -> BaseGeometry:
    return blocked.boundary.simplify(1e-4) if isinstance(blocked, Polygon) else shapely.boundary(blocked).simplify(1e-4)


def move_ends(path: Array, start: Array, end: Array) -> Array:
    """The same path from another start to another end: the shifts fade linearly along the path."""
    along = arc_length(path)
    share = (along / along[-1])[:, None]
    return path + (1 - share) * (start - path[0]) + share * (end - path[-1])


def wander(path: Array, ratio: float, modes: int, rng: np.random.Generator) -> Array:
    """Slow lateral deviation that vanishes at both ends: half waves with random weights.

    ``offset(s) = l * ratio * sum_k a_k sin(k pi s / l) / k`` with standard normal ``a_k``, along the normal.
    """
    weights = rng.standard_normal(modes)
    if ratio == 0:
        return path
    along = arc_length(path)
    share = along / along[-1]
    waves = sum(weights[k - 1] * np.sin(k * np.pi * share) / k for k in range(1, modes + 1))
    return path + (along[-1] * ratio * waves)[:, None] * normals(path)


def normals(path: Array) -> Array:
    """Unit normals (to the left) at each point of a path, (n, 2) array."""
    tangents = np.gradient(path, axis=0)
    tangents /= np.maximum(np.hypot(*tangents.T), 1e-12)[:, None]
    return np.column_stack([-tangents[:, 1], tangents[:, 0]])
