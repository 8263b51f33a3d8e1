"""Simulating walks through a scene, with given steering parameters or with ones drawn from a motion model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from shapely import union_all

from walklab.errors import InputError
from walklab.geometry.collisions import through
from walklab.geometry.scene import Body, Scene, Task
from walklab.geometry.standing import Standing
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import Arrival, Planner, Trajectory
from walklab.steering.arguments import count_of
from walklab.steering.dependencies import DEPENDENCIES, dependency_vectors
from walklab.steering.probabilistic import ProbabilisticModel

Array = NDArray[np.float64]

TIME_LIMIT_S = 60.0


@dataclass(frozen=True)
class DrawnWalks:
    """Variants of one walk, with parameters drawn from a motion model.

    Attributes
    ----------
    names, units : of the P steering parameters
    vector : (D,) dependencies the parameters were drawn for
    inside : whether the model was trained on walks like this one
    route_m : (m, 2) the planned route
    parameters : (n, P)
    trajectories : one per variant
    travel_times_s : (n,); inf where the walk did not end within the time limit
    collided : (n,) whether the centre of the body went through an obstacle
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    vector: Array
    inside: bool
    route_m: Array
    parameters: Array
    trajectories: tuple[Trajectory, ...]
    travel_times_s: Array
    collided: NDArray[np.bool_]

    @property
    def missed(self) -> NDArray[np.bool_]:
        """(n,) whether a walk went by the end, out of reach of it, though it came to the end of the route."""
        return np.array([walk.arrival == Arrival.PASSED for walk in self.trajectories])

    def quantiles(self, levels: Sequence[float]) -> Array:
        """Travel times (s) that a share ``levels`` of the variants does not exceed; inf where too few end in time.

        Walks that missed the end or went through an obstacle count like the others; see :attr:`missed` and :attr:`collided`.

        Raises
        ------
        InputError
            If a level is not between 0 and 1.
        """
        if not all(0 <= level <= 1 for level in levels):
            raise InputError(f"quantiles: levels {list(levels)} must lie between 0 and 1")
        return np.quantile(self.travel_times_s, levels, method="inverted_cdf")

    def table(self) -> pd.DataFrame:
        """A row per variant: draw, one column per parameter, travel_time_s, arrival and collided."""
        table = pd.DataFrame(self.parameters, columns=list(self.names))
        table.insert(0, "draw", np.arange(len(table)))
        arrivals = [trajectory.arrival.name.lower() for trajectory in self.trajectories]
        return table.assign(travel_time_s=self.travel_times_s, arrival=arrivals, collided=self.collided)


def simulate(
    scene: Scene,
    task: Task,
    parameters: ArrayLike,
    *,
    planner: Planner | None = None,
    body: Body | None = None,
    time_limit_s: float = TIME_LIMIT_S,
) -> Trajectory | list[Trajectory]:
    """Walk from the task's start to its end.

    Parameters
    ----------
    parameters : (P,) one vector gives one trajectory, (n, P) give a list; in the order of ``planner.parameters``
    planner : default: path following with v (m/s), a (m/s²) and omega (1/m)
    body : default: a disc of 0.25 m radius
    time_limit_s : longest simulated time

    Raises
    ------
    InputError
        If there is no way, or a parameter has no sensible value.
    """
    walker = PathFollowing() if planner is None else planner
    values = np.asarray(parameters, dtype=float)
    if values.ndim not in (1, 2) or values.shape[-1] != len(walker.parameters):
        raise InputError(
            f"parameters of shape {values.shape}: needed are {', '.join(walker.parameters)}, one vector or one per row"
        )
    _check_limit(time_limit_s)
    route = walker.route(scene, task, Body() if body is None else body)
    if values.ndim == 1:
        return walker.follow(route, task, values, time_limit_s)
    return [walker.follow(route, task, vector, time_limit_s) for vector in values]


def task_vector(model: ProbabilisticModel, route_m: Array, task: Task, **given: float) -> Array:
    """Dependencies of a walk along a planned route, in the model's order.

    Length and curvature come from the route and the start speed from the task; whatever else the model needs, such as
    ``height`` (m), must be given by name. What is given by name wins.

    Raises
    ------
    InputError
        If a dependency is missing or unknown.
    """
    known = dict(given)
    of_route = [
        name for name in model.dependencies if name in DEPENDENCIES and DEPENDENCIES[name].of_the_path and name not in known
    ]
    if of_route:
        found = dependency_vectors(pd.DataFrame({"walk": ["walk"]}), {"walk": np.asarray(route_m)}, of_route)
        known |= {name: float(found[name].iloc[0]) for name in of_route}
    if "start_speed" in model.dependencies:
        known.setdefault("start_speed", task.start.speed_m_s)
    return model.vector(**known)


def simulate_draws(
    model: ProbabilisticModel,
    scene: Scene,
    task: Task,
    draws: int = 200,
    rng: np.random.Generator | None = None,
    *,
    planner: Planner | None = None,
    body: Body | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    standing: Standing | None = None,
    **dependencies: float,
) -> DrawnWalks:
    """Variants of one walk: its dependencies from the planned route, parameters drawn for them, each one simulated.

    Parameters
    ----------
    draws : how many variants
    planner : default: path following with the model's parameters
    standing : speed below which a person stands, which starts and ends the travel time
    dependencies : those that the route does not give, e.g. ``height=1.78`` (m)
    """
    walker = PathFollowing(parameters=model.names) if planner is None else planner
    if tuple(walker.parameters) != model.names:
        raise InputError(f"the planner takes {', '.join(walker.parameters)}, the model draws {', '.join(model.names)}")
    if count_of(draws) < 1:
        raise InputError(f"draws = {draws}: must be at least 1")
    _check_limit(time_limit_s)
    route = walker.route(scene, task, Body() if body is None else body)
    vector = task_vector(model, route, task, **dependencies)
    parameters = model.sample(vector, draws, rng)
    walks = tuple(walker.follow(route, task, values, time_limit_s) for values in parameters)
    threshold = (standing or Standing()).standing_speed_m_s
    times = [np.inf if walk.arrival == Arrival.TIMEOUT else trajectory_travel_time_s(walk, task, threshold) for walk in walks]
    collided = through(union_all(list(scene.obstacles.values())), [walk.positions_m for walk in walks])
    inside = bool(model.inside(vector)[0])
    return DrawnWalks(model.names, model.units, vector, inside, route, parameters, walks, np.array(times), collided)


def _check_limit(time_limit_s: float) -> None:
    if not 0 < time_limit_s < np.inf:
        raise InputError(f"time_limit_s = {time_limit_s}: give a number of seconds above 0")


def travel_time_quantiles(
    model: ProbabilisticModel,
    scene: Scene,
    task: Task,
    levels: Sequence[float] = (0.05, 0.25, 0.5, 0.75, 0.95),
    draws: int = 200,
    rng: np.random.Generator | None = None,
    **settings: Any,
) -> Array:
    """Quantiles of the travel time (s) of one walk, over draws from the model; see :func:`simulate_draws`."""
    return simulate_draws(model, scene, task, draws, rng, **settings).quantiles(levels)
