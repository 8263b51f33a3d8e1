"""Clearances against shapely, and the window of a search."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely import Polygon, box

from walklab.errors import InputError
from walklab.geometry.scene import Body, Scene, State, Task, disc
from walklab.planning.grid import CLEARANCE_LIMIT_M, build_grid, nearest_free_vertex
from walklab.planning.routes import RouteFinder

HOLE = Polygon(box(3, 0, 5, 2).exterior.coords, [box(3.5, 0.5, 4.5, 1.5).exterior.coords])
SCENE = Scene("mixed", {"turned": Polygon([(0, 0), (1, 0.4), (0.7, 1.3), (-0.2, 0.8)]), "pole": disc((2, 1), 0.3), "frame": HOLE})


def vertices(grid) -> np.ndarray:
    rows, columns = grid.clearance_cells.shape
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    return np.stack([(j + grid.first[0]) * grid.cell_m, (i + grid.first[1]) * grid.cell_m], axis=-1)


def test_clearance_is_the_distance_to_the_obstacles_less_the_radius() -> None:
    grid = build_grid(SCENE, 0.2, [(-1, -1), (6, 3)], cell_m=0.05)
    points = shapely.points(vertices(grid))
    everything = shapely.union_all(list(SCENE.obstacles.values()))
    outside = shapely.distance(everything, points)
    inside = np.where(shapely.contains(everything, points), shapely.distance(everything.boundary, points), 0.0)
    expected = np.minimum(outside - inside - 0.2, CLEARANCE_LIMIT_M)
    near = outside < 0.2 + CLEARANCE_LIMIT_M - 0.05
    assert np.allclose((grid.clearance_cells * 0.05)[near], expected[near], atol=1e-6)
    # far away, any value between the limit and the truth is right
    assert np.all(grid.clearance_cells * 0.05 <= outside - inside - 0.2 + 1e-6)


def test_blocked_vertices_are_those_inside_the_grown_obstacles() -> None:
    grid = build_grid(SCENE, 0.25, [(-1, -1), (6, 3)], cell_m=0.02)
    x, y = np.moveaxis(vertices(grid), -1, 0)
    shapes = list(SCENE.obstacles.values())
    surely = shapely.union_all([shape.buffer(0.2499, quad_segs=128) for shape in shapes])
    perhaps = shapely.union_all([shape.buffer(0.2501, quad_segs=128) for shape in shapes])
    assert np.all(grid.blocked[shapely.contains_xy(surely, x, y)])
    assert not np.any(grid.blocked[~shapely.contains_xy(perhaps, x, y)])


def test_a_grown_grid_keeps_its_vertices() -> None:
    small = build_grid(SCENE, 0.2, [(0, 0)], cell_m=0.05)
    large = build_grid(SCENE, 0.2, [(-4, 5)], cell_m=0.05, old=small)
    dx, dy = small.first[0] - large.first[0], small.first[1] - large.first[1]
    rows, columns = small.clearance_cells.shape
    assert large.covers([(0, 0), (-4, 5)])
    assert not small.covers([(-4, 5)])
    assert np.array_equal(large.clearance_cells[dy : dy + rows, dx : dx + columns], small.clearance_cells)


def test_one_grid_answers_many_queries_and_grows_when_it_must() -> None:
    finder = RouteFinder(cell_m=0.05)
    inside, outside = Task(State((-0.5, 1.5)), State((2.0, 2.0))), Task(State((-9.0, 1.0)), State((2.0, 2.0)))
    first = finder.grid(SCENE, inside, Body(0.2))
    assert finder.grid(Scene("mixed", dict(SCENE.obstacles)), inside, Body(0.2)) is first
    assert finder.grid(SCENE, inside, Body(0.3)) is not first
    grown = finder.grid(SCENE, outside, Body(0.2))
    assert grown is not first
    assert finder.grid(SCENE, inside, Body(0.2)) is grown


def test_nearest_free_vertex_is_the_nearest_of_all() -> None:
    grid = build_grid(SCENE, 0.2, [(-1, -1), (6, 3)], cell_m=0.02)
    points = vertices(grid)
    for point in [(0.5, -0.15), (2.31, 1.31), (5.11, 1.003), (4.0, 0.62)]:
        distance = np.where(grid.blocked, np.inf, np.hypot(*np.moveaxis(points - point, -1, 0)))
        found = nearest_free_vertex(grid, point, 0.5)
        assert found is not None
        assert np.hypot(found[0] - point[0], found[1] - point[1]) == pytest.approx(distance.min())
    assert nearest_free_vertex(grid, (3.25, 1.0), 0.1) is None


def test_grids_that_cannot_be_are_refused() -> None:
    with pytest.raises(InputError, match=r"body radius of 0.005 m is below the grid's cell of 0.01 m"):
        build_grid(SCENE, 0.005, [(0, 0)])
    with pytest.raises(InputError, match=r"scene mixed: .* too large a grid"):
        build_grid(SCENE, 0.2, [(0, 0), (4000, 3000)])
