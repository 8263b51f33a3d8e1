"""Relaxation towards the way one wants to walk: the driving term of the social force model.

Another model of steering than path following: no limits of acceleration or turning, but one relaxation
time (Helbing and Molnar 1995, eq. 2): ``d w / dt = (v e - w) / tau`` with velocity w, desired speed v and the unit vector e
towards the point to walk to. Walls exert no force, since the route keeps clear of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.scene import Body, Scene, Task
from walklab.planning.following_kernel import relax_along
from walklab.planning.path_following import ARRIVAL_RADIUS_M, LOOK_AHEAD_M, arrival_of, check_names
from walklab.planning.protocol import Trajectory
from walklab.planning.routes import RouteFinder, prepare_route

Array = NDArray[np.float64]

NAMES = ("v", "tau")


@dataclass(frozen=True)
class SocialForce:
    """A planner of two parameters, v (m/s) and tau (s); starts at rest and stops dead where the route ends.

    ``follow`` ends like :class:`walklab.planning.path_following.PathFollowing`, up to one step beyond the end.
    """

    parameters: tuple[str, ...] = NAMES
    step_s: float = 1 / 60
    look_ahead_m: float = LOOK_AHEAD_M
    arrival_radius_m: float = ARRIVAL_RADIUS_M
    fixed: Mapping[str, float] = field(default_factory=dict)
    finder: RouteFinder = field(default_factory=RouteFinder)
    moving_start: bool = False

    def __post_init__(self) -> None:
        check_names("social_force", self.parameters, self.fixed, NAMES, required=NAMES)

    def route(self, scene: Scene, task: Task, body: Body) -> Array:
        """See :meth:`RouteFinder.route`."""
        return self.finder.route(scene, task, body)

    def follow(self, route_m: Array, task: Task, parameters: Array, time_limit_s: float) -> Trajectory:
        """Walk along the route with one vector of steering parameters; the task's heading does not matter at rest.

        Raises
        ------
        InputError
            If a parameter is not a number above 0.
        """
        values = {**self.fixed, **dict(zip(self.parameters, np.asarray(parameters, dtype=float), strict=True))}
        for name, value in values.items():
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"planner social_force: parameter {name} is {value}; it must be a number above 0")
        route = prepare_route(np.asarray(route_m, dtype=float))
        if len(route) < 2:
            return Trajectory(route[:, :2].copy(), self.step_s, arrival_of(route[:, :2], route, True, self.arrival_radius_m))
        steps = max(math.ceil(time_limit_s / self.step_s - 1e-9), 0)
        positions, at_end = relax_along(route, values["v"], values["tau"], self.look_ahead_m, self.step_s, steps)
        return Trajectory(positions, self.step_s, arrival_of(positions, route, at_end, self.arrival_radius_m))
