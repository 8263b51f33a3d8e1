"""Learned sharpness within leave-one-subject-out: chosen without the subject that is forecast, and the sceptic's baselines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walklab.evaluation.baselines import levels
from walklab.evaluation.calibration import (
    CANDIDATES,
    Calibration,
    Evidence,
    blend_others,
    learn_calibration,
    mean_of_others,
)
from walklab.evaluation.extended import log_times, personal_columns
from walklab.evaluation.forecasts import (
    CALIBRATED,
    EXTENDED,
    EXTENDED_EARLIER,
    GAUSSIAN_PROCESS,
    LOG_REGRESSION,
    LOG_REGRESSION_EARLIER,
    QUADRATIC_REGRESSION,
    QUADRATIC_REGRESSION_EARLIER,
    QUANTILE_REGRESSION,
    REGRESSION_EARLIER,
    paced_forecast,
    sharpened,
)
from walklab.evaluation.grid_scores import grid_quantiles
from walklab.evaluation.learned_baselines import fit_gaussian_process, personal_regression, quantile_regression
from walklab.evaluation.log_regression import fit_log_regression
from walklab.planning.tracing import Traces
from walklab.steering.learned import ignoring
from walklab.steering.models import ProbabilisticModel
from walklab.steering.sharpness import cell_volumes
from walklab.steering.training import TrainingSettings

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


@dataclass(frozen=True)
class Learned:
    """A calibration, and the (N, C) maps of the training walks blended from *other* participants."""

    calibration: Calibration
    suitability: Array


def learn(
    model: ProbabilisticModel,
    settings: TrainingSettings,
    participants: Sequence[str],
    captured_s: Array,
    vectors: Array,
    traces: Traces,
    distances_m: NDArray[np.float32],
) -> Learned:
    """Sharpness and pace from the N training walks of a model, leave-one-participant-out among them.

    Parameters
    ----------
    model : trained on these walks; its blending space begins with them
    captured_s, vectors, traces, distances_m : of the N walks
    """
    everybody = np.arange(len(participants))
    maps = model.blending.maps[: len(participants)]
    k = min(settings.k, len(participants) - max(list(participants).count(name) for name in set(participants)))
    ask = (model.blending, participants, everybody, vectors, (maps,), k, settings.weights, settings.scaling)
    (suitability,) = blend_others(*ask)
    personal = personal_columns(vectors, participants)
    impersonal = blend_others(*ask, personal)[0] if personal else suitability
    bare = mean_of_others(participants, everybody, maps)
    evidence = Evidence(
        participants,
        captured_s,
        vectors,
        model.dependencies,
        suitability,
        suitability,
        bare,
        impersonal,
        traces,
        distances_m,
        cell_volumes(model.space),
    )
    return Learned(learn_calibration(evidence, {"exponent": CANDIDATES["exponent"]})[0], suitability)


def nested_forecasts(
    calibration: Calibration,
    model: ProbabilisticModel,
    k: int,
    known: Mapping[str, NDArray],
    asked: Mapping[str, NDArray],
    traces: Traces,
    members: int,
) -> Iterator[tuple[str, int, Array]]:
    """Name, k (0 without neighbours) and (W, members) travel times of the learned models and baselines.

    Parameters
    ----------
    known, asked : ``captured_s``, ``vectors`` and ``participants`` of the training walks and of those to forecast; the captured
        times of the latter inform the forecasts of the same person's *later* walks alone
    traces : of the walks to forecast
    """
    volumes, at = cell_volumes(model.space), levels(members)
    density = sharpened(model.blend(asked["vectors"]), calibration.law.exponents(asked["vectors"]), volumes)
    yield CALIBRATED, k, grid_quantiles(traces.travel_s, density, at)[0]
    pace = calibration.pace
    density = sharpened(ignoring(model, pace.ignored).blend(asked["vectors"]), pace.exponent, volumes)
    start = log_times(traces.travel_s, density).mean + pace.trend(asked["vectors"])
    alone = [str(row) for row in range(len(start))]
    for name, people in ((EXTENDED, alone), (EXTENDED_EARLIER, asked["participants"])):
        effect = pace.effect.posterior(np.log(asked["captured_s"]) - start, list(people))
        yield name, k, paced_forecast(pace, traces.travel_s, density, asked["vectors"], effect, members)
    training = known["captured_s"], known["vectors"], list(known["participants"])
    vectors, walked = asked["vectors"], (asked["vectors"], asked["captured_s"], list(asked["participants"]))
    yield QUANTILE_REGRESSION, 0, quantile_regression(*training[:2], vectors, members)
    yield GAUSSIAN_PROCESS, 0, fit_gaussian_process(*training).new_person(vectors, members)
    target = asked["captured_s"], vectors, list(asked["participants"])
    yield REGRESSION_EARLIER, 0, personal_regression(*training, *target, members)
    for degree, alone_name, earlier_name in (
        (1, LOG_REGRESSION, LOG_REGRESSION_EARLIER),
        (2, QUADRATIC_REGRESSION, QUADRATIC_REGRESSION_EARLIER),
    ):
        fitted = fit_log_regression(*training, degree=degree)
        yield alone_name, 0, fitted.new_person(vectors, members)
        yield earlier_name, 0, fitted.after_earlier(*walked, members)
