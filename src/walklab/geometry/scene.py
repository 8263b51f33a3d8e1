"""Scenes and tasks in metres, plan view.

They live here, not in ``planning``, because the synthetic capture must see the same
obstacles while sharing no code with the planner that is later fitted to it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from shapely import Polygon, box

from walklab.errors import InputError

Point = tuple[float, float]


@dataclass(frozen=True)
class Scene:
    """Obstacles in plan view.

    Attributes
    ----------
    name : what results call the scene
    obstacles : obstacle name -> polygon in metres, not grown by any body
    """

    name: str
    obstacles: Mapping[str, Polygon] = field(default_factory=dict)


@dataclass(frozen=True)
class State:
    """Where a person is, faces and how fast they go; heading None means along the planned path."""

    position_m: Point
    heading_rad: float | None = None
    speed_m_s: float = 0.0


@dataclass(frozen=True)
class Task:
    """A walk to be made: from a start state to an end state."""

    start: State
    end: State


@dataclass(frozen=True)
class Body:
    """The walking person seen from above: a disc."""

    radius_m: float = 0.25


def obstacle_from_config(name: str, shape: Mapping[str, Any]) -> Polygon:
    """One obstacle from its description: ``box: [x_min, y_min, x_max, y_max]``, ``polygon: [[x, y], ...]``
    or ``circle: {centre: [x, y], radius: r}``, metres.

    Raises
    ------
    InputError
        If the shape is unknown, degenerate or crosses itself.
    """
    if "box" in shape:
        polygon = box(*shape["box"])
    elif "polygon" in shape:
        polygon = Polygon(shape["polygon"])
    elif "circle" in shape:
        polygon = disc(shape["circle"]["centre"], shape["circle"]["radius"])
    else:
        raise InputError(f"obstacle {name}: needs one of box, polygon or circle, has {sorted(shape)}")
    if not polygon.is_valid or polygon.area <= 0:
        raise InputError(f"obstacle {name}: its outline has no area or crosses itself; order the corners around it")
    return polygon


def disc(centre_m: Sequence[float], radius_m: float, corners: int = 16) -> Polygon:
    """A regular polygon around a circle (circumscribed, so that nothing passes through the true disc)."""
    outer = radius_m / math.cos(math.pi / corners)
    angles = [2 * math.pi * index / corners for index in range(corners)]
    return Polygon([(centre_m[0] + outer * math.cos(a), centre_m[1] + outer * math.sin(a)) for a in angles])
