"""P_Stat: the one parameter vector that fits all walks best (section 7.3, after Wolinski et al. 2014)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.planning.protocol import Planner, WalkBatch
from walklab.steering.metrics import Metric
from walklab.steering.space import ParameterSpace
from walklab.steering.suitability import score_walks

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

Array = NDArray[np.float64]

POPULATION = 16  # vectors per parameter of differential evolution; scored side by side, they cost far less than one by one
GENERATIONS = 60
TOLERANCE = 1e-6  # spread of a population's scores, relative, at which it has converged


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
    check_values : best score of every run of differential evolution, which cross-checks the annealing
    spread : per parameter, how far apart the optima of all runs of both kinds lie
    evaluations : number of parameter vectors that were scored
    """

    names: tuple[str, ...]
    optimum: tuple[float, ...]
    value: float
    grid_optimum: tuple[float, ...]
    grid_value: float
    on_edge: tuple[str, ...]
    start_values: tuple[float, ...]
    check_values: tuple[float, ...]
    spread: tuple[float, ...]
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
    checks: int = 0,
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
    maxfun : parameter vectors scored per annealing run
    checks : independent runs of differential evolution (Storn & Price 1997) beside them; they are reported and change nothing

    Raises
    ------
    InputError
        If the planner's parameters are not the space's, or the scores have another shape.
    """
    from scipy.optimize import dual_annealing  # late: half a second of imports, which who only reads a fit need not pay

    if tuple(planner.parameters) != space.names:
        raise InputError(f"space: axes {', '.join(space.names)} are not the planner's parameters {', '.join(planner.parameters)}")
    if starts < 1 or maxfun < 1 or checks < 0:
        raise InputError(f"static fit: starts ({starts}) and maxfun ({maxfun}) must be at least 1, checks ({checks}) at least 0")
    shares = np.ones(len(batch)) if weights is None else np.asarray(weights, dtype=float)
    shares = shares / shares.sum()
    grid = score_walks(planner, batch, space.cells, metric, time_limit_s) if scores is None else np.asarray(scores, dtype=float)
    if grid.shape != (len(batch), len(space.cells)):
        raise InputError(f"static fit: scores {grid.shape} do not fit {len(batch)} walks and {len(space.cells)} cells")

    def mean_scores(parameters: Array) -> Array:
        return np.asarray(shares @ score_walks(planner, batch, np.ascontiguousarray(parameters.T), metric, time_limit_s))

    def mean_score(parameters: Array) -> float:
        return float(mean_scores(parameters[:, None])[0])

    runs = [dual_annealing(mean_score, space.bounds, maxfun=maxfun, rng=child) for child in rng.spawn(starts)]
    checked = [_evolved(mean_scores, space, child) for child in rng.spawn(checks)]
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
        # Scored as the annealing scores: a population is scored in single precision.
        tuple(mean_score(run.x) for run in checked),
        tuple(float(x) for x in np.ptp([run.x for run in (*runs, *checked)], axis=0)),
        int(sum(run.nfev for run in runs) + sum(run.nfev * POPULATION * len(space.names) for run in checked)),
    )


def _evolved(mean_scores: Callable[[Array], Array], space: ParameterSpace, rng: np.random.Generator) -> OptimizeResult:
    from scipy.optimize import differential_evolution

    return differential_evolution(
        mean_scores,
        space.bounds,
        popsize=POPULATION,
        maxiter=GENERATIONS,
        tol=TOLERANCE,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=rng,
    )
