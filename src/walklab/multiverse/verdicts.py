"""What a specification's study says of each claim."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from walklab.evaluation.bootstrap import DECIMALS, cluster_codes, cluster_counts, interval, resampled_sums
from walklab.evaluation.claims import NOT_CHECKABLE, NOT_REPRODUCED, Paper, check_claims
from walklab.evaluation.forecasts import CALIBRATED, STATIC
from walklab.multiverse.study import Study
from walklab.randomness import generator

HOLDS, FAILS = "holds", "does not hold"
COLUMNS = ("claim", "section", "statement", "ours", "ours_low", "ours_high", "verdict", "held")


def verdicts(study: Study, paper: Paper, seed: int, replicate: int, bootstraps: int) -> pd.DataFrame:
    """Every claim that the study's tables can decide, and whether forecasting by P_Prob (calibrated) pays.

    ``held``: the direction that the paper states holds (verdict reproduced or partly); for our own claims, the effect is
    above zero.

    Returns
    -------
    DataFrame[claim, section, statement, ours, ours_low, ours_high, verdict, held]
    """
    found = check_claims(paper, study.tables).rename(columns={"id": "claim"})
    found = found[found["verdict"] != NOT_CHECKABLE]
    found = found.assign(held=found["verdict"] != NOT_REPRODUCED)
    own = [_crps_reduction(name, rows, seed, replicate, bootstraps) for name, rows in study.scores.items()]
    return pd.concat([found[list(COLUMNS)], pd.DataFrame(own)], ignore_index=True)


def _crps_reduction(scenario: str, rows: pd.DataFrame, seed: int, replicate: int, bootstraps: int) -> dict[str, Any]:
    """``1 - CRPS(P_Prob calibrated) / CRPS(P_Stat with residual spread)``, participants resampled."""
    first, second = (rows[rows["model"] == name]["crps_s"].to_numpy() for name in (STATIC, CALIBRATED))
    codes, clusters = cluster_codes(rows.loc[rows["model"] == STATIC, "participant"])
    counts = cluster_counts(clusters, bootstraps, generator(seed, replicate, "multiverse", "crps", scenario))
    low, high = interval(1 - resampled_sums(second, codes, counts) / resampled_sums(first, codes, counts), clusters)
    words = scenario.replace("_", " ")
    value = float(np.round(1 - second.sum() / first.sum(), DECIMALS)) + 0.0
    return {
        "claim": f"crps_reduction_{scenario}_p_stat_to_p_prob_calibrated",
        "section": "beyond the paper",
        "statement": f"{words}: reduction of the CRPS from P_Stat with residual spread to P_Prob (calibrated)",
        "ours": value,
        "ours_low": low,
        "ours_high": high,
        "verdict": HOLDS if value > 0 else FAILS,
        "held": value > 0,
    }


def summary(claims: pd.DataFrame) -> pd.DataFrame:
    """One row per claim: how often it held, and how far its value moved.

    Parameters
    ----------
    claims : DataFrame[specification, kind, claim, statement, ours, held] of all specifications

    Returns
    -------
    DataFrame[claim, statement, specifications, held, held_share, default_held, default, smallest, median, largest,
    moved_most_by (the single change that moved the value farthest from the default), moved_to]
    """
    return pd.DataFrame([_summary_row(str(name), rows) for name, rows in claims.groupby("claim", sort=False)])


def _summary_row(claim: str, rows: pd.DataFrame) -> dict[str, Any]:
    default = rows[rows["kind"] == "default"]
    value = float(default["ours"].iloc[0]) if len(default) else np.nan
    single = rows[rows["kind"].isin(["choice", "constant"])]
    away = (single["ours"] - value).abs()
    farthest = single.iloc[int(np.nanargmax(away))] if away.notna().any() else None
    return {
        "claim": claim,
        "statement": rows["statement"].iloc[0],
        "specifications": len(rows),
        "held": int(rows["held"].sum()),
        "held_share": float(np.round(rows["held"].mean(), DECIMALS)),
        "default_held": bool(default["held"].iloc[0]) if len(default) else "",
        "default": value,
        "smallest": rows["ours"].min(),
        "median": rows["ours"].median(),
        "largest": rows["ours"].max(),
        "moved_most_by": "" if farthest is None else farthest["specification"],
        "moved_to": np.nan if farthest is None else farthest["ours"],
    }
