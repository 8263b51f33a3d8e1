"""Walks made by the planner itself from a known distribution of its parameters: no captured walks, a test of the method.

Whatever the method makes of such walks can be held against the distribution that they were drawn from.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.stats import truncnorm

from walklab.capture.training import Configuration
from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.geometry import curves
from walklab.geometry.scene import Body, State, Task
from walklab.geometry.standing import Standing
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.protocol import Planner
from walklab.steering.dependencies import dependency_vectors

Array = NDArray[np.float64]

HEIGHT_M, HEIGHT_SD_M = 1.78, 0.07  # as in 4.2; no parameter depends on it here


@dataclass(frozen=True)
class KnownDistribution:
    r"""Independent normal distributions :math:`p_i | d \sim N(\mu_i + l_i (l - 2.5 m) + c_i c, s_i)`.

    l is the length and c the curvature of the planned route; the distributions are cut off at the ends of the parameter space.

    Attributes
    ----------
    means, per_length, per_curvature, sds : (P,) of each parameter, in its unit (per m, times m)
    bounds : (P, 2) of the parameter space
    """

    means: Array
    per_length: Array
    per_curvature: Array
    sds: Array
    bounds: Array

    def centres(self, length_m: ArrayLike, curvature_1_m: ArrayLike) -> Array:
        """Means before truncation, (..., P)."""
        length, curvature = (np.asarray(values, dtype=float)[..., None] for values in (length_m, curvature_1_m))
        return np.asarray(self.means + self.per_length * (length - 2.5) + self.per_curvature * curvature)

    def _frozen(self, centres: Array) -> Any:  # scipy's frozen distributions have no public type
        low, high = ((end - centres) / self.sds for end in self.bounds.T)
        return truncnorm(low, high, loc=centres, scale=self.sds)

    def draw(self, length_m: ArrayLike, curvature_1_m: ArrayLike, rng: np.random.Generator) -> Array:
        """One parameter vector for each of W tasks, (W, P)."""
        centres = self.centres(length_m, curvature_1_m)
        return np.asarray(self._frozen(centres).ppf(rng.random(centres.shape)))

    def cdf(self, length_m: float, curvature_1_m: float, points: Array) -> Array:
        """Distribution function of every parameter at its column of (L, P) points, (L, P)."""
        return np.asarray(self._frozen(self.centres(length_m, curvature_1_m)).cdf(points))

    def pdf(self, length_m: float, curvature_1_m: float, points: Array) -> Array:
        """Density of every parameter at its column of (L, P) points, (L, P)."""
        return np.asarray(self._frozen(self.centres(length_m, curvature_1_m)).pdf(points))


def known_distribution(parameters: Mapping[str, Mapping[str, float]], names: Sequence[str], bounds: Array) -> KnownDistribution:
    """From ``{v: {mean, sd, per_length, per_curvature}, ...}``, one entry for each parameter of the space.

    Raises
    ------
    InputError
        If the entries are not those of the space.
    """
    if set(parameters) != set(names):
        raise InputError(f"recover_distribution.known: has {sorted(parameters)}, the space {sorted(names)}; give one each")
    means, per_length, per_curvature, sds = (
        np.array([parameters[name][key] for name in names], dtype=float) for key in ("mean", "per_length", "per_curvature", "sd")
    )
    return KnownDistribution(means, per_length, per_curvature, sds, np.asarray(bounds, dtype=float))


@dataclass(frozen=True)
class PlannerWalks:
    """W walks made by the planner.

    Attributes
    ----------
    walks, routes : as captured ones would be
    vectors : W run-time dependencies, columns length, curvature and height
    tasks : (W,) name of each walk's configuration
    parameters : (W, P) true parameters
    """

    walks: list[Walk]
    routes: dict[str, Array]
    vectors: pd.DataFrame
    tasks: NDArray[np.str_]
    parameters: Array


def walk_by_planner(
    count: int,
    configurations: Sequence[Configuration],
    known: KnownDistribution,
    planner: Planner,
    body: Body,
    standing: Standing,
    time_limit_s: float,
    participants: int,
    rng: np.random.Generator,
) -> PlannerWalks:
    """Let the planner walk the tasks of experiment 1 in turn, each time with parameters drawn from the known distribution.

    Every frame is kept, without noise: the best case for the method. Nobody walked, so ``participants`` only numbers the
    walks in turn, for what leaves one out.
    """
    found = [planner.route(one.plan.scene, _task(one), body) for one in configurations]
    turn = np.arange(count) % len(configurations)
    heights = rng.normal(HEIGHT_M, HEIGHT_SD_M, count)
    names = [f"planner/{number:05d}" for number in range(count)]
    table = pd.DataFrame({"walk": names, "height_m": heights, "start_speed_m_s": 0.0})
    routes = {name: found[task] for name, task in zip(names, turn, strict=True)}
    vectors = _vectors(table, routes, turn)
    parameters = known.draw(vectors["length"], vectors["curvature"], rng)
    walks = []
    for number, name in enumerate(names):
        task = _task(configurations[number % len(configurations)])
        trajectory = planner.follow(routes[name], task, parameters[number], time_limit_s)
        row = table.iloc[number].to_dict() | {"participant": f"P{number % participants:02d}", "end_speed_m_s": 0.0}
        row |= {"duration_s": trajectory_travel_time_s(trajectory, task, standing.standing_speed_m_s)}
        row |= {"length_m": curves.length(trajectory.positions_m)}
        ends = zip(("start_x_m", "start_y_m", "end_x_m", "end_y_m"), (*task.start.position_m, *task.end.position_m), strict=True)
        time_s = np.arange(len(trajectory.positions_m), dtype=float) * planner.step_s
        walks.append(Walk(pd.Series(row | dict(ends)), time_s, trajectory.positions_m))
    return PlannerWalks(walks, routes, vectors, np.array([configurations[int(task)].name for task in turn]), parameters)


def _task(configuration: Configuration) -> Task:
    start, end = (State((float(at[0]), float(at[1])), None, 0.0) for at in (configuration.start_m, configuration.end_m))
    return Task(start, end)


def _vectors(table: pd.DataFrame, routes: Mapping[str, Array], turn: NDArray[np.int64]) -> pd.DataFrame:
    """Run-time dependencies; the walks of one task share their route, so it is measured once."""
    tasks = np.unique(turn)
    first = {task: int(np.flatnonzero(turn == task)[0]) for task in tasks}
    measured = dependency_vectors(table.iloc[list(first.values())], routes, ["length", "curvature"])
    columns = {name: measured[name].to_numpy()[np.searchsorted(tasks, turn)] for name in measured}
    return pd.DataFrame(columns | {"height": table["height_m"].to_numpy()})
