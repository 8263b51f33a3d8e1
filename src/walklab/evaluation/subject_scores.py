"""Scores of travel-time forecasts per participant, and a summary in which every participant counts once."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.evaluation.bootstrap import DECIMALS, RESAMPLES, cluster_counts, interval
from walklab.evaluation.crps import ensemble_crps

Array = NDArray[np.float64]

# An error floor, not a forecast: the walk is simulated with the best cell of its own captured map.
OWN_MAP = "best cell of the walk's own map"

CENTRAL_INTERVAL = (0.05, 0.95)  # the 90 % interval

# Column of the scores table -> what it is, with the smaller (in size) the better unless said otherwise.
MEASURES = {
    "median_abs_dt_s": "median |dt| of a single draw (median over draws, then over walks)",
    "median_dt_s": "median signed dt of a single draw (median over draws, then over walks)",
    "median_abs_point_dt_s": "median |dt| of the forecast's median",
    "crps_s": "mean continuous ranked probability score",
    "coverage_90": "share of walks inside the 90 % interval; 0.9 is right",
}


def forecast_scores(captured_s: ArrayLike, members_s: ArrayLike) -> pd.DataFrame:
    r"""Score one ensemble per walk.

    The CRPS is that of the ensemble's empirical distribution,
    :math:`E|X - T| - \frac{1}{2} E|X - X'|`; for a single member it is the absolute error.

    Parameters
    ----------
    captured_s : (W,) observed travel times
    members_s : (W, M) equally likely forecasts

    Returns
    -------
    DataFrame, one row per walk: point_s (median), low_s, high_s (90 % interval), covered, crps_s, and the medians over
    the members of ``|dt|`` and ``dt``: draw_abs_dt_s, draw_dt_s
    """
    observed, members = np.asarray(captured_s, dtype=float), np.asarray(members_s, dtype=float)
    low, high = np.quantile(members, CENTRAL_INTERVAL, axis=1)
    errors = members - observed[:, None]
    return pd.DataFrame(
        {
            "point_s": np.median(members, axis=1),
            "low_s": low,
            "high_s": high,
            "covered": (low <= observed) & (observed <= high),
            "crps_s": ensemble_crps(observed, members),
            "draw_abs_dt_s": np.median(np.abs(errors), axis=1),
            "draw_dt_s": np.median(errors, axis=1),
        }
    )


def subject_scores(predictions: pd.DataFrame) -> pd.DataFrame:
    """One row per participant and model from one row per walk and model.

    The error of a single draw is not taken from one draw per walk: half of the participants may have a single walk,
    and then one draw decides. It is the median over all draws of a walk, then over the participant's walks.

    Parameters
    ----------
    predictions : participant, model, k, captured_s, arrived_share, inside_hull and the columns of :func:`forecast_scores`

    Returns
    -------
    DataFrame: participant, model, walks, k, the columns of :data:`MEASURES`, arrived_share, inside_share
    """
    point_error = (predictions["point_s"] - predictions["captured_s"]).abs()
    groups = predictions.assign(point_error=point_error).groupby(["participant", "model"], sort=False)
    return groups.agg(
        walks=("walk", "size"),
        k=("k", "first"),
        median_abs_dt_s=("draw_abs_dt_s", "median"),
        median_dt_s=("draw_dt_s", "median"),
        median_abs_point_dt_s=("point_error", "median"),
        crps_s=("crps_s", "mean"),
        coverage_90=("covered", "mean"),
        arrived_share=("arrived_share", "mean"),
        inside_share=("inside_hull", "mean"),
    ).reset_index()


def summarise(scores: pd.DataFrame, reference: str, rng: np.random.Generator, resamples: int = RESAMPLES) -> pd.DataFrame:
    """Mean over participants of every measure, with a 95 % interval from resampling participants.

    The last measure is the CRPS minus that of the reference model for the same participant: participants differ
    more than models do, so the paired difference is what decides. The error floor :data:`OWN_MAP` knows the walks that
    the models forecast, so it is compared with none of them.

    Parameters
    ----------
    scores : from :func:`subject_scores`; every model has every participant
    reference : model to compare with

    Returns
    -------
    DataFrame, a row per model: model, participants, walks, k (smallest over participants), then per measure its
    mean, ``<measure>_low`` and ``<measure>_high``; also ``crps_minus_reference_s``, arrived_share, inside_share,
    ``kind`` (``forecast``, or ``error floor`` for :data:`OWN_MAP`), ``reference`` and ``better_than_reference``
    (participants); both comparisons are missing for the error floor

    Raises
    ------
    InputError
        If the reference is no model of the table, or the error floor.
    """
    models = [str(name) for name in scores["model"].unique() if name != OWN_MAP]
    if reference not in models:
        raise InputError(f"summary: no model {reference!r} to compare with; choose from {', '.join(models)}")
    participants = sorted(scores["participant"].unique())
    by_model = {name: group.set_index("participant").loc[participants] for name, group in scores.groupby("model", sort=False)}
    # The same resamples for all models, so that their intervals can be compared.
    counts = cluster_counts(len(participants), resamples, rng)
    rows = []
    for name, group in by_model.items():
        floor = name == OWN_MAP
        less = (group["crps_s"] - by_model[reference]["crps_s"]).round(DECIMALS) * (np.nan if floor else 1.0)
        row = {"model": name, "participants": len(group), "walks": int(group["walks"].sum()), "k": group["k"].min()}
        for measure, values in [(m, group[m]) for m in MEASURES] + [("crps_minus_reference_s", less)]:
            low, high = interval(counts @ values.to_numpy(dtype=float) / len(group), len(group))
            row |= {measure: float(values.mean()), f"{measure}_low": float(low), f"{measure}_high": float(high)}
        row |= {"arrived_share": float(group["arrived_share"].mean()), "inside_share": float(group["inside_share"].mean())}
        row |= {"kind": "error floor" if floor else "forecast", "reference": reference}
        rows.append(row | {"better_than_reference": pd.NA if floor else int((less < 0).sum())})
    return pd.DataFrame(rows).astype({"better_than_reference": "Int64"})
