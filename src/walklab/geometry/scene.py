"""Scenes and tasks in metres, plan view.

They live here, not in ``planning``, because the synthetic capture must see the same
obstacles while sharing no code with the planner that is later fitted to it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from walklab.errors import InputError

if TYPE_CHECKING:
    from shapely import Polygon

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
    """Where a person is, faces and how fast they go; heading None means along the planned path.

    Raises
    ------
    InputError
        If one of these is no finite number, or the speed is negative.
    """

    position_m: Point
    heading_rad: float | None = None
    speed_m_s: float = 0.0

    def __post_init__(self) -> None:
        if len(self.position_m) != 2 or not all(map(math.isfinite, self.position_m)):
            raise InputError(f"position {self.position_m}: give x and y as two finite numbers of metres")
        if self.heading_rad is not None and not math.isfinite(self.heading_rad):
            raise InputError(f"heading {self.heading_rad}: give a finite angle in radians, or None for along the path")
        if not 0 <= self.speed_m_s < math.inf:
            raise InputError(f"speed {self.speed_m_s}: give 0 m/s or more")


@dataclass(frozen=True)
class Task:
    """A walk to be made: from a start state to an end state."""

    start: State
    end: State


@dataclass(frozen=True)
class Body:
    """The walking person seen from above: a disc; InputError if its radius is not above 0."""

    radius_m: float = 0.25

    def __post_init__(self) -> None:
        if not 0 < self.radius_m < math.inf:
            raise InputError(f"body radius {self.radius_m}: give a number of metres above 0")


def obstacle_from_config(name: str, shape: Mapping[str, Any]) -> Polygon:
    """One obstacle from its description: ``box: [x_min, y_min, x_max, y_max]``, ``polygon: [[x, y], ...]``
    or ``circle: {centre: [x, y], radius: r}``, metres.

    Raises
    ------
    InputError
        If the shape is unknown, degenerate or crosses itself.
    """
    from shapely import Polygon, box  # late: a program that only names a scene loads no geometry

    if not isinstance(shape, Mapping) or len(shape) != 1 or next(iter(shape)) not in ("box", "polygon", "circle"):
        has = sorted(map(str, shape)) if isinstance(shape, Mapping) else repr(shape)
        raise InputError(f"obstacle {name}: needs one of box, polygon or circle, has {has}")
    kind, measures = next(iter(shape.items()))
    try:
        if kind == "box":
            polygon = box(*map(float, measures))
        elif kind == "polygon":
            polygon = Polygon([(float(x), float(y)) for x, y in measures])
        else:
            polygon = disc([float(x) for x in measures["centre"]], float(measures["radius"]))
    except (KeyError, TypeError, IndexError, ValueError) as error:
        raise InputError(f"obstacle {name}: {kind} {measures!r} is not as docs/second-scene.md says ({error})") from error
    if not all(map(math.isfinite, polygon.bounds)) or not polygon.is_valid or polygon.area <= 0:
        raise InputError(f"obstacle {name}: its outline has no area or crosses itself; order the corners around it")
    return polygon


def disc(centre_m: Sequence[float], radius_m: float, corners: int = 16) -> Polygon:
    """A regular polygon around a circle (circumscribed, so that nothing passes through the true disc).

    Raises
    ------
    InputError
        If the radius is not above 0.
    """
    from shapely import Polygon

    if not 0 < radius_m < math.inf:
        raise InputError(f"circle of radius {radius_m}: give a radius above 0 m")
    outer = radius_m / math.cos(math.pi / corners)
    angles = [2 * math.pi * index / corners for index in range(corners)]
    return Polygon([(centre_m[0] + outer * math.cos(a), centre_m[1] + outer * math.sin(a)) for a in angles])
