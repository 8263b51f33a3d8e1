"""Leave-one-subject-out: how well a person's travel times are forecast by models that never saw that person.

The suitability maps (raw scores) of all walks are computed once; they do not depend on who is left out. Per
participant only the models are trained again, on the others' scores. Beside the three motion models stand P_Prob
without dependencies or with learned sharpness, climatology, regressions and a Gaussian process on the same dependencies
and, where all walks start and end while walking, the task's two speeds alone. One row is no forecast: the best cell of the
walk's own captured map, which knows the answer and is the error that the grid of parameters leaves to everybody.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.evaluation.baselines import climatology, regression, task_speeds
from walklab.evaluation.bootstrap import DECIMALS, RESAMPLES
from walklab.evaluation.folds import by_participant
from walklab.evaluation.grid_scores import captured_distances
from walklab.evaluation.learned_baselines import with_residuals
from walklab.evaluation.nested import learn, nested_forecasts
from walklab.evaluation.subject_scores import OWN_MAP, forecast_scores, subject_scores, summarise
from walklab.evaluation.tracing import trace_walks
from walklab.geometry import curves
from walklab.geometry.scene import Task
from walklab.geometry.standing import Standing
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.protocol import Arrival, Planner
from walklab.planning.tracing import Traces
from walklab.randomness import generator
from walklab.steering.metrics import metric_named
from walklab.steering.models import AdaptiveModel, ProbabilisticModel, StaticModel
from walklab.steering.routes import pack, task_of
from walklab.steering.space import ParameterSpace
from walklab.steering.static_fit import fit_static
from walklab.steering.training import TrainingSettings, train

Array = NDArray[np.float64]

STATIC, ADAPTIVE, PROBABILISTIC = "P_Stat", "P_Adapt", "P_Prob"
WITHOUT_DEPENDENCIES = "P_Prob without dependencies"
STATIC_SPREAD, ADAPTIVE_SPREAD = "P_Stat with residual spread", "P_Adapt with residual spread"
CLIMATOLOGY, REGRESSION, TASK_SPEEDS = "climatology", "regression", "task speeds alone"


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
        return np.array([float(walk.row["duration_s"]) for walk in self.walks])

    @property
    def planned_lengths_m(self) -> Array:
        """(W,) lengths of the planned routes."""
        return np.array([curves.length(np.asarray(self.routes[str(walk.row["walk"])])) for walk in self.walks])


@dataclass(frozen=True)
class CrossValidationOptions:
    """How much is drawn and simulated.

    Attributes
    ----------
    draws : parameter vectors of P_Prob per walk, and members of the baselines' forecasts
    time_limit_s : longest simulated walk; one that reaches it counts with this time
    metric : of the static fit, the same as of the scores
    static_starts, static_maxfun : of the simulated annealing
    reference : model that the summary compares the others' CRPS with
    bootstraps : resamples of the participants for the intervals
    """

    draws: int = 200
    time_limit_s: float = 60.0
    metric: str = "euclid"
    static_starts: int = 1
    static_maxfun: int = 1000
    reference: str = CLIMATOLOGY
    bootstraps: int = RESAMPLES


@dataclass(frozen=True)
class CrossValidation:
    """Tables: one row per walk and model; per participant and model; per model."""

    predictions: pd.DataFrame
    scores: pd.DataFrame
    summary: pd.DataFrame


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
    return CrossValidation(predictions, scores, summarise(scores, options.reference, rng, options.bootstraps))


def leave_out(
    participant: str, study: Study, settings: TrainingSettings, options: CrossValidationOptions, seed: int, replicate: int
) -> pd.DataFrame:
    """Forecast one participant's walks with models trained on all others.

    Returns
    -------
    DataFrame, one row per walk and model: walk, participant, model, k (NaN for models without neighbours),
    training_walks, captured_s, single_s (one random member of the forecast), dt_s = single_s - captured_s, abs_dt_s,
    members, the columns of :func:`walklab.evaluation.subject_scores.forecast_scores`, arrived_share (of the
    simulated members), inside_hull
    """
    known, asked = by_participant(study.participants)[participant]
    model = _train(study, known, study.vectors, settings, seed, replicate, participant)
    inside = model.inside(study.vectors.to_numpy(dtype=float)[asked])
    frames = []
    for name, k, members, arrived in _forecasts(study, asked, known, model, settings, options, seed, replicate, participant):
        frame = _frame(study, asked, name, members, seed, replicate)
        frame.insert(3, "k", float(k) if k else np.nan)
        frame.insert(4, "training_walks", len(known))
        frames.append(frame.assign(arrived_share=arrived, inside_hull=inside))
    return pd.concat(frames, ignore_index=True)


def _forecasts(
    study: Study,
    asked: NDArray[np.int64],
    known: NDArray[np.int64],
    model: ProbabilisticModel,
    settings: TrainingSettings,
    options: CrossValidationOptions,
    seed: int,
    replicate: int,
    participant: str,
) -> Iterator[tuple[str, int, Array, Array | float]]:
    """Name, k (0 where there are no neighbours), (N, members) travel times and share that arrived, model by model."""
    vectors = study.vectors.to_numpy(dtype=float)
    static = _static_model(study, known, options, generator(seed, replicate, "cross_validation", participant, "static_fit"))
    yield STATIC, 0, *_simulate(study, asked, static.parameters(vectors[asked])[:, None], options)
    times = study.durations_s
    fitted = _simulate(study, known, static.parameters(vectors[known])[:, None], options)[0][:, 0]
    point = _simulate(study, asked, static.parameters(vectors[asked])[:, None], options)[0][:, 0]
    yield STATIC_SPREAD, 0, with_residuals(point, times[known] - fitted, options.draws), np.nan
    adaptive, arrived = _simulate(study, asked, AdaptiveModel(model).parameters(vectors[asked])[:, None], options)
    yield ADAPTIVE, settings.k, adaptive, arrived
    drawn = _draw(study, asked, model, vectors, PROBABILISTIC, options.draws, seed, replicate)
    yield PROBABILISTIC, settings.k, *_simulate(study, asked, drawn, options)
    # Without dependencies all maps are equally near: k is their number, and nothing can be up-sampled.
    nothing = replace(settings, k=len(known), count=None)
    bare = _train(study, known, study.vectors[[]], nothing, seed, replicate, participant)
    drawn = _draw(study, asked, bare, vectors[:, :0], WITHOUT_DEPENDENCIES, options.draws, seed, replicate)
    yield WITHOUT_DEPENDENCIES, len(known), *_simulate(study, asked, drawn, options)
    lengths = study.planned_lengths_m
    owners = study.participants[known].tolist()
    traces, distances = study.traced(options.time_limit_s)
    learned = learn(model, settings, owners, times[known], vectors[known], traces.rows(known), distances[known])
    # Best cells of maps blended from others: with their own maps in the blend, training walks would be forecast too well.
    best = learned.suitability.argmax(axis=1)
    residuals = times[known] - traces.travel_s[known, best]
    yield ADAPTIVE_SPREAD, settings.k, with_residuals(adaptive[:, 0], residuals, options.draws), np.nan
    walks = [{"captured_s": times[i], "vectors": vectors[i], "participants": study.participants[i]} for i in (known, asked)]
    for name, k, members in nested_forecasts(
        learned.calibration, model, settings.k, walks[0], walks[1], traces.rows(asked), options.draws
    ):
        yield name, k, members, np.nan
    yield CLIMATOLOGY, 0, climatology(times[known], lengths[known], owners, lengths[asked], options.draws), np.nan
    yield REGRESSION, 0, regression(times[known], vectors[known], vectors[asked], options.draws), np.nan
    # Whether this baseline exists must not differ between participants, so all walks are asked.
    speeds = [np.array([float(walk.row[f"{end}_speed_m_s"]) for walk in study.walks]) for end in ("start", "end")]
    if (alone := task_speeds(lengths, *speeds)) is not None:
        yield TASK_SPEEDS, 0, alone[asked], np.nan
    # The error floor of the grid: it reads the captured walk itself and forecasts nothing.
    best = study.space.cells[np.argmin(study.scores[asked], axis=1)]
    yield OWN_MAP, 0, *_simulate(study, asked, best[:, None], options)


def _train(
    study: Study,
    known: NDArray[np.int64],
    vectors: pd.DataFrame,
    settings: TrainingSettings,
    seed: int,
    replicate: int,
    participant: str,
) -> ProbabilisticModel:
    rng = generator(seed, replicate, "cross_validation", participant, "blending_space")
    owners = study.participants[known].tolist()
    return train(study.scores[known], vectors.iloc[known], owners, study.space, settings, rng)


def _static_model(
    study: Study, known: NDArray[np.int64], options: CrossValidationOptions, rng: np.random.Generator
) -> StaticModel:
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


def _draw(
    study: Study,
    asked: NDArray[np.int64],
    model: ProbabilisticModel,
    vectors: Array,
    name: str,
    draws: int,
    seed: int,
    replicate: int,
) -> Array:
    """(N, draws, P) parameter vectors, drawn under the walk's own name."""
    rngs = [generator(seed, replicate, "cross_validation", name, str(study.walks[index].row["walk"])) for index in asked]
    return np.stack([model.sample(vectors[index], draws, rng) for index, rng in zip(asked, rngs, strict=True)])


