"""Planners by name: the two of this package, and any that another package offers."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import entry_points
from typing import Any

from walklab.errors import InputError
from walklab.geometry.scene import Task
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import Planner
from walklab.planning.routes import RouteFinder
from walklab.planning.social_force import SocialForce

ENTRY_POINTS = "walklab.planners"

Factory = Callable[[Sequence[str], float, Mapping[str, Any]], Planner]

OWN = {"path_following": PathFollowing, "social_force": SocialForce}
ROUTE_OPTIONS = ("cell_m", "snap_m")
NOT_OPTIONS = ("parameters", "step_s", "finder", "moving_start")


def make_planner(name: str, parameters: Sequence[str], step_s: float, options: Mapping[str, Any] | None = None) -> Planner:
    """The planner of that name.

    Parameters
    ----------
    name : "path_following", "social_force", or an entry point of the group ``walklab.planners``, which names a
        callable ``(parameters, step_s, options) -> Planner``
    parameters : names of the steering parameters in the order of the vectors it will be given
    step_s : simulation step
    options : what else the planner takes, e.g. ``cell_m``, ``snap_m``, ``look_ahead_m``, ``arrival_radius_m``, ``fixed``,
        ``braking``, ``turn_law``, ``ends_at``

    Raises
    ------
    InputError
        If the planner, a parameter or an option is unknown.
    """
    options = dict(options or {})
    if name in OWN:
        return _own_planner(name, tuple(parameters), step_s, options)
    factories = {point.name: point for point in entry_points(group=ENTRY_POINTS)}
    if name not in factories:
        raise InputError(f"planner: unknown name {name!r}; known are {', '.join(sorted({*OWN, *factories}))}")
    factory: Factory = factories[name].load()
    return factory(tuple(parameters), step_s, options)


def _own_planner(name: str, parameters: tuple[str, ...], step_s: float, options: dict[str, Any]) -> Planner:
    kind = OWN[name]
    own = [option for option in inspect.signature(kind).parameters if option not in NOT_OPTIONS]
    if unknown := sorted(set(options) - {*own, *ROUTE_OPTIONS}):
        raise InputError(f"planner {name}: unknown option {unknown[0]!r}; known are {', '.join(sorted([*own, *ROUTE_OPTIONS]))}")
    route_options: dict[str, Any] = {key: float(options.pop(key)) for key in ROUTE_OPTIONS if key in options}
    finder = RouteFinder(**route_options)
    if not finder.cell_m > 0 or not finder.snap_m >= 0:
        raise InputError(f"planner {name}: cell_m {finder.cell_m} must be above 0 and snap_m {finder.snap_m} not below")
    return kind(parameters=parameters, step_s=step_s, finder=finder, **options)


def require_start_supported(planner: Planner, task: Task, walk_name: str) -> None:
    """Refuse a walk that starts or ends while walking if the planner only knows standing.

    Raises
    ------
    InputError
        Naming the walk and its speeds.
    """
    if planner.moving_start or (task.start.speed_m_s == 0.0 and task.end.speed_m_s == 0.0):
        return
    raise InputError(
        f"walk {walk_name}: starts at {task.start.speed_m_s:.2f} m/s and ends at {task.end.speed_m_s:.2f} m/s, but the planner"
        f" {type(planner).__name__} only starts and ends standing; leave the walk out or choose a planner with a moving start"
    )
