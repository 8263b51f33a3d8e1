"""Obstacles from configuration."""

from __future__ import annotations

import math

import pytest
from shapely import Point

from walklab.errors import InputError
from walklab.geometry.scene import Body, State, disc, obstacle_from_config


def test_shapes_have_the_area_they_describe() -> None:
    assert obstacle_from_config("a", {"box": [0, 1, 3, 2]}).area == pytest.approx(3.0)
    assert obstacle_from_config("b", {"polygon": [[0, 0], [4, 0], [0, 3]]}).area == pytest.approx(6.0)
    circle = obstacle_from_config("c", {"circle": {"centre": [1, -2], "radius": 0.5}})
    assert circle.centroid.distance(Point(1, -2)) < 1e-12
    assert math.pi * 0.25 < circle.area < 1.02 * math.pi * 0.25


@pytest.mark.parametrize("corners", [6, 16, 64])
def test_a_disc_covers_the_circle_and_touches_it(corners: int) -> None:
    shape = disc((0.3, 0.7), 0.4, corners)
    assert shape.exterior.distance(Point(0.3, 0.7)) == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ({"square": [0, 0, 1, 1]}, "obstacle x: needs one of box, polygon or circle"),
        ({"box": [0, 0, 0, 1]}, "obstacle x: its outline has no area"),
        ({"polygon": [[0, 0], [1, 1], [1, 0], [0, 1]]}, "crosses itself"),
        ({"circle": {"centre": [0, 0], "radius": 0}}, "obstacle x: .*give a radius above 0 m"),
        ({"box": [0, 0, 1]}, "obstacle x: box .* is not as docs/second-scene.md says"),
    ],
)
def test_shapes_that_are_none_are_refused(shape: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        obstacle_from_config("x", shape)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: State((math.nan, 0.0)), r"position \(nan, 0.0\): give x and y as two finite numbers"),
        (lambda: State((0.0, math.inf)), "two finite numbers"),
        (lambda: State((0.0, 0.0, 0.0)), "two finite numbers"),  # type: ignore[arg-type]
        (lambda: State((0.0, 0.0), math.nan), "heading nan"),
        (lambda: State((0.0, 0.0), None, -0.1), "speed -0.1: give 0 m/s or more"),
        (lambda: State((0.0, 0.0), None, math.nan), "speed nan"),
        (lambda: Body(0.0), "body radius 0.0"),
        (lambda: Body(math.nan), "body radius nan"),
    ],
)
def test_states_and_bodies_that_are_none_are_refused(make, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()
