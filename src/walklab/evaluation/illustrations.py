"""Examples worked out for the figures: one walk, one map, one pass through the run-time procedure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.geometry import curves
from walklab.planning.protocol import Planner
from walklab.steering.models import MotionModel, ProbabilisticModel
from walklab.steering.routes import task_of

Array = NDArray[np.float64]

FINE_STEPS = 81
PROPOSALS = 400


@dataclass(frozen=True)
class Procedure:
    """The run-time procedure for one dependency vector (figure 9).

    Attributes
    ----------
    query : (D,) dependency vector
    neighbours, weights : (k,) entries of the blending space and their weights
    blended : (C,) blended map
    fine_values : values of the first two steering parameters; fine : density over them, the others held at the mode
    held_at : what the others are held at
    accepted, rejected : (n, P) proposals of the rejection sampling
    """

    query: Array
    neighbours: NDArray[np.int64]
    weights: Array
    blended: Array
    fine_values: tuple[Array, Array]
    fine: Array
    held_at: Mapping[str, float]
    accepted: Array
    rejected: Array


def work_through(model: ProbabilisticModel, query: Array, rng: np.random.Generator) -> Procedure:
    """Every step of the run-time procedure for one dependency vector.

    Proposals are uniform in the box, accepted where ``r <= f(x) / bound`` with uniform r, as the sampler does.
    """
    indices, shares = model.blending.neighbours(query[None], model.k, model.weights)
    mode = model.mode(query[None])[0]
    values = [np.linspace(low, high, FINE_STEPS) for low, high in model.space.bounds[:2]]
    plane = np.tile(mode, (FINE_STEPS**2, 1))
    plane[:, : len(values)] = np.stack(np.meshgrid(*values, indexing="ij"), axis=-1).reshape(-1, len(values))
    proposals = rng.uniform(model.space.bounds[:, 0], model.space.bounds[:, 1], (PROPOSALS, len(model.names)))
    density = model.density(query, proposals)
    kept = rng.uniform(0.0, model.upper_bound(query) ** model.exponent, PROPOSALS) <= density
    return Procedure(
        query,
        indices[0],
        shares[0],
        model.blend(query[None])[0],
        (values[0], values[1]),
        model.density(query, plane).reshape(FINE_STEPS, FINE_STEPS),
        dict(zip(model.names[2:], mode[2:].tolist(), strict=True)),
        proposals[kept],
        proposals[~kept],
    )


def most_bent(walks: Sequence[Walk], routes: Mapping[str, Array]) -> int:
    """Index of the walk whose planned route turns most: the one worth looking at."""
    bends = [np.abs(curves.turning_angles(np.asarray(routes[walk.row["walk"]]))).sum() for walk in walks]
    return int(np.argmax(bends))


def simulated_paths(
    walk: Walk,
    route: Array,
    vector: Array,
    models: Mapping[str, MotionModel],
    planner: Planner,
    rng: np.random.Generator,
    time_limit_s: float,
) -> pd.DataFrame:
    """The captured walk (model ``Ref``) and its simulation by each model: DataFrame[model, time_s, x_m, y_m]."""
    frames = [pd.DataFrame({"model": "Ref", "time_s": walk.time_s, "x_m": walk.position_m[:, 0], "y_m": walk.position_m[:, 1]})]
    for name, model in models.items():
        parameters = np.asarray(model.parameters(vector[None], [rng]))[0]
        positions = planner.follow(route, task_of(walk.row), parameters, time_limit_s).positions_m
        time_s = np.arange(len(positions)) * planner.step_s
        frames.append(pd.DataFrame({"model": name, "time_s": time_s, "x_m": positions[:, 0], "y_m": positions[:, 1]}))
    return pd.concat(frames, ignore_index=True)


def example_entries(vectors: Array, count: int = 4) -> NDArray[np.int64]:
    """Entries of a blending space spread over its first dependency: at evenly spaced ranks of it."""
    order = np.argsort(vectors[:, 0], kind="stable")
    return order[np.linspace(0, len(order) - 1, count).round().astype(int)]
