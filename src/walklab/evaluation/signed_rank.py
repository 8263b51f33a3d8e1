"""Wilcoxon signed-rank tests between motion models, with effect sizes and power (Agethen et al. 2017, section 7.4)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy.special import ndtr

from walklab.errors import InputError
from walklab.evaluation.bootstrap import RESAMPLES, Array, Integers, cluster_codes, cluster_counts, interval, resampled_sums
from walklab.evaluation.pairs import PAIRS, paired

ROUNDING_DECIMALS = 9

# Asymptotic relative efficiency of the Wilcoxon signed-rank test against the t test (Hodges and Lehmann 1956).
RELATIVE_EFFICIENCY = {"normal": 3 / np.pi, "uniform": 1.0, "logistic": np.pi**2 / 9, "laplace": 1.5, "minimum": 0.864}


def wilcoxon_power_are(dz: ArrayLike, n: ArrayLike, alpha: float = 0.05, parent: str = "normal") -> Any:
    """Power of the two-sided Wilcoxon signed-rank test as G*Power computes it (A.R.E. method).

    The power of a t test on ``n' = n * ARE`` pairs: noncentral t with ``n' - 1`` degrees of
    freedom and noncentrality ``dz * sqrt(n')``, where ``dz`` is mean over standard deviation
    of the paired differences (Faul et al. 2007; G*Power 3.1 manual, chapter on the
    Wilcoxon signed-rank test for matched pairs).

    Parameters
    ----------
    dz, n : numbers or arrays
    parent : distribution of the differences that fixes the efficiency, a key of ``RELATIVE_EFFICIENCY``

    Returns
    -------
    float or array in [alpha, 1]
    """
    from statsmodels.stats.power import ttest_power  # late: a second of imports

    if parent not in RELATIVE_EFFICIENCY:
        raise InputError(f"power: unknown parent distribution {parent!r}; known are {sorted(RELATIVE_EFFICIENCY)}")
    effective = np.asarray(n, dtype=float) * RELATIVE_EFFICIENCY[parent]
    # Beyond a noncentrality of 30 the power is 1 to machine precision, and the noncentral t may not converge.
    size = np.minimum(np.abs(np.asarray(dz, dtype=float)), 30 / np.sqrt(effective))
    right = ttest_power(size, effective, alpha / 2, alternative="larger")
    wrong = np.nan_to_num(ttest_power(size, effective, alpha / 2, alternative="smaller"))
    power = np.minimum(right + wrong, 1.0)
    return float(power) if np.ndim(power) == 0 else power


def compare_pairs(
    trials: pd.DataFrame,
    rng: np.random.Generator,
    pairs: Sequence[tuple[str, str]] = PAIRS,
    alpha: float = 0.05,
    resamples: int = RESAMPLES,
    column: str = "abs_dt_s",
) -> pd.DataFrame:
    """Wilcoxon signed-rank test of each pair of models, with effect sizes and power.

    The differences are first - second: positive where the second model is better.
    Zero differences are left out, as SPSS does; the p value has a continuity correction.

    Returns
    -------
    DataFrame, a row per pair: first, second, n, zeros, ties, w, p, p_low, p_high, rank_biserial, cles (probability
    that an error of the first is larger than one of the second), mean_difference_s, median_difference_s, dz,
    power, power_low, power_high (normal parent), power_minimum (smallest efficiency, 0.864).
    Intervals: participants resampled.
    """
    return pd.DataFrame([_compare(paired(trials, *pair, column), pair, rng, alpha, resamples) for pair in pairs])


def _compare(
    table: pd.DataFrame, pair: tuple[str, str], rng: np.random.Generator, alpha: float, resamples: int
) -> dict[str, Any]:
    first, second = table["first"].to_numpy(), table["second"].to_numpy()
    # Times are multiples of the step; without rounding, equal differences would differ by 1e-16 and be ranked.
    difference = np.round(first - second, ROUNDING_DECIMALS)
    w, p, rank_biserial, cles = _wilcoxon(first, second, difference)
    spread = difference.std(ddof=1) if len(difference) > 1 else 0.0
    dz = difference.mean() / spread if spread > 0 else 0.0
    codes, clusters = cluster_codes(table["participant"])
    counts = cluster_counts(clusters, resamples, rng)
    p_low, p_high = interval(resampled_wilcoxon_p(difference, codes, counts), clusters)
    power_low, power_high = interval(_resampled_power(difference, codes, counts, alpha), clusters)
    sizes = np.unique(np.abs(difference[difference != 0]), return_counts=True)[1]
    return {
        "first": pair[0],
        "second": pair[1],
        "n": len(difference),
        "zeros": int((difference == 0).sum()),
        "ties": int(sizes[sizes > 1].sum()),
        "w": w,
        "p": p,
        "p_low": p_low,
        "p_high": p_high,
        "rank_biserial": rank_biserial,
        "cles": cles,
        "mean_difference_s": difference.mean(),
        "median_difference_s": float(np.median(difference)),
        "dz": dz,
        "power": wilcoxon_power_are(dz, len(difference), alpha),
        "power_low": power_low,
        "power_high": power_high,
        "power_minimum": wilcoxon_power_are(dz, len(difference), alpha, "minimum"),
    }


def _wilcoxon(first: Array, second: Array, difference: Array) -> tuple[float, float, float, float]:
    import pingouin  # late: seconds of imports

    cles = float(pingouin.compute_effsize(first, second, paired=True, eftype="CLES"))
    if not difference.any():
        return 0.0, 1.0, 0.0, cles
    outcome = pingouin.wilcoxon(difference).iloc[0]
    # As coarse as its interval: a normal tail of 1e-169 is no probability that anybody could check.
    return float(outcome["W_val"]), round(float(outcome["p_val"]), ROUNDING_DECIMALS), float(outcome["RBC"]), cles


def resampled_wilcoxon_p(difference: Array, codes: Integers, counts: Integers) -> Array:
    """Two-sided p of the signed-rank test of every resample (normal approximation, corrected for ties and continuity).

    Differences of equal size share their mean rank; a walk drawn m times is m equal differences.

    Returns
    -------
    (resamples,) array
    """
    used = difference != 0
    if not used.any():
        return np.ones(len(counts))
    size, group = np.unique(np.abs(difference[used]), return_inverse=True)
    positive = difference[used] > 0
    result = np.empty(len(counts))
    # Groups of equal size per cluster, so that one matrix product gives the group sizes of each resample.
    members = np.zeros((counts.shape[1], len(size)))
    np.add.at(members, (codes[used], group), 1.0)
    members_positive = np.zeros_like(members)
    np.add.at(members_positive, (codes[used][positive], group[positive]), 1.0)
    for start in range(0, len(counts), 250):
        chunk = counts[start : start + 250].astype(float)
        equal, equal_positive = chunk @ members, chunk @ members_positive
        last = np.cumsum(equal, axis=1)
        total = last[:, -1]
        rank_sum = np.einsum("rg,rg->r", equal_positive, last - (equal - 1) / 2)
        mean = total * (total + 1) / 4
        variance = total * (total + 1) * (2 * total + 1) / 24 - (equal**3 - equal).sum(axis=1) / 48
        distance = np.maximum(np.abs(rank_sum - mean) - 0.5, 0.0)
        z = np.divide(distance, np.sqrt(np.maximum(variance, 0)), out=np.zeros_like(distance), where=variance > 0)
        result[start : start + 250] = 2 * ndtr(-z)
    return np.minimum(result, 1.0)


def _resampled_power(difference: Array, codes: Integers, counts: Integers, alpha: float) -> Array:
    sums = resampled_sums(np.column_stack([np.ones_like(difference), difference, difference**2]), codes, counts)
    n, mean = sums[:, 0], sums[:, 1] / sums[:, 0]
    variance = np.maximum(sums[:, 2] - n * mean**2, 0.0) / np.maximum(n - 1, 1)
    dz = np.divide(mean, np.sqrt(variance), out=np.zeros_like(mean), where=variance > 1e-18)
    return np.asarray(wilcoxon_power_are(dz, n, alpha))
