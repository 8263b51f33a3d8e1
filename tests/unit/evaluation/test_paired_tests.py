"""Tests that know who walked: simulated power against the analytic one, size under clusters, Holm by its definition."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.evaluation.paired_tests import holm, pair_table, simulated_power
from walklab.evaluation.signed_rank import wilcoxon_power_are


def alternating(count: int, people: int, effect: float, sd: float) -> tuple[np.ndarray, np.ndarray]:
    """Differences with exactly this mean and spread, all participants alike."""
    quantiles = stats.norm.ppf((np.arange(count) + 0.5) / count)
    return effect + sd * quantiles / quantiles.std(), np.arange(count) % people


def test_simulated_power_is_that_of_the_are_method_where_walks_are_independent() -> None:
    """dz = 0.3 on 60 pairs, normal: 0.60 by G*Power's method."""
    difference, codes = alternating(60, 6, 0.3, 1.0)
    walks, _ = simulated_power(difference, codes, 0.3, np.random.default_rng(1), 0.05, repeats=3000)
    assert walks == pytest.approx(wilcoxon_power_are(0.3, 60), abs=0.04)


def test_size_is_alpha_without_clusters_and_only_for_participants_with_them() -> None:
    rng = np.random.default_rng(2)
    difference, codes = alternating(400, 10, 0.0, 1.0)
    walks, people = simulated_power(difference, codes, 0.0, rng, 0.05, repeats=2000)
    assert walks == pytest.approx(0.05, abs=0.02)
    assert people == pytest.approx(0.05, abs=0.02)
    clustered = difference + np.linspace(-1, 1, 10)[codes]
    walks, people = simulated_power(clustered, codes, 0.0, rng, 0.05, repeats=2000)
    assert walks > 0.3  # the paper's test takes people's differences for an effect
    assert people == pytest.approx(0.05, abs=0.02)


def test_holm_by_its_definition() -> None:
    p = np.array([0.01, 0.04, np.nan, 0.03, 0.5])
    np.testing.assert_allclose(holm(p), [0.04, 0.09, np.nan, 0.09, 0.5])


def test_table_counts_zeros_and_ties_and_finds_a_difference_of_everybody() -> None:
    rng = np.random.default_rng(0)
    count = 200
    walks = pd.DataFrame({"walk": np.arange(count), "participant": np.arange(count) % 10, "scenario": "s"})
    walks["inside_hull"] = np.arange(count) % 4 > 0
    better = rng.uniform(0.1, 0.2, count).round(6)
    worse = better + rng.choice([0.0, 0.05, 0.1], count, p=[0.1, 0.3, 0.6])
    rows = pd.concat([walks.assign(model="a", crps_s=worse), walks.assign(model="b", crps_s=better)], ignore_index=True)
    table = pair_table(rows, rng, (("a", "b"), ("b", "a")), resamples=300).set_index(["hull", "first"])
    row = table.loc[("all", "a")]
    zeros = int((worse == better).sum())
    assert (row["zeros"], row["ties"]) == (zeros, count - zeros)
    assert row["rank_biserial"] == 1.0
    assert table.loc[("all", "b"), "rank_biserial"] == -1.0
    assert row["mean_difference_s"] == pytest.approx((worse - better).mean(), abs=1e-6)
    assert row["mean_difference_s_low"] > 0
    assert row["p_participants"] == pytest.approx(2 / 2**10)  # exact: all ten differences have the same sign
    assert row["p_participants_holm"] == pytest.approx(2 * row["p_participants"])
    assert row["mixed_s_low"] < row["mean_difference_s"] < row["mixed_s_high"]
    assert table.loc[("inside", "a"), "walks"] == 150
    assert np.isnan(table.loc[("outside", "a"), "mixed_s"])
