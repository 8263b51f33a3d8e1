"""Paired tests of forecasts in which the walks of one person are not independent, and what the paper's test makes of them.

The signed-rank test of section 7.4 counts every walk as independent. Beside it stand, for the same pairs: the same test on the
means of the participants, a mixed model with a random intercept per participant, and intervals from resampling participants; p
values corrected after Holm; and the power, and the size where there is no effect, of both tests by simulation.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

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
    FITTED,
    FITTED_EARLIER,
    LITERAL,
    STATIC,
)
from walklab.evaluation.mixed import intercept_of
from walklab.evaluation.mixed_power import simulated_mixed_power
from walklab.evaluation.pairs import paired
from walklab.evaluation.score_tables import parts
from walklab.evaluation.signed_rank import ROUNDING_DECIMALS, wilcoxon_power_are
from walklab.evaluation.subject_scores import TASK_SPEEDS
from walklab.steering.pace import fit_pace

Array = NDArray[np.float64]

PAPERS = ((STATIC, ADAPTIVE), (ADAPTIVE, LITERAL), (STATIC, LITERAL))
BASELINES = (STATIC, ADAPTIVE, BARE, *FITTED, TASK_SPEEDS)
BASELINES_EARLIER = FITTED_EARLIER
QUESTIONS = (
    *PAPERS,
    (LITERAL, CALIBRATED),
    (CALIBRATED, EXTENDED),
    *((baseline, CALIBRATED) for baseline in BASELINES),
    *((baseline, EXTENDED) for baseline in BASELINES),
    *((baseline, EXTENDED_EARLIER) for baseline in BASELINES_EARLIER),
)
SIMULATIONS = 100
STATED_EFFECT_S = 0.02  # what power_mixed is asked for: not what was found, whose power says no more than its p
LEAST_PEOPLE = 3  # of a mixed model and of simulated power: two say nothing of the variance between people
P_VALUES = ("p_walks", "p_participants", "p_mixed")


def questions(models: Iterable[str]) -> list[tuple[str, str]]:
    """The pairs of :data:`QUESTIONS` of which both forecasts were made: only moving starts have the task's speeds."""
    made = set(models)
    return [pair for pair in QUESTIONS if made.issuperset(pair)]


def pair_table(
    rows: pd.DataFrame,
    rng: np.random.Generator,
    pairs: Sequence[tuple[str, str]] | None = None,
    column: str = "crps_s",
    resamples: int = RESAMPLES,
    alpha: float = 0.05,
) -> pd.DataFrame:
    """Tests of first - second (positive: the second is better), by scenario, hull and pair.

    p_<...>_holm are corrected over the pairs of all scenarios together, apart for all walks, for those inside the training
    dependencies and for those outside: the parts describe, and are no further questions. The exact test on n participants'
    means cannot fall below 2 / 2^n, whatever they did, and after the correction not below ``p_participants_holm_floor``.

    Parameters
    ----------
    rows : of :func:`walklab.evaluation.score_tables.walk_scores`, with scenario
    pairs : default: :func:`questions`

    Returns
    -------
    DataFrame: scenario, hull, first, second, walks, participants, zeros (left out of the walks' ranks), ties (walks that share
    the size of their difference), mean_difference_s (walks), participants_difference_s (every participant once), dz and
    rank_biserial, each with _low and _high, participants_better (for whom the second is); p_walks (the paper's test),
    p_participants (exact, on their means), mixed_s with _low, _high and p_mixed; p_<...>_holm; p_participants_holm_floor;
    power_are and, simulated, power_walks, power_participants, size_walks, size_participants, size_mixed and power_mixed, the
    last at :data:`STATED_EFFECT_S`. The mixed model and what is simulated are missing where fewer than :data:`LEAST_PEOPLE`
    people have walks.
    """
    found, answers = [], {}
    for (scenario, hull), part in parts(rows):
        for first, second in questions(part["model"].unique()) if pairs is None else pairs:
            table = paired(part[part["model"].isin([first, second])], first, second, column)
            row = {"scenario": scenario, "hull": hull, "first": first, "second": second}
            # Where all walks lie on one side of the training range, that part and all walks are one question.
            asked = (scenario, first, second, tuple(table["walk"]))
            if asked not in answers:
                answers[asked] = _tested(table, rng, resamples, alpha)
            found.append(row | answers[asked])
    frame = pd.DataFrame(found)
    for _, same in frame.groupby("hull", sort=False):
        for name in P_VALUES:
            frame.loc[same.index, f"{name}_holm"] = holm(same[name].to_numpy(dtype=float))
        floor = 2.0 ** (1 - same["participants"]) * len(same)
        frame.loc[same.index, "p_participants_holm_floor"] = floor.clip(upper=1.0)
    return frame


def holm(p: Array) -> Array:
    """Holm's step-down correction (statsmodels); missing values stay missing and do not count."""
    from statsmodels.stats.multitest import multipletests  # late: a second of imports

    result = np.full(len(p), np.nan)
    known = np.isfinite(p)
    if known.any():
        result[known] = multipletests(p[known], method="holm")[1]
    return result


def _tested(table: pd.DataFrame, rng: np.random.Generator, resamples: int, alpha: float) -> dict[str, float]:
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
    dz, effect = difference.mean() / max(float(difference.std()), 1e-9), _rank_biserial(difference)
    resampled = {
        "mean_difference_s": (difference.mean(), mean),
        "participants_difference_s": (means.mean(), counts @ means / clusters),
        "dz": (dz, mean / spread),
        "rank_biserial": (effect, _resampled_rank_biserial(difference, codes, counts)),
    }
    for name, (value, drawn) in resampled.items():
        low, high = interval(drawn, clusters)
        row |= {name: value, f"{name}_low": low, f"{name}_high": high}
    row["participants_better"] = int((means > 0).sum())
    row["p_walks"] = _signed_rank(difference[None], "asymptotic")[0]
    row["p_participants"] = _signed_rank(means[None], "exact" if clusters <= 50 else "asymptotic")[0]
    whole = clusters >= LEAST_PEOPLE
    estimate = intercept_of(table.assign(error=difference)) if whole else {}
    row |= {"mixed_s": estimate.get("estimate_s", np.nan), "mixed_s_low": estimate.get("low_s", np.nan)}
    row |= {"mixed_s_high": estimate.get("high_s", np.nan), "p_mixed": estimate.get("p", np.nan)}
    row["power_are"] = float(wilcoxon_power_are(dz, len(difference), alpha))
    for name, assumed in (("power", difference.mean()), ("size", 0.0)):
        shares = simulated_power(difference, codes, assumed, rng, alpha) if whole else (np.nan, np.nan)
        row[f"{name}_walks"], row[f"{name}_participants"] = shares
    own = rng.spawn(1)[0]  # the draws of everything else stay what they are
    shares = simulated_mixed_power(difference, codes, STATED_EFFECT_S, own, alpha) if whole else (np.nan, np.nan)
    row["size_mixed"], row["power_mixed"] = shares
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
