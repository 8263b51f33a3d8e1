"""P_Stat: the one parameter vector that fits all walks best (section 7.3, after Wolinski et al. 2014)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import dual_annealing

from walklab.errors import InputError
from walklab.planning.protocol import Planner, WalkBatch
from walklab.steering.metrics import Metric
from walklab.steering.space import ParameterSpace
from walklab.steering.suitability import score_walks

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StaticFit:
    """Result of the annealing and of its check on the grid.

    Attributes
    ----------
    names : of the steering parameters
    optimum, value : best vector found in the continuous box and its mean score
    grid_optimum, grid_value : best cell of the grid and its mean score
    on_edge : parameters whose optimum lies on the border of the box
    start_values : best score of every annealing run
    evaluations : number of parameter vectors that were scored
    """

    names: tuple[str, ...]
    optimum: tuple[float, ...]
    value: float
    grid_optimum: tuple[float, ...]
    grid_value: float
    on_edge: tuple[str, ...]
    start_values: tuple[float, ...]
    evaluations: int


def fit_static(
    planner: Planner,
    batch: WalkBatch,
    space: ParameterSpace,
    rng: np.random.Generator,
    *,
    scores: ArrayLike | None = None,
    metric: str | Metric = "euclid",
    weights: ArrayLike | None = None,
    starts: int = 1,
    maxfun: int = 1000,
    time_limit_s: float = 60.0,
) -> StaticFit:
    """Minimise the mean score of all walks over the continuous box by simulated annealing.

    Parameters
    ----------
    planner, batch, metric, time_limit_s : as :func:`score_walks`
    space : the box, and the grid of the check
    rng : drives the annealing
    scores : (W, C) raw scores of the grid, if they are known already; else they are computed
    weights : (W,) weight of each walk in the mean; default all the same
    starts : independent annealing runs, the best of which counts
    maxfun : parameter vectors scored per run

    Raises
    ------
    InputError
        If the planner's parameters are not the space's, or the scores have another shape.
    """
    if tuple(planner.parameters) != space.names:
        raise InputError(f"space: axes {', '.join(space.names)} are not the planner's parameters {', '.join(planner.parameters)}")
    if starts < 1 or maxfun < 1:
        raise InputError(f"static fit: starts ({starts}) and maxfun ({maxfun}) must be at least 1")
    shares = np.ones(len(batch)) if weights is None else np.asarray(weights, dtype=float)
    shares = shares / shares.sum()
    grid = score_walks(planner, batch, space.cells, metric, time_limit_s) if scores is None else np.asarray(scores, dtype=float)
    if grid.shape != (len(batch), len(space.cells)):
        raise InputError(f"static fit: scores {grid.shape} do not fit {len(batch)} walks and {len(space.cells)} cells")

    def mean_score(parameters: Array) -> float:
        return float(shares @ score_walks(planner, batch, parameters[None, :], metric, time_limit_s)[:, 0])

    runs = [dual_annealing(mean_score, space.bounds, maxfun=maxfun, rng=child) for child in rng.spawn(starts)]
    best = min(runs, key=lambda run: run.fun)
    mean_map = shares @ grid
    cell = int(np.argmin(mean_map))
    edges = space.on_edge(best.x)
    return StaticFit(
        space.names,
        tuple(float(x) for x in best.x),
        float(best.fun),
        tuple(float(x) for x in space.cells[cell]),
        float(mean_map[cell]),
        tuple(name for name, edge in zip(space.names, edges, strict=True) if edge),
        tuple(float(run.fun) for run in runs),
        int(sum(run.nfev for run in runs)),
    )
