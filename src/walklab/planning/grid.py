"""Occupancy grid: where the centre of a body may be, and how far it is from where it may not.

Vertices lie on the lattice of multiples of the cell size (``x = i * cell_m``), so that a
grid that has grown holds the same vertices as before. Each vertex stores its *clearance*: the exact
distance to the nearest obstacle less the body radius, negative where a body does not fit.
That is the same as growing the obstacles by the radius (with truly round corners), and it lets a line of
sight be checked in long steps through free space.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray
from shapely import Point as ShapelyPoint
from shapely import Polygon, get_rings

from walklab.errors import InputError
from walklab.geometry.scene import Point, Scene
from walklab.planning.theta_kernel import BLOCKED, FREE_CELLS, Integers, clearance_at, line_of_sight

Array = NDArray[np.float64]

CLEARANCE_LIMIT_M = 0.5  # clearances are known up to here; it only limits the steps of a line of sight
EXTENT_SLACK_M = 1.0  # a grid that must grow grows by this much more, so that it rarely grows again
FARTHEST_CELL = 1e15  # beyond it, sizes of grids would no longer fit in whole numbers
LARGEST_GRID = 40_000_000  # vertices; 12 bytes each while a route is searched


@njit(cache=True)
def lower_clearance(
    clearance: NDArray[np.float32], first: tuple[int, int], cell_m: float, segments: Array, radius_m: float, reach_m: float
) -> None:
    """Lower the clearances (cells) of all vertices within ``reach_m`` of one polygon.

    Parameters
    ----------
    clearance : (rows, columns) array, changed in place
    first : lattice indices (column, row) of ``clearance[0, 0]``
    segments : (n, 4) array of the polygon's edges x0, y0, x1, y1, all rings, metres
    """
    rows, columns = clearance.shape
    x_min = min(segments[:, 0].min(), segments[:, 2].min()) - reach_m
    x_max = max(segments[:, 0].max(), segments[:, 2].max()) + reach_m
    y_min = min(segments[:, 1].min(), segments[:, 3].min()) - reach_m
    y_max = max(segments[:, 1].max(), segments[:, 3].max()) + reach_m
    for row in range(max(0, int(y_min / cell_m) - first[1] - 1), min(rows, int(y_max / cell_m) - first[1] + 2)):
        y = (row + first[1]) * cell_m
        for column in range(max(0, int(x_min / cell_m) - first[0] - 1), min(columns, int(x_max / cell_m) - first[0] + 2)):
            x = (column + first[0]) * cell_m
            nearest = np.inf
            inside = False
            for k in range(segments.shape[0]):
                x0, y0, x1, y1 = segments[k, 0], segments[k, 1], segments[k, 2], segments[k, 3]
                dx, dy = x1 - x0, y1 - y0
                along = min(1.0, max(0.0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy)))
                ex, ey = x0 + along * dx - x, y0 + along * dy - y
                nearest = min(nearest, ex * ex + ey * ey)
                if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * dx / dy:
                    inside = not inside
            distance = -np.sqrt(nearest) if inside else np.sqrt(nearest)
            clearance[row, column] = min(clearance[row, column], np.float32((distance - radius_m) / cell_m))


@dataclass
class Notes:
    """What searches of one grid note at its vertices.

    A stamp says by which search a vertex was found, from which source, and whether it was expanded: ``base + 2 source``,
    plus one once expanded. Every search begins with a ``base`` above all stamps of earlier ones, so nothing
    is ever cleared, and four bytes a vertex are all that an expansion reads.

    Attributes
    ----------
    stamps : one per vertex, row by row, one each for goal and start
    source_of : the index of a vertex among the sources; only true if that source names the vertex
    base : of the next search; even
    """

    stamps: Integers
    source_of: Integers
    base: int = 2

    @classmethod
    def of(cls, blocked: NDArray[np.bool_]) -> Notes:
        """Notes of a grid that has not been searched."""
        stamps = np.append(np.where(blocked.ravel(), BLOCKED, 0), [0, 0])
        return cls(stamps.astype(np.int32), np.zeros(blocked.size, dtype=np.int32))

    def begin(self) -> int:
        """The base of a new search; once in a hundred thousand searches the stamps start anew."""
        if self.base + 2 * self.stamps.size >= BLOCKED:
            self.stamps[self.stamps != BLOCKED] = 0
            self.base = 2
        return self.base


@dataclass(frozen=True)
class OccupancyGrid:
    """Clearances of a body in a scene on a lattice.

    Attributes
    ----------
    scene : whose obstacles these are
    radius_m : body radius the obstacles are grown by
    cell_m : distance of neighbouring vertices
    first : lattice indices (column, row) of ``clearance_cells[0, 0]``
    clearance_cells : (rows, columns) float32 array, clearance in cells, at most ``CLEARANCE_LIMIT_M``; vertex
        (row, column) lies at ``x = (column + first[0]) * cell_m``, ``y = (row + first[1]) * cell_m``
    """

    scene: Scene
    radius_m: float
    cell_m: float
    first: tuple[int, int]
    clearance_cells: NDArray[np.float32] = field(repr=False)

    @cached_property
    def notes(self) -> Notes:
        """Where searches of this grid keep their notes."""
        return Notes.of(self.blocked)

    @property
    def blocked(self) -> NDArray[np.bool_]:
        """(rows, columns) array: vertices where the body does not fit."""
        return self.clearance_cells < FREE_CELLS

    def covers(self, points_m: Iterable[Point]) -> bool:
        """Whether the grid reaches as far as a search from and to these points may."""
        window = search_window(self.scene, self.radius_m, self.cell_m, points_m)
        rows, columns = self.clearance_cells.shape
        inside_x = self.first[0] <= window[0] and window[2] < self.first[0] + columns
        return inside_x and self.first[1] <= window[1] and window[3] < self.first[1] + rows

    def clearance_m(self, point_m: Point) -> float:
        """Distance that a body at this point is away from the obstacles; negative for an overlap."""
        return clearance_at(self.clearance_cells, self.first, point_m[0] / self.cell_m, point_m[1] / self.cell_m) * self.cell_m

    def line_of_sight(self, start_m: Point, end_m: Point) -> bool:
        """Whether the body can move straight from one point to the other."""
        c = self.cell_m
        ends = start_m[0] / c, start_m[1] / c, end_m[0] / c, end_m[1] / c
        return bool(line_of_sight(self.clearance_cells, self.first, *ends))


def search_window(scene: Scene, radius_m: float, cell_m: float, points_m: Iterable[Point]) -> tuple[int, int, int, int]:
    """Lattice indices (first column, first row, last column, last row) that hold every shortest path between the points.

    A shortest path stays within the convex hull of its ends and the grown obstacles. The window
    depends on nothing else, so that a route does not depend on which routes were asked for before.

    Raises
    ------
    InputError
        If a coordinate is too far away for whole numbers.
    """
    grown = (-radius_m, -radius_m, radius_m, radius_m)
    boxes = [np.add(shape.bounds, grown) for shape in scene.obstacles.values()] + [np.array([x, y, x, y]) for x, y in points_m]
    if not np.max(np.abs(boxes)) / cell_m <= FARTHEST_CELL:
        raise InputError(
            f"scene {scene.name}: a coordinate of {np.max(np.abs(boxes)):g} m is too far away; check the coordinates"
        )
    low = np.floor(np.min(boxes, axis=0)[:2] / cell_m).astype(int) - 3
    high = np.ceil(np.max(boxes, axis=0)[2:] / cell_m).astype(int) + 3
    return int(low[0]), int(low[1]), int(high[0]), int(high[1])


def build_grid(
    scene: Scene, radius_m: float, points_m: Iterable[Point], cell_m: float = 0.01, old: OccupancyGrid | None = None
) -> OccupancyGrid:
    """The grid that holds a scene and the given points, and all that ``old`` held.

    Raises
    ------
    InputError
        If the body is smaller than a cell (thin obstacles would slip through the lattice) or the grid would be too large.
    """
    if scene.obstacles and radius_m < cell_m:
        raise InputError(
            f"scene {scene.name}: a body radius of {radius_m} m is below the grid's cell of {cell_m} m; make cell_m smaller"
        )
    slack = int(EXTENT_SLACK_M / cell_m)
    window = np.add(search_window(scene, radius_m, cell_m, points_m), (-slack, -slack, slack, slack))
    if old is not None:
        rows, columns = old.clearance_cells.shape
        old_last = np.add(old.first, (columns - 1, rows - 1))
        window = np.concatenate([np.minimum(window[:2], old.first), np.maximum(window[2:], old_last)])
    shape = (int(window[3] - window[1]) + 1, int(window[2] - window[0]) + 1)
    if shape[0] * shape[1] > LARGEST_GRID:
        size = f"{shape[1] * cell_m:.1f} x {shape[0] * cell_m:.1f} m"
        raise InputError(
            f"scene {scene.name}: {size} at {cell_m} m cells is too large a grid; make cell_m larger or check the coordinates"
        )
    first = (int(window[0]), int(window[1]))
    clearance = np.full(shape, CLEARANCE_LIMIT_M / cell_m, dtype=np.float32)
    for polygon in scene.obstacles.values():
        lower_clearance(clearance, first, cell_m, edges(polygon), radius_m, radius_m + CLEARANCE_LIMIT_M)
    return OccupancyGrid(scene, radius_m, cell_m, first, clearance)


def edges(polygon: Polygon) -> Array:
    """(n, 4) array: x0, y0, x1, y1 of every edge of a polygon's outline and holes."""
    rings = [np.asarray(ring.coords)[:, :2] for ring in get_rings(polygon)]
    lines = np.concatenate([np.column_stack([ring[:-1], ring[1:]]) for ring in rings])
    return np.ascontiguousarray(lines[np.any(lines[:, :2] != lines[:, 2:], axis=1)])


