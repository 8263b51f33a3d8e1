"""Plan views from ``config/scenes/*.yaml``: obstacles, stations and the walks between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

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
    except yaml.YAMLError as error:
        raise InputError(f"{source}: not valid YAML ({str(error).splitlines()[0]})") from error
    if not isinstance(described, dict) or (unknown := set(described) - {"name", "description", "obstacles", "stations", "walks"}):
        keys = sorted(unknown) if isinstance(described, dict) else described
        raise InputError(f"{source}: unknown keys {keys}; a plan view has name, description, obstacles, stations and walks")
    try:
        obstacles = {name: obstacle_from_config(name, shape) for name, shape in (described.get("obstacles") or {}).items()}
        stations = {
            name: Station(
                (float(s["position_m"][0]), float(s["position_m"][1])), s.get("facing_deg", 0.0), s.get("work_height_m")
            )
            for name, s in (described.get("stations") or {}).items()
        }
    except InputError as error:
        raise InputError(f"{source}: {error}") from error
    except (KeyError, TypeError, IndexError, ValueError) as error:
        raise InputError(f"{source}: an obstacle or station is not described as config/README.md says ({error!r})") from error
    walks = tuple((walk[0], walk[1]) for walk in described.get("walks") or ())
    for name in {name for walk in walks for name in walk}:
        if name not in stations:
            raise InputError(f"{source}: walks: there is no station {name!r}; known are {sorted(stations)}")
    return Plan(Scene(described.get("name", source.stem), obstacles), stations, walks)
