"""The mixed model of many data sets at once: against statsmodels, and its size where theory knows it."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.evaluation.mixed import intercept_of
from walklab.evaluation.mixed_power import estimated, p_of, simulated_mixed_power


@pytest.mark.parametrize("person_sd", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("sizes", [(8, 8, 8, 8), (3, 20, 7, 11, 2, 15)])
def test_p_is_that_of_statsmodels(person_sd: float, sizes: tuple[int, ...]) -> None:
    rng = np.random.default_rng(len(sizes))
    codes = np.repeat(np.arange(len(sizes)), sizes)
    data = 0.4 + person_sd * rng.standard_normal((3, len(sizes)))[:, codes] + rng.standard_normal((3, len(codes)))
    means = np.stack([np.bincount(codes, row) / np.bincount(codes) for row in data])
    squares = ((data - means[:, codes]) ** 2).sum(axis=1)
    expected = [intercept_of(pd.DataFrame({"participant": codes.astype(str), "error": row}))["p"] for row in data]
    np.testing.assert_allclose(p_of(*estimated(means, squares, np.array(sizes, dtype=float)), len(sizes)), expected, rtol=5e-3)


def test_of_equally_many_walks_it_is_the_t_test_of_the_means() -> None:
    means = np.random.default_rng(1).normal(0.3, 1, (50, 6))
    found = p_of(*estimated(means, np.full(50, 6.0), np.full(6, 20.0)), 6)  # the means vary far more than their walks explain
    np.testing.assert_allclose(found, stats.ttest_1samp(means, 0, axis=1).pvalue, rtol=1e-5)


def test_size_is_alpha_and_power_that_of_the_t_test() -> None:
    rng, people = np.random.default_rng(2), 10
    codes = np.repeat(np.arange(people), 40)
    spread = stats.norm.ppf((np.arange(people) + 0.5) / people)
    spread /= spread.std(ddof=1)
    difference = spread[codes] + np.tile(np.linspace(-0.1, 0.1, 40), people)
    found = simulated_mixed_power(difference, codes, 1.0, rng, 0.05, 8000)
    assert found[0] == pytest.approx(0.05, abs=0.01)
    noncentral = stats.nct(people - 1, np.sqrt(people))
    reach = stats.t.ppf(0.975, people - 1)
    power = noncentral.sf(reach) + noncentral.cdf(-reach)
    assert found[1] == pytest.approx(power, abs=0.02)
