"""Tests that know who walked: simulated power against the analytic one, size under clusters, Holm by its definition."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.evaluation import forecasts
from walklab.evaluation.paired_tests import holm, pair_table, questions, simulated_power
from walklab.evaluation.signed_rank import wilcoxon_power_are
from walklab.evaluation.subject_scores import OWN_MAP


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
    outside = table.loc[("outside", "a")]
    assert outside["mixed_s_low"] < outside["mean_difference_s"] < outside["mixed_s_high"]
    # Five people: their exact test cannot go below 2 / 2^5, so it never rejects.
    assert (outside["participants"], outside["power_participants"], outside["power_walks"]) == (5, 0.0, 1.0)


def two_models(participants: list[str], scenario: str, seed: int) -> pd.DataFrame:
    """Two forecasts of every participant's walks, the second better."""
    rng = np.random.default_rng(seed)
    names = [f"{scenario}/{number}" for number in range(len(participants))]
    walks = pd.DataFrame({"walk": names, "participant": participants, "scenario": scenario, "inside_hull": True})
    worse = rng.uniform(0.2, 0.4, len(walks))
    models = {"regression": worse, "P_Prob (extended)": worse - rng.uniform(0.01, 0.1, len(walks))}
    return pd.concat([walks.assign(model=name, crps_s=values) for name, values in models.items()], ignore_index=True)


def test_holm_is_over_all_scenarios_and_the_floor_of_the_exact_test_is_told() -> None:
    people = [f"p{number % 6}" for number in range(60)]
    rows = pd.concat([two_models(people, name, seed) for seed, name in enumerate(("one", "two"))])
    table = pair_table(rows, np.random.default_rng(0), resamples=100).query("hull == 'all'")
    assert list(zip(table["first"], table["second"], strict=True)) == [("regression", "P_Prob (extended)")] * 2
    np.testing.assert_allclose(table["p_mixed_holm"], holm(table["p_mixed"].to_numpy()))
    np.testing.assert_allclose(table["p_participants"], 2 / 2**6)  # for all six the second is better
    np.testing.assert_allclose(table["p_participants_holm_floor"], 2 * 2 / 2**6)
    np.testing.assert_allclose(table["p_participants_holm"], table["p_participants_holm_floor"])
    assert (table["participants_better"] == 6).all()


def test_every_participant_counts_once_in_the_difference_of_participants() -> None:
    rows = two_models(["a"] * 30 + ["b", "c"], "one", 3)
    row = pair_table(rows, np.random.default_rng(0), resamples=100).iloc[0]
    wide = rows.pivot_table(index=["walk", "participant"], columns="model", values="crps_s")
    less = wide["regression"] - wide["P_Prob (extended)"]
    assert row["participants_difference_s"] == pytest.approx(less.groupby("participant").mean().mean(), abs=1e-8)
    assert row["mean_difference_s"] == pytest.approx(less.mean(), abs=1e-8)


def test_two_people_say_nothing_of_the_variance_between_people() -> None:
    row = pair_table(two_models(["a", "b"] * 20, "one", 4), np.random.default_rng(0), resamples=100).iloc[0]
    assert row[["mixed_s", "p_mixed", "power_participants", "size_walks"]].isna().all()
    assert np.isfinite(row["p_walks"])


def test_the_questions_hold_every_baseline_against_both_learned_models() -> None:
    names = {value for name, value in vars(forecasts).items() if name.isupper() and isinstance(value, str)}
    ours = {forecasts.CALIBRATED, forecasts.EXTENDED}
    baselines = names - set(forecasts.INFORMED) - ours - {forecasts.LITERAL, OWN_MAP}
    asked = set(questions(names | {OWN_MAP}))
    assert asked >= {(baseline, model) for baseline in baselines for model in ours}
    regressions = {forecasts.REGRESSION_EARLIER, forecasts.LOG_REGRESSION_EARLIER, forecasts.QUADRATIC_REGRESSION_EARLIER}
    assert asked >= {(name, forecasts.EXTENDED_EARLIER) for name in regressions}
    assert questions({"P_Stat"}) == []


def test_trials_are_tested_by_their_error_with_holm_and_the_split() -> None:
    rows = two_models([f"p{number % 6}" for number in range(60)], "one", 5).rename(columns={"crps_s": "abs_dt_s"})
    rows["inside_hull"] = rows["walk"].str[-1].astype(int) > 3
    rows = pd.concat([rows, rows.assign(scenario="two", abs_dt_s=rows["abs_dt_s"] ** 2)])
    pair = [("regression", "P_Prob (extended)")]
    table = pair_table(rows, np.random.default_rng(0), pair, "abs_dt_s", resamples=100)
    assert set(zip(table["scenario"], table["hull"], strict=True)) == {
        (name, hull) for name in ("one", "two") for hull in ("all", "inside", "outside")
    }
    for _, same in table.groupby("hull"):
        np.testing.assert_allclose(same["p_mixed_holm"], holm(same["p_mixed"].to_numpy()))
    assert table["size_mixed"].between(0.0, 0.12).all()
    assert (table["power_mixed"] >= table["size_mixed"]).all()
