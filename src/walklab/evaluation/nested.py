"""Learned sharpness within leave-one-subject-out: chosen without the subject that is forecast."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from walklab.evaluation.calibration import (
    CANDIDATES,
    Calibration,
    Evidence,
    blend_others,
    learn_calibration,
    mean_of_others,
)
from walklab.evaluation.extended import personal_columns
from walklab.planning.tracing import Traces
from walklab.steering.models import ProbabilisticModel
from walklab.steering.sharpness import cell_volumes
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
) -> tuple[Calibration, Array]:
    """Sharpness and pace from the N training walks of a model, leave-one-participant-out among them.

    Parameters
    ----------
    model : trained on these walks; its blending space begins with them
    captured_s, vectors, traces, distances_m : of the N walks

    Returns
    -------
    the calibration, and the (N, C) maps of the walks blended from *other* participants
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
    return learn_calibration(evidence, {"exponent": CANDIDATES["exponent"]})[0], suitability
