"""The study of one specification in one process: the same calls as the stages of the DAG, with the same random numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.evaluation.ablations import ablated_models, ablation_table
from walklab.evaluation.baselines import levels
from walklab.evaluation.calibration import CANDIDATES, MEMBERS, candidate_table, choose_walks, evidence_of
from walklab.evaluation.comparison import compare_models
from walklab.evaluation.forecasts import CALIBRATED, STATIC, Forecast, sharpened
from walklab.evaluation.grid_scores import grid_quantiles
from walklab.evaluation.learned_baselines import with_residuals
from walklab.evaluation.score_tables import walk_scores
from walklab.evaluation.simulated_times import travel_times
from walklab.evaluation.statistics import by_dataset
from walklab.evaluation.tracing import trace_walks
from walklab.evaluation.trials import simulate_trials
from walklab.geometry.scene import Body, Scene
from walklab.geometry.standing import Standing
from walklab.multiverse.choices import Choices
from walklab.multiverse.population import Population
from walklab.planning.protocol import Planner
from walklab.planning.registry import make_planner
from walklab.randomness import generator
from walklab.steering.dependencies import dependency_vectors
from walklab.steering.metrics import metric_named
from walklab.steering.models import AdaptiveModel, MotionModel, ProbabilisticModel, StaticModel
from walklab.steering.routes import find_routes, pack
from walklab.steering.sharpness import SharpnessLaw, cell_volumes
from walklab.steering.space import ParameterSpace
from walklab.steering.static_fit import StaticFit, fit_static
from walklab.steering.suitability import score_walks
from walklab.steering.training import TrainingSettings, train

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StudySettings:
    """What all specifications share.

    Attributes
    ----------
    space : of the steering parameters
    planner_name, step_s, planner_options, time_limit_s : of the planner; the choices override options
    scenes : every plan view by its name, ``open`` among them
    dependencies, curvature_scale_m, route_sigma_samples : of the dependency vectors
    training : of the model; the choices override some
    static_evaluations, static_starts : of P_Stat's annealing
    calibration_walks : training walks of each participant that the sharpness is learned from
    bootstraps : of the intervals
    """

    space: ParameterSpace
    planner_name: str
    step_s: float
    planner_options: Mapping[str, Any]
    time_limit_s: float
    scenes: Mapping[str, Scene]
    body: Body
    standing: Standing
    dependencies: tuple[str, ...]
    curvature_scale_m: float
    route_sigma_samples: float
    training: TrainingSettings
    static_evaluations: int
    static_starts: int
    calibration_walks: int
    bootstraps: int
    seed: int
    replicate: int


@dataclass(frozen=True)
class Study:
    """Tables under the names that the claims read, scores by walk and scenario, and what was learned."""

    tables: dict[str, pd.DataFrame]
    scores: dict[str, pd.DataFrame]
    static: StaticFit
    exponent: float


@dataclass(frozen=True)
class _Walks:
    """Walks with their routes and run-time dependencies."""

    walks: list[Walk]
    routes: dict[str, Array]
    vectors: Array

    @property
    def participants(self) -> list[str]:
        return [str(walk.row["participant"]) for walk in self.walks]


def planner_of(choices: Choices, settings: StudySettings) -> Planner:
    """The planner under these choices."""
    options = {**settings.planner_options, "turn_law": choices.turn_law, "braking": choices.braking, "ends_at": choices.ends_at}
    return make_planner(settings.planner_name, settings.space.names, settings.step_s, options)


def training_of(choices: Choices, settings: StudySettings) -> TrainingSettings:
    """The settings of the model under these choices."""
    multilinear = choices.interpolation == "multilinear"
    return replace(
        settings.training,
        normalisation=choices.normalisation,
        weights=choices.weights,
        scaling=choices.scaling,
        basis="multilinear" if multilinear else "rbf",
        kernel=settings.training.kernel if multilinear else choices.interpolation,  # type: ignore[arg-type]
    )


def run_study(population: Population, choices: Choices, settings: StudySettings, ablate: bool = False) -> Study:
    """From walks to the tables that the claims are held against.

    Parameters
    ----------
    ablate : also the sub-models of section 8.1, which cost more than all the rest
    """
    planner = planner_of(choices, settings)
    known, indexed = _planned(population.training, planner, choices, settings)
    batch = pack(known.walks, known.routes, planner)
    metric = metric_named(choices.metric, settings.standing)
    score = partial(score_walks, planner, batch, metric=metric, time_limit_s=settings.time_limit_s)
    scores = score(settings.space.cells)
    draw = partial(generator, settings.seed, settings.replicate)
    static = fit_static(
        planner, batch, settings.space, draw("fit_static"), scores=scores, metric=metric, starts=settings.static_starts,
        maxfun=settings.static_evaluations, time_limit_s=settings.time_limit_s,
    )  # fmt: skip
    chosen = training_of(choices, settings)
    model = train(scores, indexed, known.participants, settings.space, chosen, draw("build_space"))
    law, residuals_s = _calibrated(known, scores, model, static, planner, chosen, settings)
    models: dict[str, MotionModel] = {
        "P_Stat": StaticModel(static.names, static.optimum),
        "P_Adapt": AdaptiveModel(model),
        "P_Prob": model,
    }
    held = _held(choices, static, settings.space)
    ablated: dict[str, MotionModel] = {}
    if ablate:
        names = settings.seed, settings.replicate
        ablated = ablated_models(scores, indexed, known.participants, settings.space, chosen, score, held, *names)
    tables: dict[str, dict[str, pd.DataFrame]] = {}
    forecasts, others = {}, {}
    for index, (name, walks) in enumerate(population.scenarios.items()):
        asked, _ = _planned(walks, planner, choices, settings)
        simulate = partial(
            simulate_trials, planner=planner, walks=asked.walks, routes=asked.routes, vectors=asked.vectors,
            standing=settings.standing, time_limit_s=settings.time_limit_s, metric=metric, seed=settings.seed,
            replicate=settings.replicate, inside=model.inside(asked.vectors), space=settings.space, scenes=settings.scenes,
        )  # fmt: skip
        trials = simulate(models)
        found = compare_models(trials, settings.seed, settings.replicate, name, settings.bootstraps)
        for table, rows in found.items():
            tables.setdefault(table, {})[name] = rows
        simulated_s = trials[trials["model"] == "P_Stat"]["simulated_s"].to_numpy()
        forecasts[name] = _scored(asked, model, law, with_residuals(simulated_s, residuals_s), planner, settings)
        if ablated and index == 0:  # section 8 is on the first scenario
            variants = simulate({"full": model, **ablated}, stream="P_Prob")
            others["ablations"] = ablation_table(variants, draw("ablate_parameters"), held, settings.bootstraps)
    return Study({name: by_dataset(found) for name, found in tables.items()} | others, forecasts, static, law.level)


def _planned(walks: list[Walk], planner: Planner, choices: Choices, settings: StudySettings) -> tuple[_Walks, pd.DataFrame]:
    """Walks with routes and run-time dependencies, and the dependencies that they are filed under."""
    routes = find_routes(walks, settings.scenes, planner, settings.body)
    rows = pd.DataFrame([walk.row for walk in walks])
    vectors = partial(
        dependency_vectors, rows, routes, settings.dependencies, curvature_scale_m=settings.curvature_scale_m,
        route_sigma=settings.route_sigma_samples, curvature=choices.curvature,
        samples={walk.row["walk"]: walk.position_m for walk in walks},
    )  # fmt: skip
    planned = vectors(index="planned").reset_index(drop=True)
    filed = planned if choices.index == "planned" else vectors(index=choices.index).reset_index(drop=True)
    return _Walks(walks, routes, planned.to_numpy(dtype=float)), filed


def _held(choices: Choices, static: StaticFit, space: ParameterSpace) -> dict[str, float]:
    values = space.bounds.mean(axis=1) if choices.held == "middle" else static.optimum
    return {name: float(value) for name, value in zip(space.names, values, strict=True)}


def _calibrated(
    known: _Walks,
    scores: Array,
    model: ProbabilisticModel,
    static: StaticFit,
    planner: Planner,
    chosen: TrainingSettings,
    settings: StudySettings,
) -> tuple[SharpnessLaw, Array]:
    """The law of the exponent learned from training walks, and what P_Stat is off by on the same walks (s)."""
    rng = generator(settings.seed, settings.replicate, "calibrate_model")
    rows = choose_walks(known.participants, settings.calibration_walks, rng)
    follow = settings.standing, settings.time_limit_s
    evidence = evidence_of(
        known.walks, known.routes, known.vectors, scores, chosen.normalisation, model.blending, rows, planner, settings.space,
        *follow, chosen.k, chosen.weights, chosen.scaling,
    )  # fmt: skip
    law = candidate_table(evidence, {"exponent": CANDIDATES["exponent"]})[1]
    optimum = np.tile(static.optimum, (len(rows), 1))
    times_s = travel_times(planner, [known.walks[row] for row in rows], known.routes, optimum, *follow)
    return law, evidence.captured_s - times_s


def _scored(
    asked: _Walks, model: ProbabilisticModel, law: SharpnessLaw, static_s: Array, planner: Planner, settings: StudySettings
) -> pd.DataFrame:
    """CRPS of every walk under P_Prob (calibrated) and P_Stat with residual spread."""
    traces, _ = trace_walks(asked.walks, asked.routes, planner, settings.space, settings.standing, settings.time_limit_s)
    captured_s = np.array([float(walk.row["duration_s"]) for walk in asked.walks])
    density = sharpened(model.blend(asked.vectors), law.exponents(asked.vectors), cell_volumes(settings.space))
    sharp = Forecast(grid_quantiles(traces.travel_s, density, levels(MEMBERS))[0])
    identity = pd.DataFrame({"walk": [walk.row["walk"] for walk in asked.walks], "participant": asked.participants})
    return walk_scores(captured_s, {STATIC: Forecast(static_s), CALIBRATED: sharp}, identity)
