"""The error that the grid of parameters leaves to every model: each walk simulated with the best cell of its own map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.evaluation.trials import simulate_trials
from walklab.geometry.scene import Scene
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.steering.metrics import Metric, metric_named
from walklab.steering.routes import pack
from walklab.steering.space import ParameterSpace
from walklab.steering.suitability import score_walks

Array = NDArray[np.float64]

BEST_CELL = "best cell"


@dataclass(frozen=True)
class _Given:
    """A model that has its parameters already, one vector per walk."""

    names: tuple[str, ...]
    rows: Array

    def parameters(self, vectors: ArrayLike, generators: Sequence[np.random.Generator] | None = None) -> Array:
        return self.rows


def grid_floor(
    planner: Planner,
    walks: Sequence[Walk],
    routes: Mapping[str, Array],
    space: ParameterSpace,
    standing: Standing,
    time_limit_s: float,
    metric: str | Metric,
    scores: Array | None = None,
    scenes: Mapping[str, Scene] | None = None,
) -> pd.DataFrame:
    """Simulate every walk with the best cell of its own suitability map.

    The cell is chosen from the captured walk itself, so this is no forecast but an error floor: what remains of the
    error when nothing is wrong but that parameters come in grid steps and the planner is not a person. It is the floor
    of the metric; another cell may have the better travel time by chance.

    Parameters
    ----------
    scores : (W, C) raw scores of the walks over ``space``, if they are known already; else they are computed
    scenes : as for :func:`walklab.evaluation.trials.simulate_trials`, like the rest

    Returns
    -------
    DataFrame as from :func:`walklab.evaluation.trials.simulate_trials`, of one model ``best cell``; no dependencies
    are asked for, so ``inside_hull`` is True in every row

    Raises
    ------
    InputError
        If a walk has no route, or the scores do not fit walks and cells.
    """
    if missing := [str(walk.row["walk"]) for walk in walks if str(walk.row["walk"]) not in routes]:
        raise InputError(f"grid floor: no route for walk {missing[0]} ({len(missing)} in all); plan the routes again")
    chosen = metric_named(metric, standing) if isinstance(metric, str) else metric
    if scores is None:
        scores = score_walks(planner, pack(walks, routes, planner), space.cells, chosen, time_limit_s)
    if scores.shape != (len(walks), len(space.cells)):
        raise InputError(f"grid floor: scores {scores.shape} do not fit {len(walks)} walks and {len(space.cells)} cells")
    best = _Given(space.names, space.cells[np.argmin(scores, axis=1)])
    nothing = np.empty((len(walks), 0))
    return simulate_trials(
        {BEST_CELL: best},
        planner,
        walks,
        routes,
        nothing,
        standing,
        time_limit_s,
        chosen,
        seed=0,  # nothing is drawn
        replicate=0,
        space=space,
        scenes=scenes,
    )
