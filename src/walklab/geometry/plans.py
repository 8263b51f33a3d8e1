"""Plan views from ``config/scenes/*.yaml``: obstacles, stations and the walks between them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from walklab.errors import InputError
from walklab.geometry.scene import Point, Scene, obstacle_from_config


@dataclass(frozen=True)
class Station:
    """A place where a person stands and works.

    Attributes
    ----------
    position_m : where
    facing_deg : direction of the work, counter-clockwise from +x
    work_height_m : height of what the hands reach for; None where nobody bends
    """

    position_m: Point
    facing_deg: float = 0.0
    work_height_m: float | None = None


@dataclass(frozen=True)
class Plan:
    """A scene with its stations and one set of walks, each from one station to another."""

    scene: Scene
    stations: Mapping[str, Station] = field(default_factory=dict)
    walks: tuple[tuple[str, str], ...] = ()


OPEN = Plan(Scene("open"))
KEYS = ("name", "description", "obstacles", "stations", "walks")


def load_plan(path: str | Path) -> Plan:
    """Read a plan view.

    Raises
    ------
    InputError
        If the file is missing or no YAML, a key is unknown, an obstacle is degenerate,
        or a walk names a station that does not exist.
    """
    source = Path(path)
    try:
        described = yaml.safe_load(source.read_text())
    except OSError as error:
        raise InputError(f"{source}: no such plan view; put it under config/scenes/") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{source}: not a text file in UTF-8; give a plan view in YAML") from error
    except yaml.YAMLError as error:
        raise InputError(f"{source}: not valid YAML ({str(error).splitlines()[0]})") from error
    if not isinstance(described, dict):
        found = "is empty" if described is None else f"holds {described!r}"
        raise InputError(f"{source}: {found}; a plan view has {', '.join(KEYS)}")
    if unknown := set(described) - set(KEYS):
        raise InputError(f"{source}: unknown keys {sorted(map(str, unknown))}; a plan view has {', '.join(KEYS)}")
    try:
        obstacles = {str(name): obstacle_from_config(name, shape) for name, shape in _section(described, "obstacles").items()}
        stations = {str(name): _station(name, station) for name, station in _section(described, "stations").items()}
        walks = tuple(_walk(walk, stations) for walk in described.get("walks") or ())
    except InputError as error:
        raise InputError(f"{source}: {error}") from error
    return Plan(Scene(described.get("name", source.stem), obstacles), stations, walks)


def _section(described: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    section = described.get(name) or {}
    if not isinstance(section, Mapping):
        raise InputError(f"{name}: give each a name, as docs/second-scene.md shows, not {section!r}")
    return section


def _station(name: str, described: Any) -> Station:
    try:
        x, y = described["position_m"]
        height = described.get("work_height_m")
        facing_deg = float(described.get("facing_deg", 0.0))
        station = Station((float(x), float(y)), facing_deg, None if height is None else float(height))
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"station {name}: not described as docs/second-scene.md shows ({error!r})") from error
    if not all(map(math.isfinite, (*station.position_m, station.facing_deg, station.work_height_m or 0.0))):
        raise InputError(f"station {name}: every number must be finite; it has {described!r}")
    return station


def _walk(described: Any, stations: Mapping[str, Station]) -> tuple[str, str]:
    if not isinstance(described, list) or len(described) != 2:
        raise InputError(f"walks: {described!r} is no pair of stations, [from, to]")
    for name in described:
        if name not in stations:
            raise InputError(f"walks: there is no station {name!r}; known are {sorted(stations)}")
    return described[0], described[1]
