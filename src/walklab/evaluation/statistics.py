"""Descriptive statistics, tests and intervals of the travel-time errors (Agethen et al. 2017, section 7.4)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from walklab.evaluation.bootstrap import (
    DECIMALS,
    RESAMPLES,
    Array,
    cluster_codes,
    cluster_counts,
    interval,
    resampled_quantiles,
)
from walklab.evaluation.mixed import mixed_model
from walklab.evaluation.pairs import PAIRS, paired
from walklab.evaluation.signed_rank import compare_pairs, wilcoxon_power_are

__all__ = [
    "PAIRS",
    "by_dataset",
    "compare_pairs",
    "describe",
    "mixed_model",
    "paired",
    "percentile_intervals",
    "reductions",
    "shapiro_wilk",
    "wilcoxon_power_are",
]

LEVELS = {"p05": 0.05, "p25": 0.25, "median": 0.5, "p75": 0.75, "p95": 0.95}
LARGEST_SHAPIRO_SAMPLE = 5000


def describe(trials: pd.DataFrame, column: str = "abs_dt_s") -> pd.DataFrame:
    """Describe the error of each model.

    Returns
    -------
    DataFrame, a row per model: model, n, the numbers of trials not_arrived, outside_hull, on_edge (of the parameter space)
    and collided (through a true obstacle; 0 where the trials lack the column), mean, sd, p05, p25, median, p75, p95, iqr,
    skew, shapiro_w, shapiro_p (Shapiro-Wilk; NaN for fewer than 4 or equal values), and median_signed_dt_s
    """
    return pd.DataFrame([_describe_one(str(name), group, column) for name, group in trials.groupby("model", sort=False)])


def _describe_one(model: str, group: pd.DataFrame, column: str) -> dict[str, Any]:
    from scipy.stats import skew  # late, as below

    values = group[column].to_numpy(dtype=float)
    quantiles = dict(zip(LEVELS, np.quantile(values, list(LEVELS.values())), strict=True))
    w, p = shapiro_wilk(values)
    return {
        "model": model,
        "n": len(values),
        "not_arrived": int((group["arrival"] != "arrived").sum()),
        "outside_hull": int((~group["inside_hull"].astype(bool)).sum()),
        **{count: int(group[count].astype(bool).sum()) if count in group else 0 for count in ("on_edge", "collided")},
        "mean": values.mean(),
        "sd": values.std(ddof=1) if len(values) > 1 else np.nan,
        **quantiles,
        "iqr": quantiles["p75"] - quantiles["p25"],
        "skew": float(skew(values)) if np.ptp(values) > 0 else np.nan,
        "shapiro_w": w,
        "shapiro_p": p,
        "median_signed_dt_s": float(group["dt_s"].median()),
    }


def shapiro_wilk(values: Array) -> tuple[float, float]:
    """W and p of the Shapiro-Wilk test; of an evenly thinned sample where there are more than 5000 values."""
    if len(values) < 4 or np.ptp(values) == 0:
        return np.nan, np.nan
    import pingouin  # late: seconds of imports, which rules that only resample need not pay

    thinned = values[:: int(np.ceil(len(values) / LARGEST_SHAPIRO_SAMPLE))]
    outcome = pingouin.normality(thinned).iloc[0]
    return float(outcome["W"]), float(outcome["pval"])


def percentile_intervals(
    trials: pd.DataFrame, rng: np.random.Generator, resamples: int = RESAMPLES, column: str = "abs_dt_s"
) -> pd.DataFrame:
    """Percentiles of each model's error with 95 % intervals: DataFrame[model, statistic, value, low, high]."""
    levels = list(LEVELS.values())
    rows = []
    counts = None
    for model, group in trials.groupby("model", sort=False):
        values = group[column].to_numpy(dtype=float)
        codes, clusters = cluster_codes(group["participant"])
        if counts is None or counts.shape[1] != clusters:
            counts = cluster_counts(clusters, resamples, rng)
        draws = resampled_quantiles(values, codes, counts, levels)
        exact = np.quantile(values, levels)
        draws = np.column_stack([draws, draws[:, 3] - draws[:, 1]])
        low, high = interval(draws, clusters)
        for index, name in enumerate([*LEVELS, "iqr"]):
            value = exact[index] if index < len(levels) else exact[3] - exact[1]
            rows.append({"model": model, "statistic": name, "value": value, "low": low[index], "high": high[index]})
    return pd.DataFrame(rows)


def reductions(
    trials: pd.DataFrame,
    rng: np.random.Generator,
    pairs: Sequence[tuple[str, str]] = PAIRS,
    resamples: int = RESAMPLES,
    column: str = "abs_dt_s",
) -> pd.DataFrame:
    """Relative reduction ``1 - q(second) / q(first)`` of each percentile from one model to the next, paired by walk.

    Returns
    -------
    DataFrame[first, second, statistic, value, low, high]; NaN where a percentile of the first model is zero
    """
    levels = list(LEVELS.values())
    rows = []
    for first, second in pairs:
        table = paired(trials, first, second, column)
        codes, clusters = cluster_codes(table["participant"])
        counts = cluster_counts(clusters, resamples, rng)
        both = [table[side].to_numpy() for side in ("first", "second")]
        value = _reduction(*(np.quantile(errors, levels) for errors in both))
        low, high = interval(_reduction(*(resampled_quantiles(errors, codes, counts, levels) for errors in both)), clusters)
        rows += [
            {"first": first, "second": second, "statistic": name, "value": value[i], "low": low[i], "high": high[i]}
            for i, name in enumerate(LEVELS)
        ]
    return pd.DataFrame(rows)


def _reduction(first: Array, second: Array) -> Array:
    ratio = np.divide(second, first, out=np.full_like(second, np.nan), where=first > 0)
    return np.round(1 - ratio, DECIMALS) + 0.0


def by_dataset(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Stack tables of several data sets, the name of each in a first column ``dataset``."""
    frames = [table.assign(dataset=name) for name, table in tables.items()]
    stacked = pd.concat(frames, ignore_index=True)
    return stacked[["dataset", *[column for column in stacked.columns if column != "dataset"]]]
