"""Paired tests of forecasts in which the walks of one person are not independent, and what the paper's test makes of them.

The signed-rank test of section 7.4 counts every walk as independent. Beside it stand, for the same pairs: the same test on the
means of the participants, a mixed model with a random intercept per participant, and intervals from resampling participants; p
values corrected after Holm; and the power, and the size where there is no effect, of both tests by simulation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.evaluation.bootstrap import RESAMPLES, cluster_codes, cluster_counts, interval, resampled_sums
from walklab.evaluation.forecasts import (
    ADAPTIVE,
    BARE,
    CALIBRATED,
    EXTENDED,
    EXTENDED_EARLIER,
    GAUSSIAN_PROCESS,
    LITERAL,
    LOG_REGRESSION_EARLIER,
    QUANTILE_REGRESSION,
    REGRESSION,
    STATIC,
)
from walklab.evaluation.mixed import intercept_of
from walklab.evaluation.pairs import paired
from walklab.evaluation.score_tables import parts
from walklab.evaluation.signed_rank import ROUNDING_DECIMALS, wilcoxon_power_are
from walklab.steering.pace import fit_pace

Array = NDArray[np.float64]

QUESTIONS = (
    (STATIC, ADAPTIVE),
    (ADAPTIVE, LITERAL),
    (STATIC, LITERAL),
    (LITERAL, CALIBRATED),
    (STATIC, CALIBRATED),
    (REGRESSION, CALIBRATED),
    (REGRESSION, EXTENDED),
    (GAUSSIAN_PROCESS, EXTENDED),
    (LOG_REGRESSION_EARLIER, EXTENDED_EARLIER),
    (ADAPTIVE, CALIBRATED),
    (BARE, CALIBRATED),
    (QUANTILE_REGRESSION, CALIBRATED),
    (GAUSSIAN_PROCESS, CALIBRATED),
    (QUANTILE_REGRESSION, EXTENDED),
)
SIMULATIONS = 200


def pair_table(
    rows: pd.DataFrame,
    rng: np.random.Generator,
    pairs: Sequence[tuple[str, str]] = QUESTIONS,
    column: str = "crps_s",
    resamples: int = RESAMPLES,
    alpha: float = 0.05,
) -> pd.DataFrame:
    """Tests of first - second (positive: the second is better), by scenario, hull and pair.

    Returns
    -------
    DataFrame: scenario, hull, first, second, walks, participants, zeros (left out of the walks' ranks), ties (walks that share
    the size of their difference), mean_difference_s, dz and rank_biserial with _low and _high; p_walks (the paper's test),
    p_participants (exact, on their means), mixed_s with _low, _high and p_mixed; p_<...>_holm over the pairs of the same
    scenario and hull; power_are and, simulated, power_walks, power_participants, size_walks, size_participants. The mixed
    model and what is simulated are of all walks, not of the parts.
    """
    found = []
    for (scenario, hull), part in parts(rows):
        here = []
        for first, second in pairs:
            table = paired(part, first, second, column)
            row = {"scenario": scenario, "hull": hull, "first": first, "second": second}
            here.append(row | _tested(table, rng, resamples, alpha, whole=hull == "all"))
        frame = pd.DataFrame(here)
        for name in ("p_walks", "p_participants", "p_mixed"):
            frame[f"{name}_holm"] = holm(frame[name].to_numpy(dtype=float))
        found.append(frame)
    return pd.concat(found, ignore_index=True)


def holm(p: Array) -> Array:
    """Holm's step-down correction (statsmodels); missing values stay missing and do not count."""
    from statsmodels.stats.multitest import multipletests  # late: a second of imports

    result = np.full(len(p), np.nan)
    known = np.isfinite(p)
    if known.any():
        result[known] = multipletests(p[known], method="holm")[1]
    return result


def _tested(table: pd.DataFrame, rng: np.random.Generator, resamples: int, alpha: float, whole: bool) -> dict[str, float]:
    difference = np.round((table["first"] - table["second"]).to_numpy(), ROUNDING_DECIMALS)
    codes, clusters = cluster_codes(table["participant"])
    counts = cluster_counts(clusters, resamples, rng)
    sizes = np.unique(np.abs(difference[difference != 0]), return_counts=True)[1]
    means = np.asarray(pd.Series(difference).groupby(codes).mean(), dtype=float)
    row: dict[str, float] = {"walks": len(difference), "participants": clusters}
    row |= {"zeros": int((difference == 0).sum()), "ties": int(sizes[sizes > 1].sum())}
    sums = resampled_sums(np.column_stack([np.ones_like(difference), difference, difference**2]), codes, counts)
    mean = sums[:, 1] / sums[:, 0]
    spread = np.sqrt(np.maximum(sums[:, 2] / sums[:, 0] - mean**2, 1e-18))
    exact = difference.mean(), difference.mean() / max(float(difference.std()), 1e-9), _rank_biserial(difference)
    draws = mean, mean / spread, _resampled_rank_biserial(difference, codes, counts)
    for name, value, drawn in zip(("mean_difference_s", "dz", "rank_biserial"), exact, draws, strict=True):
        low, high = interval(drawn, clusters)
        row |= {name: value, f"{name}_low": low, f"{name}_high": high}
    row["p_walks"] = _signed_rank(difference[None], "asymptotic")[0]
    row["p_participants"] = _signed_rank(means[None], "exact" if clusters <= 50 else "asymptotic")[0]
    estimate = intercept_of(table.assign(error=difference)) if whole else {}
    row |= {"mixed_s": estimate.get("estimate_s", np.nan), "mixed_s_low": estimate.get("low_s", np.nan)}
    row |= {"mixed_s_high": estimate.get("high_s", np.nan), "p_mixed": estimate.get("p", np.nan)}
    row["power_are"] = float(wilcoxon_power_are(exact[1], len(difference), alpha))
    for name, effect in (("power", exact[0]), ("size", 0.0)):
        shares = simulated_power(difference, codes, effect, rng, alpha) if whole else (np.nan, np.nan)
        row[f"{name}_walks"], row[f"{name}_participants"] = shares
    return row


def simulated_power(
    difference: Array, codes: NDArray[np.int64], effect: float, rng: np.random.Generator, alpha: float, repeats: int = SIMULATIONS
) -> tuple[float, float]:
    """How often the signed-rank test on walks, and that on participants' means, reject when the true mean is ``effect``.

    Simulated are as many walks of each participant as there are: normal participants' means about the effect and normal walks
    about these, with the variance components of the differences.
    """
    parts_of = fit_pace(difference, [str(code) for code in codes])
    people = rng.normal(effect, max(parts_of.person_sd, 1e-12), (repeats, int(codes.max()) + 1))
    walks = people[:, codes] + rng.normal(0, max(parts_of.walk_sd, 1e-12), (repeats, len(codes)))
    sums = np.stack([np.bincount(codes, row) for row in walks]) / np.bincount(codes)
    by_walk, by_person = _signed_rank(walks, "asymptotic"), _signed_rank(sums, "exact" if sums.shape[1] <= 50 else "asymptotic")
    return float((by_walk < alpha).mean()), float((by_person < alpha).mean())


def _signed_rank(differences: Array, method: str) -> Array:
    """Two-sided p of every row; 1 where all differences are zero."""
    from scipy.stats import wilcoxon  # late: half a second of imports

    result = np.ones(len(differences))
    some = (differences != 0).any(axis=1)
    if some.any() and differences.shape[1] > 1:
        exact_possible = method != "exact" or not (differences == 0).any()
        chosen = method if exact_possible else "asymptotic"
        result[some] = wilcoxon(differences[some], axis=1, method=chosen, correction=chosen == "asymptotic").pvalue
    return result


def _rank_biserial(difference: Array) -> float:
    """(sum of positive ranks - sum of negative ranks) / their sum; zeros are left out."""
    from scipy.stats import rankdata

    used = difference[difference != 0]
    if not len(used):
        return 0.0
    ranks = rankdata(np.abs(used))
    return float((ranks * np.sign(used)).sum() / ranks.sum())


def _resampled_rank_biserial(difference: Array, codes: NDArray[np.int64], counts: NDArray[np.int64]) -> Array:
    """The same of every resample, the ranks being those of all walks: their order does not depend on who is drawn."""
    from scipy.stats import rankdata

    used = difference != 0
    ranks = np.zeros(len(difference))
    ranks[used] = rankdata(np.abs(difference[used]))
    sums = resampled_sums(np.column_stack([ranks * np.sign(difference), ranks]), codes, counts)
    return np.asarray(sums[:, 0] / np.maximum(sums[:, 1], 1e-9))