def free_point(grid: OccupancyGrid, point_m: Point, role: str, tolerance_m: float) -> Point:
    """The point itself if the body fits there, else the nearest free vertex within the tolerance.

    Raises
    ------
    InputError
        If the body overlaps an obstacle by more than the tolerance.
    """
    if grid.clearance_m(point_m) >= FREE_CELLS * grid.cell_m:
        return point_m
    nearest = nearest_free_vertex(grid, point_m, tolerance_m)
    if nearest is not None:
        return nearest
    where = ShapelyPoint(point_m)
    name = min(grid.scene.obstacles, key=lambda key: (grid.scene.obstacles[key].distance(where), key))
    shape = grid.scene.obstacles[name]
    overlap = grid.radius_m - shape.distance(where) + (shape.exterior.distance(where) if shape.contains(where) else 0.0)
    raise InputError(
        f"scene {grid.scene.name}: {role} ({point_m[0]:.3f}, {point_m[1]:.3f}) overlaps obstacle {name!r}"
        f" for a body radius of {grid.radius_m} m; move it {overlap:.3f} m away (up to {tolerance_m} m is tolerated)"
    )


def nearest_free_vertex(grid: OccupancyGrid, point_m: Point, within_m: float) -> Point | None:
    """The free vertex closest to a point, or None if there is none within the distance."""
    reach = int(np.ceil(within_m / grid.cell_m)) + 1
    u, v = point_m[0] / grid.cell_m, point_m[1] / grid.cell_m
    column, row = round(u), round(v)
    offsets = np.arange(-reach, reach + 1)
    columns, rows = column + offsets - grid.first[0], row + offsets - grid.first[1]
    columns = columns[(columns >= 0) & (columns < grid.clearance_cells.shape[1])]
    rows = rows[(rows >= 0) & (rows < grid.clearance_cells.shape[0])]
    free = ~grid.blocked[np.ix_(rows, columns)]
    distance = np.hypot((columns + grid.first[0] - u)[None, :], (rows + grid.first[1] - v)[:, None]) * grid.cell_m
    distance[~free | (distance > within_m)] = np.inf
    if not distance.size or not np.isfinite(distance.min()):
        return None
    i, j = np.unravel_index(np.argmin(distance), distance.shape)
    return float((columns[j] + grid.first[0]) * grid.cell_m), float((rows[i] + grid.first[1]) * grid.cell_m)
