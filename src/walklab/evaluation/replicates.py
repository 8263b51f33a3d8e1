"""What many synthetic populations say: in how many of them a claim held, and how the forecasts' scores vary between them.

A replicate is a new population, captured, trained on and evaluated anew; replicates are independent of each other, so that
intervals over them are the textbook's.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import stats
from statsmodels.stats.proportion import proportion_confint

from walklab.errors import InputError
from walklab.evaluation.claims import NOT_CHECKABLE, PARTLY, REPRODUCED, Paper

MEASURES = ("crps_s", "energy_m", "coverage_90", "width_90_s", "bias_s")
DIFFERENCE, ENERGY_DIFFERENCE = "crps_difference_s", "energy_difference_m"
DIFFERENCES = {DIFFERENCE: "crps_s", ENERGY_DIFFERENCE: "energy_m"}
JUDGED = "P_Prob"  # forecasts whose names start so are compared with every other


def count_claims(paper: Paper, verdicts: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """In how many replicates each claim held.

    Parameters
    ----------
    verdicts : the table of :func:`walklab.evaluation.claims.check_claims` of every replicate

    Returns
    -------
    DataFrame, a row per claim of the paper: id, section, statement, published; replicates, in which it was checkable; reproduced,
    and direction_held (reproduced or partly: defined only for a figure with a direction), each a number of replicates with the
    ends of its share's 95 % Wilson interval (<name>_low, <name>_high); ours_median, ours_min, ours_max over the replicates;
    note

    Raises
    ------
    InputError
        If the tables do not hold the paper's claims.
    """
    rows = pd.concat(verdicts, ignore_index=True)
    found = {str(name): group for name, group in rows.groupby("id", sort=False)}
    if len(rows) != len(verdicts) * len(paper.claims) or set(found) != {claim.id for claim in paper.claims}:
        raise InputError("replicates: the tables of claims are not all of this paper; check the claims again")
    counted = []
    for claim in paper.claims:
        group = found[claim.id]
        checked = group[group["verdict"] != NOT_CHECKABLE]
        first = group.iloc[0]
        row = {"id": claim.id, "section": claim.section, "statement": claim.statement, "published": first["published"]}
        row["replicates"] = len(checked)
        row |= _counted("reproduced", checked["verdict"] == REPRODUCED)
        directed = claim.ours is not None and len(claim.direction) > 0
        row |= _counted("direction_held", checked["verdict"].isin([REPRODUCED, PARTLY]) if directed else checked["verdict"][:0])
        ours = pd.to_numeric(checked["ours"])
        row |= {"ours_median": ours.median(), "ours_min": ours.min(), "ours_max": ours.max()}
        counted.append(row | {"note": "" if len(checked) else first["note"]})
    return pd.DataFrame(counted)


def _counted(name: str, held: pd.Series) -> dict[str, float]:
    """How many, and the interval of their share; NaN where nothing was judged."""
    if not len(held):
        return dict.fromkeys((name, f"{name}_low", f"{name}_high"), np.nan)
    low, high = proportion_confint(int(held.sum()), len(held), method="wilson")
    return {name: int(held.sum()), f"{name}_low": float(low), f"{name}_high": float(high)}


def pool_scores(tables: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """Scores of every forecast over the replicates, and how much better or worse P_Prob is than every other forecast.

    Parameters
    ----------
    tables : the table of :func:`walklab.evaluation.score_tables.score_table` of every replicate

    Returns
    -------
    DataFrame[scenario, hull, measure, model, information, against, value, low, high, sd, below_zero, replicates]. ``measure`` is
    one of :data:`MEASURES`, or of :data:`DIFFERENCES`: the CRPS (or energy score) of ``model``, a variant of P_Prob, minus that
    of ``against`` in the same replicate, negative if ``model`` is better. ``value`` is the mean over the replicates that have
    such walks, ``low, high`` its 95 % interval by Student's t, ``sd`` their standard deviation, ``below_zero`` in how many it
    is negative
    """
    rows = pd.concat([table.assign(replicate=number) for number, table in enumerate(tables)], ignore_index=True)
    rows["information"] = rows["information"].astype(str)
    keys = ["scenario", "hull", "model", "information"]
    long = rows.melt([*keys, "replicate"], list(MEASURES), "measure", "value").dropna(subset="value")
    pooled = _over_replicates(long.assign(against=""))
    differences = [_over_replicates(_differences(rows, keys, name, score)) for name, score in DIFFERENCES.items()]
    return pd.concat([pooled, *differences], ignore_index=True)


def _differences(rows: pd.DataFrame, keys: list[str], measure: str, score: str) -> pd.DataFrame:
    """A score of each variant of P_Prob minus that of every other forecast, by replicate."""
    scored = rows[[*keys, "replicate", score]]
    pairs = scored[scored["model"].str.startswith(JUDGED)].merge(
        scored.drop(columns="information").rename(columns={"model": "against", score: "other"}),
        on=["scenario", "hull", "replicate"],
    )
    pairs = pairs[pairs["model"] != pairs["against"]]
    return pairs.assign(measure=measure, value=pairs[score] - pairs["other"]).dropna(subset="value")


def _over_replicates(long: pd.DataFrame) -> pd.DataFrame:
    keys = ["scenario", "hull", "measure", "model", "information", "against"]
    groups = long.assign(below_zero=long["value"] < 0).groupby(keys, sort=False)
    mean, sd, count = groups["value"].mean(), groups["value"].std(), groups["value"].count()
    half = stats.t.ppf(0.975, np.maximum(count - 1, 1)) * sd / np.sqrt(count)
    columns = {"value": mean, "low": mean - half, "high": mean + half, "sd": sd, "below_zero": groups["below_zero"].sum()}
    return pd.DataFrame(columns | {"replicates": count}).reset_index()
