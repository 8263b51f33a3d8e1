"""Does the method recover a known p(p|d)? What it makes of the planner's own walks against what they were drawn from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats
from scipy.spatial.distance import cdist

from walklab.evaluation.calibration import CANDIDATES, best_value, candidate_table, choose_walks, evidence_of
from walklab.evaluation.planner_walks import KnownDistribution, PlannerWalks
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.randomness import generator
from walklab.steering.models import ProbabilisticModel
from walklab.steering.routes import pack
from walklab.steering.sharpness import cell_volumes
from walklab.steering.space import Axis, ParameterSpace
from walklab.steering.suitability import score_walks
from walklab.steering.training import TrainingSettings, train

Array = NDArray[np.float64]

LITERAL, BEST = "P_Prob (literal)", "P_Prob (exponent nearest to the truth)"
# Not P_Prob (calibrated), whose exponent follows a law of the dependencies that is asked to cover the times of new people: here
# the question is how near the maps come to the known distribution, and what the scores alone choose stands for the learned ones.
BY_SCORES = "P_Prob (one exponent by the scores)"
BEFORE = "P_Prob, sharpened before blending"
NEIGHBOURS, PERFECT, UNIFORM = "true parameters of the neighbours", "perfect sample", "uniform"

EVIDENCE_WALKS = 200  # of which the exponent is learned at most
TIE_S = 1e-6  # differences of the metric below this are rounding
BINS = 38  # of the drawn densities
REPETITIONS = 3  # with other walks


@dataclass(frozen=True)
class Setup:
    """What every recovery has in common.

    Attributes
    ----------
    planner, standing, time_limit_s, metric : as for captured walks
    settings : of the model; ``count`` is not used: nothing is up-sampled
    tasks : names of the configurations at which the densities are compared, at the mean height of the walks
    draws : from each density
    """

    planner: Planner
    standing: Standing
    time_limit_s: float
    metric: str
    settings: TrainingSettings
    tasks: Sequence[str]
    draws: int


def energy_distance(first: Array, second: Array) -> float:
    r"""Energy distance :math:`\sqrt{2 E|X - Y| - E|X - X'| - E|Y - Y'|}` of two samples, (n, P) and (m, P).

    Székely & Rizzo 2013, J. Stat. Plan. Inference 143; in one dimension it is ``scipy.stats.energy_distance``.
    """
    squared = 2 * cdist(first, second).mean() - cdist(first, first).mean() - cdist(second, second).mean()
    return float(np.sqrt(max(squared, 0.0)))


def recover(
    made: PlannerWalks, scores: Array, space: ParameterSpace, known: KnownDistribution, setup: Setup, rng: np.random.Generator
) -> tuple[pd.DataFrame, dict[str, dict[str, Array]]]:
    """Train on the planner's walks, and hold the densities at some tasks against the known ones.

    Parameters
    ----------
    scores : (W, C) metric of the walks over the cells of ``space``

    Returns
    -------
    DataFrame[task, model, exponent, measure, parameter, value]; ``measure``: ``ks`` (Kolmogorov-Smirnov distance of one
    parameter's marginal), ``bias`` (mean minus true mean, in true standard deviations), ``spread`` (standard deviation over the
    true one), ``energy`` (energy distance of all parameters together, each in units of its true standard deviation); and the
    draws: task -> model -> (draws, P)
    """
    people = [str(walk.row["participant"]) for walk in made.walks]
    # ASSUME: Nothing is up-sampled here: the tasks are spread evenly by design, and blends would only widen what is compared.
    settings = replace(setup.settings, count=None, basis="multilinear", k=min(setup.settings.k, len(people)))
    model = train(scores, made.vectors, people, space, settings, rng)
    by_scores = learned_exponent(made, scores, space, model, setup, rng)
    rows: list[dict[str, object]] = []
    drawn: dict[str, dict[str, Array]] = {}
    by_exponent: dict[float, list[float]] = {exponent: [] for exponent in sorted({*CANDIDATES["exponent"][::2], by_scores})}
    for task in setup.tasks:
        at = made.vectors[made.tasks == task]
        where = float(at["length"].iloc[0]), float(at["curvature"].iloc[0])
        vector = np.array([*where, float(made.vectors["height"].mean())])
        everywhere = np.full(setup.draws, where[0]), np.full(setup.draws, where[1])
        truth = known.draw(*everywhere, rng)
        drawn[task] = draws_of(model, scores, made, vector, by_scores, setup.draws, rng)
        drawn[task][PERFECT] = known.draw(*everywhere, rng)
        scale = truth.std(axis=0)
        for exponent, distances in by_exponent.items():
            sharp = replace(model, exponent=exponent).sample(vector, setup.draws, rng)
            distances.append(energy_distance(sharp / scale, truth / scale))
        best = min(by_exponent, key=lambda exponent: by_exponent[exponent][-1])
        drawn[task][BEST] = replace(model, exponent=best).sample(vector, setup.draws, rng)
        exponents = {LITERAL: 1.0, BY_SCORES: by_scores, BEST: best}
        for name, points in drawn[task].items():
            found = compare(points, truth, known, where, space.names)
            rows += [{"task": task, "model": name, "exponent": exponents.get(name, np.nan)} | row for row in found]
    return pd.DataFrame(rows), drawn


def draws_of(
    model: ProbabilisticModel,
    scores: Array,
    made: PlannerWalks,
    vector: Array,
    by_scores: float,
    count: int,
    rng: np.random.Generator,
) -> dict[str, Array]:
    """(count, P) draws from each reading of the maps, and from what bounds them on both sides."""
    bounds = model.space.bounds
    near, shares = (part[0] for part in model.blending.neighbours(vector[None], model.k, model.weights))
    chosen = rng.choice(near, count, p=shares / shares.sum())
    return {
        UNIFORM: rng.uniform(bounds[:, 0], bounds[:, 1], (count, len(bounds))),
        LITERAL: replace(model, exponent=1.0).sample(vector, count, rng),
        BY_SCORES: replace(model, exponent=by_scores).sample(vector, count, rng),
        BEFORE: best_cells(scores[chosen], model.space, rng),
        NEIGHBOURS: made.parameters[chosen],
    }


def best_cells(scores: Array, space: ParameterSpace, rng: np.random.Generator) -> Array:
    """A point in the best cell of each map, (W, P): uniform over it, or over all of the best where several tie."""
    ties = scores <= scores.min(axis=1, keepdims=True) + TIE_S
    # Of exponential times with rates in proportion to the volumes the first is any cell's with the share of its volume.
    cells = np.where(ties, rng.standard_exponential(scores.shape) / cell_volumes(space), np.inf).argmin(axis=1)
    steps = space.to_unit(space.cells[cells])
    low, high = np.maximum(steps - 0.5, 0), np.minimum(steps + 0.5, np.array(space.shape) - 1.0)
    return space.from_unit(rng.uniform(low, high))


def compare(
    points: Array, truth: Array, known: KnownDistribution, where: tuple[float, float], names: Sequence[str]
) -> list[dict[str, object]]:
    """Measures of one sample against the known distribution at one task."""
    rows: list[dict[str, object]] = []
    scale = truth.std(axis=0)
    ordered = np.sort(points, axis=0)
    levels = known.cdf(*where, ordered)
    for axis, name in enumerate(names):
        values = {
            "ks": stats.kstest(levels[:, axis], "uniform").statistic,
            "bias": (points[:, axis].mean() - truth[:, axis].mean()) / scale[axis],
            "spread": points[:, axis].std() / scale[axis],
        }
        rows += [{"measure": measure, "parameter": name, "value": float(value)} for measure, value in values.items()]
    return [*rows, {"measure": "energy", "parameter": "all", "value": energy_distance(points / scale, truth / scale)}]


def learned_exponent(
    made: PlannerWalks, scores: Array, space: ParameterSpace, model: ProbabilisticModel, setup: Setup, rng: np.random.Generator
) -> float:
    """The one exponent with the smallest loss, leave-one-participant-out; no coverage is asked for."""
    people = [str(walk.row["participant"]) for walk in made.walks]
    most = max(EVIDENCE_WALKS // len(set(people)), 1)
    evidence = evidence_of(
        made.walks,
        made.routes,
        made.vectors.to_numpy(dtype=float),
        scores,
        setup.settings.normalisation,
        model.blending,
        choose_walks(people, most, rng),
        setup.planner,
        space,
        setup.standing,
        setup.time_limit_s,
        model.k,
        model.weights,
    )
    return best_value(candidate_table(evidence, {"exponent": CANDIDATES["exponent"]})[0])


def some_walks(made: PlannerWalks, rows: NDArray[np.int64]) -> PlannerWalks:
    """Some of the walks."""
    walks = [made.walks[row] for row in rows]
    return PlannerWalks(
        walks, made.routes, made.vectors.iloc[rows].reset_index(drop=True), made.tasks[rows], made.parameters[rows]
    )


def recover_all(
    made: PlannerWalks,
    space: ParameterSpace,
    sizes: Sequence[int],
    resolutions: Sequence[int],
    known: KnownDistribution,
    setup: Setup,
    seed: int,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Recovery against the number of walks on the study's grid, and against the grid's resolution.

    Small samples are repeated with other walks, as far as there are any. Grids are compared on the last number of walks but one.

    Parameters
    ----------
    made : as many walks as the largest size
    resolutions : values of each parameter

    Returns
    -------
    DataFrame[walks, resolution, repetition, ...] as of :func:`recover`, and the densities of the case in which both series meet
    """
    meeting = sorted(sizes)[-2:][0]
    own = space.shape[0]
    cases = [(own, size) for size in sizes] + [(resolution, meeting) for resolution in resolutions if resolution != own]
    tables, shown = [], pd.DataFrame()
    for resolution in sorted({resolution for resolution, _ in cases}):
        grid = space if resolution == own else resampled(space, resolution)
        here = [size for at, size in cases if at == resolution]
        scores = score_planner_walks(some_walks(made, np.arange(max(here))), grid, setup)
        for size in here:
            for repetition in range(min(REPETITIONS, max(here) // size)):
                rows = np.arange(size) + repetition * size
                rng = generator(seed, "recover_distribution", resolution, size, repetition)
                table, drawn = recover(some_walks(made, rows), scores[rows], grid, known, setup, rng)
                tables.append(table.assign(walks=size, resolution=resolution, repetition=repetition))
                if (resolution, size, repetition) == (own, meeting, 0):
                    shown = densities(drawn, known, made, grid)
    found = pd.concat(tables, ignore_index=True)
    first = ["walks", "resolution", "repetition"]
    return found[[*first, *(name for name in found if name not in first)]], shown


def resampled(space: ParameterSpace, count: int) -> ParameterSpace:
    """The same ranges with another number of values on each axis."""
    return ParameterSpace(
        tuple(
            Axis(axis.name, axis.unit, tuple(np.linspace(axis.values[0], axis.values[-1], count).tolist())) for axis in space.axes
        )
    )


def score_planner_walks(made: PlannerWalks, space: ParameterSpace, setup: Setup) -> Array:
    """(W, C) metric of every walk and cell."""
    return score_walks(setup.planner, pack(made.walks, made.routes, setup.planner), space.cells, setup.metric, setup.time_limit_s)


def densities(
    drawn: Mapping[str, Mapping[str, Array]], known: KnownDistribution, made: PlannerWalks, space: ParameterSpace
) -> pd.DataFrame:
    """Histograms of the draws beside the known densities. DataFrame[task, model, parameter, at (middle of the bin), density]."""
    rows: list[dict[str, object]] = []
    for task, by_model in drawn.items():
        at = made.vectors[made.tasks == task].iloc[0]
        for axis, name in enumerate(space.names):
            low, high = space.bounds[axis]
            edges = np.linspace(low, high, BINS + 1)
            middles = (edges[1:] + edges[:-1]) / 2
            everywhere = np.repeat(middles[:, None], len(space.names), axis=1)
            found = {"known": known.pdf(at["length"], at["curvature"], everywhere)[:, axis]}
            found |= {model: np.histogram(points[:, axis], edges, density=True)[0] for model, points in by_model.items()}
            rows += [
                {"task": task, "model": model, "parameter": name, "at": middle, "density": value}
                for model, values in found.items()
                for middle, value in zip(middles, values, strict=True)
            ]
    return pd.DataFrame(rows)
