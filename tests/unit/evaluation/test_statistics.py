"""Descriptive statistics, intervals and mixed models on constructed trials."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.evaluation.mixed import intercept_of
from walklab.evaluation.statistics import by_dataset, describe, mixed_model, percentile_intervals, reductions, shapiro_wilk

Build = Callable[..., pd.DataFrame]


def test_description_equals_numpy_and_scipy_and_counts_what_did_not_arrive(make_trials: Build) -> None:
    errors = np.random.default_rng(0).normal(0.2, 0.5, 300)
    trials = make_trials({"P_Stat": errors})
    trials.loc[:4, "arrival"] = "timeout"
    trials.loc[:1, "inside_hull"] = False
    assert describe(trials)[["on_edge", "collided"]].iloc[0].tolist() == [0, 0]  # trials of an older run
    trials["on_edge"], trials["collided"] = trials.index < 7, trials.index == 2
    row = describe(trials).iloc[0]
    assert (row["on_edge"], row["collided"]) == (7, 1)
    size = np.abs(errors)
    np.testing.assert_allclose(
        row[["p05", "p25", "median", "p75", "p95"]].astype(float), np.quantile(size, [0.05, 0.25, 0.5, 0.75, 0.95])
    )
    assert row["iqr"] == pytest.approx(stats.iqr(size))
    assert (row["shapiro_w"], row["shapiro_p"]) == pytest.approx(tuple(stats.shapiro(size)))
    assert row["skew"] == pytest.approx(stats.skew(size))
    assert (row["n"], row["not_arrived"], row["outside_hull"]) == (300, 5, 2)
    assert row["median_signed_dt_s"] == pytest.approx(np.median(errors))


def test_normality_of_what_has_none_is_unknown() -> None:
    assert np.isnan(shapiro_wilk(np.ones(10))).all()
    assert np.isnan(shapiro_wilk(np.array([1.0, 2.0]))).all()


def test_more_values_than_the_test_takes_are_thinned() -> None:
    values = np.random.default_rng(1).normal(size=12_000)
    assert shapiro_wilk(values)[1] > 0.001
    assert shapiro_wilk(values**2)[1] < 1e-10


def test_percentile_intervals_hold_their_value(make_trials: Build) -> None:
    rng = np.random.default_rng(2)
    table = percentile_intervals(make_trials({"P_Stat": rng.normal(size=200), "P_Prob": rng.normal(size=200)}), rng, 300)
    assert list(table.groupby("model", sort=False).size()) == [6, 6]
    assert ((table["low"] <= table["value"]) & (table["value"] <= table["high"])).all()


def test_reduction_of_proportional_errors_is_exact_in_every_resample(make_trials: Build) -> None:
    errors = np.random.default_rng(3).lognormal(size=90)
    table = reductions(make_trials({"A": errors, "B": 0.85 * errors}), np.random.default_rng(0), [("A", "B")], 200)
    # Paired resampling: the same walks count for both models, so the ratio never varies.
    np.testing.assert_allclose(table[["value", "low", "high"]], 0.15, atol=1e-12)


def test_mixed_model_of_differences_widens_with_what_varies_between_people(make_trials: Build) -> None:
    rng = np.random.default_rng(4)
    count, people = 600, 12
    person = np.arange(count) % people
    first, noise = np.abs(rng.normal(1, 0.1, count)), rng.normal(0, 0.05, count)
    same = make_trials({"P_Stat": first, "P_Adapt": first - 0.2 + noise}, people)
    varied = make_trials({"P_Stat": first, "P_Adapt": first - 0.2 + rng.normal(0, 0.15, people)[person] + noise}, people)
    narrow, wide = (
        mixed_model(trials, [("P_Stat", "P_Adapt")]).query("fit == 'differences'").iloc[0] for trials in (same, varied)
    )
    assert narrow["estimate_s"] == pytest.approx(-0.2, abs=0.01)
    assert narrow["standard_error_s"] == pytest.approx(0.05 / np.sqrt(count), rel=0.3)
    assert wide["standard_error_s"] == pytest.approx(0.15 / np.sqrt(people), rel=0.5)
    assert wide["participant_sd_s"] == pytest.approx(0.15, rel=0.5)


def test_mixed_model_contrasts_are_differences_of_means(make_trials: Build) -> None:
    rng = np.random.default_rng(5)
    trials = make_trials({"P_Stat": rng.lognormal(size=200), "P_Adapt": rng.lognormal(size=200)})
    table = mixed_model(trials, []).set_index("term")
    means = trials.groupby("model")["abs_dt_s"].mean()
    assert table.loc["P_Adapt - P_Stat", "estimate_s"] == pytest.approx(means["P_Adapt"] - means["P_Stat"], abs=1e-6)


def test_mixed_model_of_equally_many_walks_is_the_t_test_of_participants_means() -> None:
    """Ten people with 30 walks each, who differ: REML's standard error is that of their means, with nine degrees of freedom."""
    rng = np.random.default_rng(6)
    people = np.repeat(np.arange(10), 30)
    error = 0.05 + rng.normal(0, 0.1, 10)[people] + rng.normal(0, 0.2, 300)
    row = intercept_of(pd.DataFrame({"participant": people, "error": error}))
    expected = stats.ttest_1samp(pd.Series(error).groupby(people).mean(), 0.0)
    low, high = expected.confidence_interval(0.95)
    assert row["p"] == pytest.approx(expected.pvalue, rel=1e-3)
    assert (row["low_s"], row["high_s"]) == (pytest.approx(low, rel=1e-3), pytest.approx(high, rel=1e-3))
    assert row["p"] > 1.05 * 2 * stats.norm.sf(abs(expected.statistic))  # what a normal tail would say


def test_data_sets_are_stacked_under_their_names() -> None:
    table = by_dataset({"scenario_1": pd.DataFrame({"value": [1.0]}), "scenario_2": pd.DataFrame({"value": [2.0, 3.0]})})
    assert list(table.columns) == ["dataset", "value"]
    assert list(table["dataset"]) == ["scenario_1", "scenario_2", "scenario_2"]
