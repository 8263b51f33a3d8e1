"""Learned sharpness within leave-one-subject-out: chosen without the subject that is forecast, and the sceptic's baselines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.evaluation.baselines import levels
from walklab.evaluation.calibration import (
    CANDIDATES,
    MEMBERS,
    Calibration,
    Evidence,
    blend_others,
    chosen,
    extended_table,
    log_residuals,
    mean_of_others,
    scored,
)
from walklab.evaluation.forecasts import (
    CALIBRATED,
    EXTENDED,
    EXTENDED_EARLIER,
    GAUSSIAN_PROCESS,
    LOG_REGRESSION_EARLIER,
    QUANTILE_REGRESSION,
    REGRESSION_EARLIER,
)
from walklab.evaluation.grid_scores import grid_quantiles
from walklab.evaluation.learned_baselines import gaussian_process, personal_regression, quantile_regression
from walklab.evaluation.pace import paced
from walklab.planning.tracing import Traces
from walklab.steering.models import ProbabilisticModel
from walklab.steering.sharpness import Sharpness, cell_volumes
from walklab.steering.training import TrainingSettings

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


def learn(
    model: ProbabilisticModel,
    settings: TrainingSettings,
    participants: Sequence[str],
    captured_s: Array,
    vectors: Array,
    traces: Traces,
    distances_m: NDArray[np.float32],
) -> Calibration:
    """Sharpness and pace from the N training walks of a model, leave-one-participant-out among them.

    Parameters
    ----------
    model : trained on these walks; its blending space begins with them
    captured_s, vectors, traces, distances_m : of the N walks
    """
    everybody = np.arange(len(participants))
    maps = model.blending.maps[: len(participants)]
    people = len(set(participants))
    k = min(settings.k, len(participants) - max(list(participants).count(name) for name in set(participants)))
    (suitability,) = blend_others(
        model.blending, participants, everybody, vectors, (maps,), k, settings.weights, settings.scaling
    )
    bare = mean_of_others(participants, everybody, maps)
    volumes = cell_volumes(model.space)
    evidence = Evidence(participants, captured_s, suitability, suitability, bare, traces, distances_m, volumes)
    exponents = [scored(evidence, "P_Prob", Sharpness("exponent", value)) for value in CANDIDATES["exponent"]]
    table = pd.DataFrame(exponents)
    table["loss"] = (table["crps_s"] / table["crps_s"].min() + table["energy_m"] / table["energy_m"].min()) / 2
    bare_table = table.assign(model="P_Prob without dependencies")
    extended = extended_table(evidence) if people > 2 else table.assign(model="P_Prob (extended)", mean=0, person_sd=0, walk_sd=0)
    return chosen(pd.concat([table, bare_table, extended], ignore_index=True))


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
    maps = model.blend(asked["vectors"])
    density = Sharpness("exponent", calibration.exponent).density(maps, volumes)
    yield CALIBRATED, k, grid_quantiles(traces.travel_s, density, at)[0]
    density = Sharpness("exponent", calibration.extended_exponent).density(maps, volumes)
    sharp = grid_quantiles(traces.travel_s, density, levels(MEMBERS))[0]
    alone = [str(row) for row in range(len(sharp))]
    for name, people in ((EXTENDED, alone), (EXTENDED_EARLIER, asked["participants"])):
        effect = calibration.pace.posterior(log_residuals(asked["captured_s"], sharp), list(people))
        yield name, k, paced(sharp, *effect, calibration.pace.walk_sd, at)
    pairs = known["captured_s"], known["vectors"], asked["vectors"]
    yield QUANTILE_REGRESSION, 0, quantile_regression(*pairs, members)
    yield GAUSSIAN_PROCESS, 0, gaussian_process(*pairs, members)
    for name, logarithmic in ((REGRESSION_EARLIER, False), (LOG_REGRESSION_EARLIER, True)):
        training = known["captured_s"], known["vectors"], list(known["participants"])
        target = asked["captured_s"], asked["vectors"], list(asked["participants"])
        yield name, 0, personal_regression(*training, *target, members, logarithmic)