def _simulate(study: Study, asked: NDArray[np.int64], parameters: Array, options: CrossValidationOptions) -> tuple[Array, Array]:
    """Travel times (N, members) for parameters (N, members, P), and the share (N,) that arrived."""
    times, arrived = np.empty(parameters.shape[:2]), np.empty(parameters.shape[:2])
    for row, index in enumerate(asked):
        walk = study.walks[index].row
        route, task = np.asarray(study.routes[str(walk["walk"])]), task_of(walk)
        for member, values in enumerate(parameters[row]):
            times[row, member], arrived[row, member] = _travel_time(study, route, task, values, options.time_limit_s)
    return times, arrived.mean(axis=1)


def _travel_time(study: Study, route: Array, task: Task, parameters: ArrayLike, time_limit_s: float) -> tuple[float, bool]:
    trajectory = study.planner.follow(route, task, np.asarray(parameters, dtype=float), time_limit_s)
    if trajectory.arrival == Arrival.TIMEOUT:
        return time_limit_s, False
    travel_s = trajectory_travel_time_s(trajectory, task, study.standing.standing_speed_m_s)
    return travel_s, trajectory.arrival == Arrival.ARRIVED


def _frame(study: Study, asked: NDArray[np.int64], model: str, members: Array, seed: int, replicate: int) -> pd.DataFrame:
    names = [str(study.walks[index].row["walk"]) for index in asked]
    captured = study.durations_s[asked]
    # A draw is one of the members, picked by the walk's own generator: the baselines' members are sorted.
    picks = [
        int(generator(seed, replicate, "cross_validation", "single", model, name).integers(members.shape[1])) for name in names
    ]
    single = members[np.arange(len(names)), picks]
    frame = pd.DataFrame({"walk": names, "participant": study.participants[asked], "model": model, "captured_s": captured})
    less = np.round(single - captured, DECIMALS) + 0.0
    frame = frame.assign(single_s=single, dt_s=less, abs_dt_s=np.abs(less), members=members.shape[1])
    return pd.concat([frame, forecast_scores(captured, members)], axis=1)
