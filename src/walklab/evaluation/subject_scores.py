"""Scores of travel-time forecasts per participant, and a summary in which every participant counts once."""

from __future__ import annotations

import numpy as np
import pandas as pd

from walklab.errors import InputError
from walklab.evaluation.bootstrap import DECIMALS, RESAMPLES, cluster_counts, interval

# An error floor, not a forecast: the walk is simulated with the best cell of its own captured map.
OWN_MAP = "best cell of the walk's own map"
# One time each, without any spread; as forecasts they have that of their training residuals.
STATIC_POINT, ADAPTIVE_POINT = "P_Stat (point)", "P_Adapt (point)"
WALKS_LEFT_OUT = "walks_left_out"  # stands in tables where others have the name of a scenario
TASK_SPEEDS = "task speeds alone"  # a baseline of walks that start and end while walking

COVERAGES = {
    f"coverage_{level}": f"share of walks inside the {level} % interval; {level / 100} is right" for level in (50, 80, 90, 95)
}
# Column of the scores table -> what it is, with the smaller (in size) the better unless said otherwise.
MEASURES = {
    "median_abs_dt_s": "median |dt| of a single draw (median over draws, then over walks); not a proper score",
    "median_dt_s": "median signed dt of the forecast's median",
    "median_abs_point_dt_s": "median |dt| of the forecast's median",
    "crps_s": "mean continuous ranked probability score",
    "energy_m": "mean energy score of the trajectory; missing where there is none",
    **COVERAGES,
    "width_90_s": "mean width of the 90 % interval",
    "bias_s": "mean of forecast mean - captured time",
}


def subject_scores(predictions: pd.DataFrame) -> pd.DataFrame:
    """One row per participant and model from one row per walk and model.

    The error of a single draw is not taken from one draw per walk: half of the participants may have a single walk,
    and then one draw decides. It is the median over all draws of a walk, then over the participant's walks.

    Parameters
    ----------
    predictions : the columns of :func:`walklab.evaluation.score_tables.walk_scores`, and point_s (the forecast's median)

    Returns
    -------
    DataFrame: participant, model, walks, the columns of :data:`MEASURES`, inside_share
    """
    error = predictions["point_s"] - predictions["captured_s"]
    means = [name for name in MEASURES if not name.startswith("median_")]
    groups = predictions.assign(error=error, distance=error.abs()).groupby(["participant", "model"], sort=False)
    return groups.agg(
        walks=("walk", "size"),
        median_abs_dt_s=("draw_abs_dt_s", "median"),
        median_dt_s=("error", "median"),
        median_abs_point_dt_s=("distance", "median"),
        **{name: (name, "mean") for name in means},
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
    DataFrame, a row per model: model, participants, walks, then per measure its
    mean, ``<measure>_low`` and ``<measure>_high``; also ``crps_minus_reference_s``, inside_share,
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
        row = {"model": name, "participants": len(group), "walks": int(group["walks"].sum())}
        for measure, values in [(m, group[m]) for m in MEASURES] + [("crps_minus_reference_s", less)]:
            low, high = interval(counts @ values.to_numpy(dtype=float) / len(group), len(group))
            row |= {measure: float(values.mean()), f"{measure}_low": float(low), f"{measure}_high": float(high)}
        row |= {
            "inside_share": float(group["inside_share"].mean()),
            "kind": "error floor" if floor else "forecast",
            "reference": reference,
        }
        rows.append(row | {"better_than_reference": pd.NA if floor else int((less < 0).sum())})
    return pd.DataFrame(rows).astype({"better_than_reference": "Int64"})
