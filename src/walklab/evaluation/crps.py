"""The continuous ranked probability score of an ensemble."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from walklab.evaluation.scoring_rules import scoring_rules

Array = NDArray[np.float64]


def ensemble_crps(observed: Array, members: Array) -> Array:
    r"""CRPS of each ensemble's empirical distribution, :math:`E|X - T| - \frac{1}{2} E|X - X'|` (scoringrules).

    Parameters
    ----------
    observed : (W,)
    members : (W, M) equally likely forecasts

    Returns
    -------
    (W,) array in the unit of the forecasts; for a single member it is the absolute error
    """
    scores = scoring_rules().crps_ensemble(observed, members, estimator="qd", backend="numpy")
    return np.asarray(scores, dtype=float).reshape(len(observed))
