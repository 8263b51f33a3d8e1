"""Trials: every captured walk re-simulated once with every motion model (Agethen et al. 2017, section 7.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import shapely
from numpy.typing import ArrayLike, NDArray

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.geometry.collisions import through
from walklab.geometry.scene import Scene, Task
from walklab.geometry.standing import Standing
from walklab.planning.batch import resample_time
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.protocol import Arrival, Planner, Trajectory
from walklab.randomness import generator
from walklab.steering.metrics import Metric, metric_named
from walklab.steering.models import MotionModel
from walklab.steering.routes import task_of
from walklab.steering.space import ParameterSpace
from walklab.steering.suitability import standing_at_end

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def simulate_trials(
    models: Mapping[str, MotionModel],
    planner: Planner,
    walks: Sequence[Walk],
    routes: Mapping[str, Array],
    vectors: ArrayLike,
    standing: Standing,
    time_limit_s: float,
    metric: str | Metric,
    seed: int,
    replicate: int,
    inside: Flags | None = None,
    stream: str | None = None,
    space: ParameterSpace | None = None,
    scenes: Mapping[str, Scene] | None = None,
) -> pd.DataFrame:
    """Simulate every walk with every model and compare the travel times.

    ``dt = T_simulated - T_captured``, both from the last standing to the first standing
    frame. A probabilistic model draws one parameter vector per walk (section 7.3).

    Parameters
    ----------
    models : name -> model
    routes : walk id -> (n, 2) planned route, metres
    vectors : (W, D) run-time dependency vectors, in the order of ``walks``
    metric : name of a registered metric of the trajectory error, or one of your own
    inside : (W,) whether each vector lies in the domain of validity; by default asked of the first model that knows
    stream : the name that parameters are drawn under instead of each model's own, so that variants of
        one model see common random numbers
    space : of the steering parameters, to tell which vectors lie on its border
    scenes : scene name -> scene, to tell which simulated walks go through an obstacle

    Returns
    -------
    DataFrame, a row per model and walk: walk, participant, configuration, model, one column per
    parameter, captured_s, simulated_s, dt_s, abs_dt_s, arrival (``arrived``, ``passed``, ``timeout``),
    metric_<unit> (metric_s for m_Euclid), inside_hull, on_edge (a parameter lies on the border of the space; False
    without a space), collided (the centre of the body crosses an obstacle that is not grown by the body; False without
    scenes).
    A walk that reaches its time limit keeps its row, and ``simulated_s`` is the time limit;
    one that passed its end has the time of its movement.

    Raises
    ------
    InputError
        If a walk has no route or an unknown scene, the number of vectors differs from the number of walks, or the
        parameters of a model or of the space are not the planner's.
    """
    asked = np.asarray(vectors, dtype=float)
    if len(asked) != len(walks):
        raise InputError(
            f"trials: {len(asked)} dependency vectors for {len(walks)} walks; compute them from the same walks table"
        )
    names = [str(walk.row["walk"]) for walk in walks]
    if missing := [name for name in names if name not in routes]:
        raise InputError(f"trials: no route for walk {missing[0]} ({len(missing)} in all); plan the routes again")
    if inside is None:
        inside = _inside_hull(models, asked)
    tasks = [task_of(walk.row) for walk in walks]
    captured = [resample_time(walk.time_s, walk.position_m, planner.step_s) for walk in walks]
    chosen = metric_named(metric, standing) if isinstance(metric, str) else metric
    if space is not None and space.names != tuple(planner.parameters):
        raise InputError(f"trials: axes {', '.join(space.names)} are not the planner's {', '.join(planner.parameters)}")
    obstacles = None if scenes is None else _obstacles(walks, scenes)
    nowhere = np.zeros(len(walks), dtype=bool)
    frames = []
    for model_name, model in models.items():
        if model.names != tuple(planner.parameters):
            raise InputError(
                f"trials: {model_name} gives {', '.join(model.names)}, the planner takes {', '.join(planner.parameters)}"
            )
        generators = [generator(seed, replicate, "trial", stream or model_name, name) for name in names]
        parameters = np.asarray(model.parameters(asked, generators), dtype=float)
        outcomes, paths = [], []
        for name, walk, task, positions_m, values in zip(names, walks, tasks, captured, parameters, strict=True):
            trajectory = planner.follow(routes[name], task, values, time_limit_s)
            duration_s = _simulated_s(trajectory, task, standing, time_limit_s)
            error = _trajectory_error(chosen, positions_m, trajectory.positions_m, planner.step_s, float(walk.row["length_m"]))
            outcomes.append((duration_s, trajectory.arrival.name.lower(), error))
            paths.append(trajectory.positions_m)
        frame = _frame(model_name, walks, planner.parameters, parameters, outcomes, inside, f"metric_{chosen.unit}")
        frame["on_edge"] = nowhere if space is None else np.asarray(space.on_edge(parameters).any(axis=1))
        frame["collided"] = nowhere if obstacles is None else _collided(paths, *obstacles)
        frames.append(frame)
    return pd.concat(frames, ignore_index=True)


def _simulated_s(trajectory: Trajectory, task: Task, standing: Standing, time_limit_s: float) -> float:
    if trajectory.arrival == Arrival.TIMEOUT:
        return time_limit_s
    return trajectory_travel_time_s(trajectory, task, standing.standing_speed_m_s)


def _trajectory_error(metric: Metric, captured: Array, simulated: Array, step_s: float, length_m: float) -> float:
    frames = len(captured) if metric.horizon == "captured" else max(len(captured), len(simulated))
    error = metric(standing_at_end(captured, frames), standing_at_end(simulated, frames)[None], step_s, length_m)
    return float(np.asarray(error).ravel()[0])


def _obstacles(walks: Sequence[Walk], scenes: Mapping[str, Scene]) -> tuple[dict[str, shapely.Geometry], NDArray[np.str_]]:
    """The obstacles of each scene as one prepared geometry, and the scene of each walk."""
    names = np.array([str(walk.row["scene"]) for walk in walks], dtype=str)
    for walk, name in zip(walks, names, strict=True):
        if name not in scenes:
            raise InputError(f"walk {walk.row['walk']}: column scene: '{name}' is not among the plan views {sorted(scenes)}")
    obstacles = {str(name): shapely.union_all(list(scenes[str(name)].obstacles.values())) for name in np.unique(names)}
    return obstacles, names


def _collided(paths: Sequence[Array], obstacles: Mapping[str, shapely.Geometry], names: NDArray[np.str_]) -> Flags:
    """Whether each path has a part of its length inside the obstacles of its scene; touching an outline is none."""
    collided = np.zeros(len(paths), dtype=bool)
    for name, geometry in obstacles.items():
        chosen = np.flatnonzero(names == name)
        collided[chosen] = through(geometry, [paths[row] for row in chosen.tolist()])
    return collided


def _inside_hull(models: Mapping[str, MotionModel], vectors: Array) -> Flags:
    for model in models.values():
        knows = getattr(model, "inside", None)
        if knows is not None:
            return np.asarray(knows(vectors), dtype=bool)
    return np.ones(len(vectors), dtype=bool)


def _frame(
    model: str,
    walks: Sequence[Walk],
    parameter_names: Sequence[str],
    parameters: Array,
    outcomes: Sequence[tuple[float, str, float]],
    inside: Flags,
    metric_column: str,
) -> pd.DataFrame:
    frame = pd.DataFrame({key: [str(walk.row[key]) for walk in walks] for key in ("walk", "participant", "configuration")})
    frame["model"] = model
    for column, name in enumerate(parameter_names):
        frame[name] = parameters[:, column]
    frame["captured_s"] = np.array([float(walk.row["duration_s"]) for walk in walks])
    frame["simulated_s"] = np.array([outcome[0] for outcome in outcomes])
    # Times are multiples of 1/60 and 1/120 s: without rounding, equal errors differ by float noise.
    frame["dt_s"] = (frame["simulated_s"] - frame["captured_s"]).round(9)
    frame["abs_dt_s"] = frame["dt_s"].abs()
    frame["arrival"] = [outcome[1] for outcome in outcomes]
    frame[metric_column] = np.array([outcome[2] for outcome in outcomes])
    frame["inside_hull"] = inside
    return frame
