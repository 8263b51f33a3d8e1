"""Signed-rank tests against scipy, power against published values."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.stats.power import TTestPower

from walklab.errors import InputError
from walklab.evaluation.signed_rank import RELATIVE_EFFICIENCY, compare_pairs, resampled_wilcoxon_p, wilcoxon_power_are


@pytest.mark.parametrize(
    ("dz", "n", "alpha", "power", "tolerance"),
    [
        # Reference values of the R package pwrss for power.np.wilcoxon(design = "paired", distribution = "normal"), whose
        # formulas its authors checked with G*Power. The last two are one-sided at 5 %: our test at 10 % less its other tail.
        (0.20, 208, 0.05, 0.800946514, 2e-9),
        (0.25, 106, 0.10, 0.80326579, 2e-5),
        (0.20, 164, 0.10, 0.80153238, 2e-5),
    ],
)
def test_power_equals_published_values(dz: float, n: int, alpha: float, power: float, tolerance: float) -> None:
    assert wilcoxon_power_are(dz, n, alpha) == pytest.approx(power, abs=tolerance)


@pytest.mark.parametrize("parent", sorted(RELATIVE_EFFICIENCY))
@pytest.mark.parametrize(("dz", "n"), [(0.05, 2000), (-0.3, 40), (0.9, 7)])
def test_power_is_that_of_a_t_test_on_the_effective_number_of_pairs(dz: float, n: int, parent: str) -> None:
    expected = TTestPower().power(abs(dz), n * RELATIVE_EFFICIENCY[parent], 0.05)
    assert wilcoxon_power_are(dz, n, parent=parent) == pytest.approx(expected, abs=1e-9)


def test_power_is_the_share_of_significant_tests() -> None:
    rng = np.random.default_rng(0)
    samples = rng.normal(0.4, 1.0, (2000, 40))
    rejected = np.mean([stats.wilcoxon(sample, method="approx").pvalue < 0.05 for sample in samples])
    assert rejected == pytest.approx(wilcoxon_power_are(0.4, 40), abs=0.03)


def test_power_runs_from_the_level_to_one_without_gaps() -> None:
    power = wilcoxon_power_are(np.linspace(0, 5, 200), 2000)
    assert power[0] == pytest.approx(0.05)
    assert power[-1] == 1.0
    assert (np.diff(power) >= -1e-12).all()


def test_unknown_parent_is_refused() -> None:
    with pytest.raises(InputError, match="parent distribution 'cauchy'"):
        wilcoxon_power_are(0.2, 20, parent="cauchy")


def test_table_equals_scipy(make_trials: Callable[..., pd.DataFrame]) -> None:
    rng = np.random.default_rng(1)
    first, second = np.abs(rng.normal(0, 1, 120)), np.abs(rng.normal(0, 0.8, 120))
    first, second = np.round(first * 60) / 60, np.round(second * 60) / 60  # multiples of the step: zeros and ties
    row = compare_pairs(make_trials({"A": first, "B": second}), rng, [("A", "B")], resamples=200).iloc[0]
    difference = np.round(first - second, 9)
    expected = stats.wilcoxon(difference, correction=True)
    assert (row["w"], row["p"]) == pytest.approx((expected.statistic, expected.pvalue))
    kept = difference[difference != 0]
    ranks = stats.rankdata(np.abs(kept))
    assert row["rank_biserial"] == pytest.approx(ranks @ np.sign(kept) / ranks.sum())
    larger = (first[:, None] > second).mean() + 0.5 * (first[:, None] == second).mean()
    assert row["cles"] == pytest.approx(larger)
    assert row["zeros"] == (difference == 0).sum()
    sizes = pd.Series(np.abs(kept)).value_counts()
    assert row["ties"] == sizes[sizes > 1].sum() > 0
    assert row["power_low"] <= row["power"] <= row["power_high"]


def test_ties_are_those_of_the_steps_not_of_the_rounding(make_trials: Callable[..., pd.DataFrame]) -> None:
    captured = np.random.default_rng(2).uniform(1, 3, 50)
    simulated = np.ceil(captured * 60) / 60
    row = compare_pairs(
        make_trials({"A": simulated + 2 / 60 - captured, "B": simulated + 1 / 60 - captured}),
        np.random.default_rng(0),
        [("A", "B")],
        resamples=50,
    ).iloc[0]
    assert row["ties"] == 50


def test_equal_models_are_no_evidence(make_trials: Callable[..., pd.DataFrame]) -> None:
    errors = np.linspace(0, 1, 20)
    row = compare_pairs(make_trials({"A": errors, "B": errors}), np.random.default_rng(0), [("A", "B")], resamples=50).iloc[0]
    assert (row["p"], row["rank_biserial"], row["cles"], row["zeros"]) == (1.0, 0.0, 0.5, 20)
    assert row["power"] == pytest.approx(0.05)


def test_resampled_p_equals_scipy_on_the_repeated_differences() -> None:
    rng = np.random.default_rng(3)
    difference = np.round(rng.normal(0.3, 1, 60), 1)
    codes = rng.integers(0, 5, 60)
    counts = np.array([[1, 1, 1, 1, 1], [2, 0, 1, 1, 1], [0, 0, 3, 2, 0]])
    found = resampled_wilcoxon_p(difference, codes, counts)
    for p, count in zip(found, counts, strict=True):
        repeated = np.repeat(difference, count[codes])
        assert p == pytest.approx(stats.wilcoxon(repeated, correction=True, method="asymptotic").pvalue, rel=1e-9)


def test_a_model_that_is_missing_is_named(make_trials: Callable[..., pd.DataFrame]) -> None:
    trials = make_trials({"A": np.ones(4)})
    with pytest.raises(InputError, match="model B has no rows"):
        compare_pairs(trials, np.random.default_rng(0), [("A", "B")])
    with pytest.raises(InputError, match="walk w0003 was not simulated by both"):
        compare_pairs(make_trials({"A": np.ones(4), "B": np.ones(3)}), np.random.default_rng(0), [("A", "B")])
