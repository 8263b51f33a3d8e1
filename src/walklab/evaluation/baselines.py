"""What a travel time would be without any motion model: climatology, linear regression, and the task's speeds alone.

A forecast is an ensemble: equally likely travel times, here the quantiles ``(i + 1/2) / n`` of
the predictive distribution, so that every kind of forecast is scored by the same code.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

from walklab.errors import InputError

Array = NDArray[np.float64]


def levels(members: int) -> Array:
    """(n,) levels of n equally likely quantiles."""
    return (np.arange(members) + 0.5) / members


def participant_weights(participants: Sequence[str]) -> Array:
    """(W,) weights that sum to 1 and give every participant the same share."""
    _, owner, counts = np.unique(np.asarray(participants, dtype=str), return_inverse=True, return_counts=True)
    return 1.0 / (counts[owner] * len(counts))


def climatology(
    durations_s: ArrayLike, lengths_m: ArrayLike, participants: Sequence[str], asked_lengths_m: ArrayLike, members: int = 200
) -> Array:
    """Travel times from the training walks' paces: ``T = (T_i / l_i) l``, every training participant counting the same.

    Parameters
    ----------
    durations_s, lengths_m, participants : (W,) of the training walks; lengths of the planned routes
    asked_lengths_m : (N,) lengths of the planned routes of the walks to forecast

    Returns
    -------
    (N, members) array, seconds
    """
    # ASSUME: Climatology is the distribution of the pace (s/m) of the training walks, not of their travel times,
    # because the length of the planned route is known beforehand and would otherwise be withheld from this baseline.
    pace = np.asarray(durations_s, dtype=float) / np.asarray(lengths_m, dtype=float)
    order = np.argsort(pace, kind="stable")
    cumulative = np.cumsum(participant_weights(participants)[order])
    at = np.minimum(np.searchsorted(cumulative, levels(members)), len(pace) - 1)
    return np.asarray(asked_lengths_m, dtype=float)[:, None] * pace[order][at]


def regression(durations_s: ArrayLike, vectors: ArrayLike, asked_vectors: ArrayLike, members: int = 200) -> Array:
    r"""Travel times from an ordinary least-squares fit ``T = b_0 + b \cdot d + e``.

    The predictive distribution is Student's t around the fitted value with the fit's residual degrees of freedom;
    its scale is the residual spread together with the uncertainty of the coefficients (statsmodels ``se_obs``).
    Dependencies without spread in training are left out.

    Parameters
    ----------
    durations_s : (W,) of the training walks
    vectors, asked_vectors : (W, D) and (N, D) dependencies, as the motion models get them

    Returns
    -------
    (N, members) array, seconds, not negative

    Raises
    ------
    InputError
        If there are too few training walks for the residual spread.
    """
    from statsmodels.regression.linear_model import OLS  # late: a second of imports

    known, asked = np.atleast_2d(np.asarray(vectors, dtype=float)), np.atleast_2d(np.asarray(asked_vectors, dtype=float))
    varies = known.std(axis=0) > 1e-9 * np.maximum(np.abs(known).max(axis=0), 1.0)
    # Centred and scaled: the pseudo-inverse would otherwise drop directions of small units.
    centre, scale = known[:, varies].mean(axis=0), known[:, varies].std(axis=0)
    design = np.column_stack([np.ones(len(known)), (known[:, varies] - centre) / scale])
    if len(known) < design.shape[1] + 2:
        raise InputError(f"regression: {len(known)} training walks are too few for {design.shape[1]} coefficients; add walks")
    fit = OLS(np.asarray(durations_s, dtype=float), design).fit()
    forecast = fit.get_prediction(np.column_stack([np.ones(len(asked)), (asked[:, varies] - centre) / scale]))
    members_s = forecast.predicted[:, None] + forecast.se_obs[:, None] * stdtrit(fit.df_resid, levels(members))
    return np.maximum(members_s, 0.0)


def task_speeds(lengths_m: ArrayLike, start_speeds_m_s: ArrayLike, end_speeds_m_s: ArrayLike) -> Array | None:
    """Travel times of somebody who changes evenly from the start to the end speed: ``T = 2 l / (v_0 + v_1)``.

    It learns nothing. Where walks start and end while walking, the task itself nearly tells the pace, and this
    baseline shows how much; a model that does not beat it has learnt nothing of use.

    Returns
    -------
    (N, 1) array, seconds; None if any of the walks starts or ends standing, where the task tells no pace
    """
    start, end = np.asarray(start_speeds_m_s, dtype=float), np.asarray(end_speeds_m_s, dtype=float)
    if np.any(np.minimum(start, end) <= 0):
        return None
    return (2 * np.asarray(lengths_m, dtype=float) / (start + end))[:, None]
