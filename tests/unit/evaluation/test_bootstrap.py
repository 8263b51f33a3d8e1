"""Cluster bootstrap against numpy on repeated data, and its coverage on a known distribution."""

import numpy as np
import pytest

from walklab.evaluation.bootstrap import cluster_codes, cluster_counts, interval, resampled_quantiles, resampled_sums


def test_resampled_quantiles_equal_numpy_on_the_repeated_values() -> None:
    rng = np.random.default_rng(0)
    values = np.round(rng.normal(size=60), 1)  # with ties
    codes, clusters = cluster_codes(rng.choice(["a", "b", "c", "d"], 60))
    counts = cluster_counts(clusters, 300, rng)
    levels = [0.0, 0.05, 0.31, 0.5, 0.95, 1.0]
    found = resampled_quantiles(values, codes, counts, levels)
    for row, count in zip(found, counts, strict=True):
        np.testing.assert_allclose(row, np.quantile(np.repeat(values, count[codes]), levels), atol=1e-12)


def test_resampled_sums_equal_the_sums_of_the_repeated_values() -> None:
    rng = np.random.default_rng(1)
    values = rng.normal(size=(40, 3))
    codes, clusters = cluster_codes(rng.integers(0, 6, 40))
    counts = cluster_counts(clusters, 20, rng)
    expected = [np.repeat(values, count[codes], axis=0).sum(axis=0) for count in counts]
    np.testing.assert_allclose(resampled_sums(values, codes, counts), expected, atol=1e-12)


def test_intervals_carry_no_float_noise() -> None:
    low, high = interval(np.full((50, 2), [5.1e-15, 0.1 + 0.2]) * np.array([-1.0, 1.0]), 12)
    assert (low.tolist(), high.tolist()) == ([0.0, 0.3], [0.0, 0.3])
    assert not np.signbit(low).any()
    assert np.isnan(interval(np.ones((50, 2)), 1)).all()


def test_interval_covers_the_median_of_a_clustered_population_about_95_times_in_100() -> None:
    rng = np.random.default_rng(2)
    clusters, per_cluster, studies = 10, 15, 400
    codes = np.repeat(np.arange(clusters), per_cluster)
    covered = 0
    for _ in range(studies):
        values = rng.normal(size=clusters)[codes] + rng.normal(size=len(codes))  # median of the population: 0
        draws = resampled_quantiles(values, codes, cluster_counts(clusters, 400, rng), [0.5])
        low, high = interval(draws[:, 0], clusters)
        covered += low <= 0 <= high
    # Standard error 1.1 %; resampling walks instead of participants covers about 60 %.
    assert 0.91 <= covered / studies <= 0.985


def test_interval_of_one_cluster_is_unknown() -> None:
    low, high = interval(np.zeros((10, 2)), 1)
    assert np.isnan([low, high]).all()


@pytest.mark.parametrize("clusters", [2, 7])
def test_every_resample_draws_as_many_clusters_as_there_are(clusters: int) -> None:
    counts = cluster_counts(clusters, 50, np.random.default_rng(3))
    assert (counts.sum(axis=1) == clusters).all()
