"""Leave-one-subject-out: how well a person's travel times are forecast by models that never saw that person.

The suitability maps (raw scores) of all walks and their traces on the grid are computed once; they do not depend on who is left
out. Per participant everything that is learned is learned again, on the others' walks, and makes the same forecasts as of the
held-out scenarios (:func:`walklab.evaluation.scenario_forecasts.forecast_scenario`), under the same names. Beside them stand
P_Stat and P_Adapt as they are, one time without spread, and, where all walks start and end while walking, the task's two speeds
alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.evaluation.baselines import task_speeds
from walklab.evaluation.bootstrap import RESAMPLES
from walklab.evaluation.folds import by_participant
from walklab.evaluation.forecasts import CLIMATOLOGY, Asked, Forecast, Known
from walklab.evaluation.grid_scores import captured_distances
from walklab.evaluation.nested import learn
from walklab.evaluation.route_forecasts import mean_progress, route_energy
from walklab.evaluation.scenario_forecasts import Learned, durations, forecast_scenario, route_lengths
from walklab.evaluation.score_tables import calibration_table, walk_scores
from walklab.evaluation.simulated_times import travel_times
from walklab.evaluation.subject_scores import (
    ADAPTIVE_POINT,
    STATIC_POINT,
    TASK_SPEEDS,
    WALKS_LEFT_OUT,
    subject_scores,
    summarise,
)
from walklab.evaluation.tracing import drawn_energy, trace_walks
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.planning.tracing import Traces
from walklab.randomness import generator
from walklab.steering.metrics import metric_named
from walklab.steering.models import AdaptiveModel, ProbabilisticModel, StaticModel
from walklab.steering.routes import pack
from walklab.steering.space import ParameterSpace
from walklab.steering.static_fit import fit_static
from walklab.steering.training import TrainingSettings, train

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


@dataclass(frozen=True)
class Study:
    """Walks with all that does not depend on who is left out.

    Attributes
    ----------
    walks : accepted walks of all participants
    routes : walk id -> planned route (n, 2), metres
    vectors : (W, D) run-time dependency vectors in the order of the walks; columns name them
    scores : (W, C) raw metric of every walk and cell of ``space``
    """

    walks: Sequence[Walk]
    routes: Mapping[str, Array]
    vectors: pd.DataFrame
    scores: Array
    planner: Planner
    space: ParameterSpace
    standing: Standing

    def __post_init__(self) -> None:
        ids = [str(walk.row["walk"]) for walk in self.walks]
        if list(self.vectors.index.astype(str)) != ids or len(self.scores) != len(ids):
            raise InputError(
                f"cross-validation: {len(ids)} walks, {len(self.vectors)} dependency vectors and {len(self.scores)} maps "
                "do not belong to the same walks in the same order; compute them from one walks table"
            )
        if missing := [name for name in ids if name not in self.routes]:
            raise InputError(f"cross-validation: no route for walk {missing[0]}; plan the routes again")

    @property
    def participants(self) -> NDArray[np.str_]:
        """(W,) who walked."""
        return np.array([str(walk.row["participant"]) for walk in self.walks])

    def traced(self, time_limit_s: float) -> tuple[Traces, NDArray[np.float32]]:
        """Traces of all walks and cells, and the (W, C) distances from the captured walks; computed once."""
        key = f"_traced_{time_limit_s}"
        if key not in self.__dict__:
            traces, places = trace_walks(self.walks, self.routes, self.planner, self.space, self.standing, time_limit_s)
            self.__dict__[key] = traces, captured_distances(traces, places)
        return self.__dict__[key]

    @property
    def durations_s(self) -> Array:
        """(W,) captured travel times: standing to standing, or the whole extent where the ends move."""
        return durations(self.walks)

    @property
    def planned_lengths_m(self) -> Array:
        """(W,) lengths of the planned routes."""
        return route_lengths(self.walks, self.routes)


@dataclass(frozen=True)
class CrossValidationOptions:
    """How models are fitted and simulated.

    Attributes
    ----------
    time_limit_s : longest simulated walk; one that reaches it counts with this time
    metric : of the static fit, the same as of the scores
    static_starts, static_maxfun : of the simulated annealing
    reference : model that the summary compares the others' CRPS with
    bootstraps : resamples of the participants for the intervals
    """

    time_limit_s: float = 60.0
    metric: str = "euclid"
    static_starts: int = 1
    static_maxfun: int = 1000
    reference: str = CLIMATOLOGY
    bootstraps: int = RESAMPLES


@dataclass(frozen=True)
class CrossValidation:
    """Tables: one row per walk and model; per participant and model; per model; coverage and PIT histogram per model."""

    predictions: pd.DataFrame
    scores: pd.DataFrame
    summary: pd.DataFrame
    calibration: pd.DataFrame


def leave_one_subject_out(
    study: Study, settings: TrainingSettings, options: CrossValidationOptions, seed: int, replicate: int
) -> CrossValidation:
    """Forecast every participant's walks from the other participants' and score the forecasts.

    Nothing of a forecast walk is used but its task (end points, start and end speed) and the person's height; the rows
    of the model :data:`~walklab.evaluation.subject_scores.OWN_MAP`, an error floor, read the walk's own map.

    Returns
    -------
    predictions : from :func:`leave_out` for every participant
    scores : :func:`walklab.evaluation.subject_scores.subject_scores`
    summary : every participant counts once; 95 % intervals from resampling participants
    calibration : :func:`walklab.evaluation.score_tables.calibration_table`; every walk counts once

    Raises
    ------
    InputError
        If there are fewer than three participants, or k exceeds the entries of a blending space.
    """
    participants = by_participant(study.participants, least=3)
    parts = [leave_out(participant, study, settings, options, seed, replicate) for participant in participants]
    predictions = pd.concat(parts, ignore_index=True)
    scores = subject_scores(predictions)
    rng = generator(seed, replicate, "cross_validation", "bootstrap")
    summary = summarise(scores, options.reference, rng, options.bootstraps)
    return CrossValidation(predictions, scores, summary, calibration_table(predictions))


def leave_out(
    participant: str, study: Study, settings: TrainingSettings, options: CrossValidationOptions, seed: int, replicate: int
) -> pd.DataFrame:
    """Forecast one participant's walks with models trained on all others.

    Returns
    -------
    DataFrame, one row per walk and model: scenario (:data:`WALKS_LEFT_OUT`), the columns of
    :func:`walklab.evaluation.score_tables.walk_scores`, point_s (the forecast's median)
    """
    known, asked = by_participant(study.participants)[participant]
    rng = generator(seed, replicate, "cross_validation", participant, "blending_space")
    owners = study.participants[known].tolist()
    model = train(study.scores[known], study.vectors.iloc[known], owners, study.space, settings, rng)
    forecasts = _forecasts(study, asked, known, model, settings, options, seed, replicate, participant)
    identity = pd.DataFrame({"scenario": WALKS_LEFT_OUT, "walk": [str(study.walks[row].row["walk"]) for row in asked]})
    inside = model.inside(study.vectors.to_numpy(dtype=float)[asked])
    identity = identity.assign(participant=participant, inside_hull=inside)
    points = [np.median(forecast.members_s, axis=1) for forecast in forecasts.values()]
    return walk_scores(study.durations_s[asked], forecasts, identity).assign(point_s=np.concatenate(points))


def _forecasts(
    study: Study,
    asked: Rows,
    known: Rows,
    model: ProbabilisticModel,
    settings: TrainingSettings,
    options: CrossValidationOptions,
    seed: int,
    replicate: int,
    participant: str,
) -> dict[str, Forecast]:
    """Every forecast of the asked walks by its name."""
    vectors, times, lengths = study.vectors.to_numpy(dtype=float), study.durations_s, study.planned_lengths_m
    owners, walks = study.participants, [study.walks[row] for row in asked]
    traces, distances = study.traced(options.time_limit_s)
    static = _static_model(study, known, options, generator(seed, replicate, "cross_validation", participant, "static_fit"))
    static_s = _times(study, np.arange(len(times)), static.parameters(vectors), options)
    adapted = AdaptiveModel(model).parameters(vectors[asked])
    adaptive_s = _times(study, asked, adapted, options)
    static_m, adaptive_m = (
        drawn_energy(walks, study.routes, study.planner, each[:, None], options.time_limit_s)
        for each in (static.parameters(vectors[asked]), adapted)
    )
    calibration, suitability = learn(
        model, settings, owners[known].tolist(), times[known], vectors[known], traces.rows(known), distances[known]
    )
    # Best cells of maps blended from others: with their own maps in the blend, training walks would be forecast too well.
    best_s = traces.travel_s[known, suitability.argmax(axis=1)]
    training = Known(
        times[known],
        lengths[known],
        vectors[known],
        owners[known].tolist(),
        np.arange(len(known)),
        times[known] - static_s[known],
        times[known] - best_s,
        model.blending.maps[: len(known)].mean(axis=0),
        mean_progress([study.walks[row] for row in known]),
    )
    learned = Learned(model, calibration, training, study.planner, study.standing, options.time_limit_s, options.metric)
    # The error floor of the grid reads the captured walk itself and forecasts nothing.
    own = asked, study.scores[asked].argmin(axis=1)
    task = Asked(
        times[asked],
        lengths[asked],
        vectors[asked],
        owners[asked].tolist(),
        model.blend(vectors[asked]),
        learned.paced.density_model().blend(vectors[asked]),
        static_s[asked],
        adaptive_s,
        traces.travel_s[own].astype(float),
        static_m,
        adaptive_m,
        distances[own].astype(float),
        traces.rows(asked),
        distances[asked],
    )
    found = {
        STATIC_POINT: Forecast(task.static_s[:, None], static_m),
        ADAPTIVE_POINT: Forecast(adaptive_s[:, None], adaptive_m),
    }
    # Whether this baseline exists must not differ between participants, so all walks are asked.
    speeds = [np.array([float(walk.row[f"{end}_speed_m_s"]) for walk in study.walks]) for end in ("start", "end")]
    if (alone := task_speeds(lengths, *speeds)) is not None:
        found[TASK_SPEEDS] = Forecast(alone[asked], route_energy(walks, study.routes, alone[asked], training.progress))
    return found | forecast_scenario(walks, study.routes, task, learned, seed, replicate)


def _static_model(study: Study, known: Rows, options: CrossValidationOptions, rng: np.random.Generator) -> StaticModel:
    batch = pack([study.walks[index] for index in known], study.routes, study.planner)
    fit = fit_static(
        study.planner,
        batch,
        study.space,
        rng,
        scores=study.scores[known],
        metric=metric_named(options.metric, study.standing),
        starts=options.static_starts,
        maxfun=options.static_maxfun,
        time_limit_s=options.time_limit_s,
    )
    return StaticModel(fit.names, fit.optimum)


def _times(study: Study, rows: Rows, parameters: Array, options: CrossValidationOptions) -> Array:
    """Travel times of some walks with one parameter vector each."""
    walks = [study.walks[row] for row in rows]
    return travel_times(study.planner, walks, study.routes, parameters, study.standing, options.time_limit_s)
