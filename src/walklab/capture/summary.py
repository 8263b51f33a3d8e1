"""What a capture amounts to: counts, lengths, rejections and the exactness of boundaries, by data set."""

from __future__ import annotations

import numpy as np
import pandas as pd

from walklab.capture.walks import ACCEPTED


def dataset_of(walks: pd.Series) -> pd.Series:
    """The data set of each walk: the first part of its id (``scenario_1/P03/...``)."""
    return walks.str.split("/").str[0]


def capture_summary(walks: pd.DataFrame) -> pd.DataFrame:
    """Accepted walks by data set: DataFrame[dataset, participants, walks, total_length_km, mean_length_m, median_duration_s]."""
    accepted = walks[walks["rejection"] == ACCEPTED]
    grouped = accepted.groupby(dataset_of(accepted["walk"]).rename("dataset"), sort=True)
    summary = grouped.agg(
        participants=("participant", "nunique"),
        walks=("walk", "size"),
        total_length_km=("length_m", lambda lengths: lengths.sum() / 1000),
        mean_length_m=("length_m", "mean"),
        median_duration_s=("duration_s", "median"),
    )
    return summary.reset_index()


def rejection_counts(walks: pd.DataFrame) -> pd.DataFrame:
    """How many movements were left out for which reason: DataFrame[dataset, rejection, movements]."""
    rejected = walks[walks["rejection"] != ACCEPTED]
    # Reasons carry their measure ("dropout of 0.38 s"); counted is the kind before it.
    kinds = rejected["rejection"].str.replace(r"(:| of ).*", "", regex=True)
    counts = rejected.groupby([dataset_of(rejected["walk"]).rename("dataset"), kinds], sort=True).size()
    return counts.rename("movements").reset_index()


def boundary_errors(errors: pd.DataFrame) -> pd.DataFrame:
    """Absolute boundary errors by data set, both ends together.

    Parameters
    ----------
    errors : DataFrame[walk, start_error_frames, end_error_frames]

    Returns
    -------
    DataFrame[dataset, median_boundary_error_frames, p95_boundary_error_frames]
    """
    ends = errors.melt("walk", ["start_error_frames", "end_error_frames"], value_name="frames")
    absolute = ends["frames"].abs().groupby(dataset_of(ends["walk"]).rename("dataset"), sort=True)
    quantiles = absolute.quantile(np.array([0.5, 0.95])).unstack()
    return quantiles.set_axis(["median_boundary_error_frames", "p95_boundary_error_frames"], axis=1).reset_index()
