"""Tables of the forecasts: scores by walk, by model with intervals, and how often each interval holds what it says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.evaluation.bootstrap import DECIMALS, RESAMPLES, cluster_codes, cluster_counts, interval, resampled_sums
from walklab.evaluation.crps import ensemble_crps
from walklab.evaluation.forecasts import INFORMED, QUADRATIC_REGRESSION, REGRESSION, Forecast
from walklab.evaluation.subject_scores import OWN_MAP

Array = NDArray[np.float64]

COVERAGES = (50, 80, 90, 95)
STATED = tuple(range(5, 100, 5))  # levels of the calibration curve, the above among them
BINS = 10  # of the PIT histogram
MEANS = ("crps_s", "energy_m", *(f"coverage_{level}" for level in COVERAGES), "width_90_s", "bias_s")
HULLS = {"all": None, "inside": True, "outside": False}


def walk_scores(captured_s: Array, forecasts: Mapping[str, Forecast], walks: pd.DataFrame) -> pd.DataFrame:
    """One row per walk and model.

    Parameters
    ----------
    captured_s : (W,)
    walks : (W,) rows that identify the walks: walk, participant, inside_hull

    Returns
    -------
    DataFrame: the columns of ``walks``, model, captured_s, crps_s, energy_m (NaN without trajectories), coverage_5 to coverage_95
    (whether the closed central interval between Hazen's quantiles holds the captured time), width_90_s, bias_s (forecast mean -
    captured), pit (mid-rank), draw_abs_dt_s (median over the members of a single draw's ``|dt|``)
    """
    frames = []
    for model, forecast in forecasts.items():
        members = forecast.members_s
        columns: dict[str, Any] = {"model": model, "captured_s": captured_s}
        columns["crps_s"] = ensemble_crps(captured_s, members)
        columns["energy_m"] = np.nan if forecast.energy_m is None else forecast.energy_m
        half = np.array(STATED) / 200
        lows, highs = (np.quantile(members, at, axis=1, method="hazen") for at in (0.5 - half, 0.5 + half))
        for level, low, high in zip(STATED, lows, highs, strict=True):
            columns[f"coverage_{level}"] = ((low <= captured_s) & (captured_s <= high)).astype(float)
        columns["width_90_s"] = (highs - lows)[STATED.index(90)]
        observed = captured_s[:, None]
        columns["bias_s"] = members.mean(axis=1) - captured_s
        columns["pit"] = (members < observed).mean(axis=1) + 0.5 * (members == observed).mean(axis=1)
        columns["draw_abs_dt_s"] = np.median(np.abs(members - observed), axis=1)
        frames.append(walks.reset_index(drop=True).assign(**columns))
    return pd.concat(frames, ignore_index=True)


def score_table(rows: pd.DataFrame, rng: np.random.Generator, resamples: int = RESAMPLES) -> pd.DataFrame:
    """Scores by model, scenario and hull, each with a 95 % interval from resampling participants.

    Returns
    -------
    DataFrame: scenario, hull (all, inside, outside), model, information (``task``, ``task and earlier walks``, ``the walk
    itself``), walks, participants, then each of :data:`MEANS` with <name>_low and <name>_high, pit_distance (Kolmogorov-Smirnov
    distance of the PIT from uniform; walks are not independent, so no p), draw_median_abs_dt_s (not a proper score),
    crps_minus_regression_s (of :data:`REGRESSION`) and energy_minus_regression_m (of :data:`QUADRATIC_REGRESSION` on the planned
    route) with their intervals, paired by walk
    """
    from scipy.stats import kstest  # late: half a second of imports

    tables = []
    for (scenario, hull), part in parts(rows):
        codes, clusters = cluster_codes(part.loc[part["model"] == part["model"].iloc[0], "participant"])
        counts = cluster_counts(clusters, resamples, rng)
        sizes = resampled_sums(np.ones(len(codes)), codes, counts)
        by_model = dict(iter(part.groupby("model", sort=False)))
        for model, group in by_model.items():
            row: dict[str, object] = {"scenario": scenario, "hull": hull, "model": model, "information": information(str(model))}
            row |= {"walks": len(group), "participants": clusters}
            values = {name: group[name].to_numpy(dtype=float) for name in MEANS}
            # The walks of all models are in the same order.
            values["crps_minus_regression_s"] = values["crps_s"] - by_model[REGRESSION]["crps_s"].to_numpy()
            values["energy_minus_regression_m"] = values["energy_m"] - by_model[QUADRATIC_REGRESSION]["energy_m"].to_numpy()
            for name, value in values.items():
                low, high = interval(resampled_sums(value, codes, counts) / sizes, clusters)
                row |= {name: float(np.round(value.mean(), DECIMALS)), f"{name}_low": low, f"{name}_high": high}
            row["pit_distance"] = float(kstest(group["pit"], "uniform").statistic)
            row["draw_median_abs_dt_s"] = float(group["draw_abs_dt_s"].median())
            tables.append(row)
    return pd.DataFrame(tables)


def parts(rows: pd.DataFrame) -> list[tuple[tuple[str, str], pd.DataFrame]]:
    """(scenario, hull) and its rows: all walks, those inside the training dependencies, and those outside."""
    found = []
    for scenario, group in rows.groupby("scenario", sort=False):
        for hull, inside in HULLS.items():
            part = group if inside is None else group[group["inside_hull"] == inside]
            if len(part):
                found.append(((str(scenario), hull), part))
    return found


def information(model: str) -> str:
    """What a forecast knows of the walk."""
    if model == OWN_MAP:
        return "the walk itself"
    return "task and earlier walks" if model in INFORMED else "task"


def calibration_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Nominal against observed coverage, the same as in :func:`score_table`, and the PIT histogram.

    Returns
    -------
    DataFrame[scenario, model, quantity (coverage or pit), at (nominal coverage, or middle of the bin), value]
    """
    tables = []
    for (scenario, model), group in rows[rows["model"] != OWN_MAP].groupby(["scenario", "model"], sort=False):
        tables += [(scenario, model, "coverage", level / 100, float(group[f"coverage_{level}"].mean())) for level in STATED]
        share = np.histogram(group["pit"], BINS, (0, 1))[0] / len(group)
        tables += [(scenario, model, "pit", (i + 0.5) / BINS, value) for i, value in enumerate(share)]
    return pd.DataFrame(tables, columns=["scenario", "model", "quantity", "at", "value"])
