"""Regression of log T: what made the walks is found, new people are covered, earlier walks inform, height must earn its place."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from walklab.evaluation.log_regression import fit_log_regression, log_score, simplest

PEOPLE, WALKS = 40, 15


def study(rng: np.random.Generator, height: float = 0.0, square: float = 0.0) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Times of a power law with people's paces, dependencies (length, curvature, height), owners."""
    number = np.arange(PEOPLE * WALKS) % PEOPLE
    heights = rng.normal(1.75, 0.08, PEOPLE)[number]
    vectors = np.column_stack([rng.uniform(1, 4, len(number)), rng.uniform(0, 1, len(number)), heights])
    logs = (
        0.4 + 0.8 * np.log(vectors[:, 0]) + 0.3 * vectors[:, 1] + height * (heights - 1.75) + square * np.log(vectors[:, 0]) ** 2
    )
    logs += rng.normal(0, 0.08, PEOPLE)[number] + rng.normal(0, 0.03, len(number))
    return np.exp(logs), vectors, [f"p{i}" for i in number]


@pytest.mark.parametrize("degree", [1, 2])
def test_new_people_are_covered_and_earlier_walks_sharpen(degree: int) -> None:
    rng = np.random.default_rng(2)
    fitted, asked = fit_log_regression(*study(rng), degree=degree), study(rng)
    for members, sharp in ((fitted.new_person(asked[1]), False), (fitted.after_earlier(asked[1], asked[0], asked[2]), True)):
        low, high = np.quantile(members, [0.05, 0.95], axis=1)
        assert 0.84 < np.mean((low <= asked[0]) & (asked[0] <= high)) < 0.96
        late = np.arange(len(asked[0])) >= 5 * PEOPLE
        width = np.log(high / low)[late].mean() / (2 * stats.norm.ppf(0.95))
        assert width == pytest.approx(0.032 if sharp else 0.085, rel=0.2)


def test_height_is_taken_only_where_it_forecasts_others() -> None:
    for slope, columns in ((0.0, (0, 1)), (-2.0, (0, 1, 2))):
        assert fit_log_regression(*study(np.random.default_rng(4), slope)).columns == columns
    # With one walk each everything belongs to a person: there is nothing to choose from.
    times, vectors, _ = study(np.random.default_rng(4))
    alone = fit_log_regression(times[:20], vectors[:20], [f"p{i}" for i in range(20)])
    assert alone.columns == (0, 1, 2)
    assert alone.effect.walk_sd == 0


def test_a_square_is_found_and_held_beyond_training_while_the_power_goes_on() -> None:
    times, vectors, owners = study(np.random.default_rng(6), square=-0.2)
    fitted = fit_log_regression(times, vectors, owners, 2)
    truth = lambda length: 0.4 + 0.8 * np.log(length) + 0.3 * 0.5 - 0.2 * np.log(length) ** 2  # noqa: E731
    lengths = np.array([1.2, 2.0, 3.8])
    found = fitted.fitted(np.column_stack([lengths, np.full(3, 0.5), np.full(3, 1.75)])) + fitted.effect.mean
    np.testing.assert_allclose(found, truth(lengths), atol=0.05)
    beyond = fitted.fitted([[8.0, 0.5, 1.75], [16.0, 0.5, 1.75], [32.0, 0.5, 1.75]])
    assert np.ptp(np.diff(beyond)) == pytest.approx(0, abs=1e-12)


def test_a_new_persons_spread_is_the_textbooks() -> None:
    """Three people, who walk exactly alike each time: Student's t(2) with s sqrt(1 + 1/3)."""
    vectors = np.column_stack([np.tile([1.0, 2.0, 3.0, 4.0], 3), np.tile([0.0, 0.3, 0.1, 0.2], 3)])
    paces = np.repeat([0.1, 0.2, 0.6], 4)
    fitted = fit_log_regression(np.exp(paces + np.log(vectors[:, 0])), vectors, list("aaaabbbbcccc"))
    members = np.log(fitted.new_person([[2.0, 0.2]], 40)[0]) - np.log(2.0)
    wanted = 0.3 + np.std([0.1, 0.2, 0.6], ddof=1) * np.sqrt(4 / 3) * stats.t.ppf((np.arange(40) + 0.5) / 40, 2)
    np.testing.assert_allclose(members, wanted, rtol=1e-6)


def test_log_score_is_the_normal_density_up_to_a_constant() -> None:
    off = np.array([0.1, -0.3])
    assert log_score(off, 0.2) == pytest.approx(stats.norm.logpdf(off, 0, 0.2).mean() + 0.5 * np.log(2 * np.pi))


def test_an_input_comes_in_only_if_it_gains_more_than_one_standard_error() -> None:
    choices, before = [(0, 1), (0, 1, 2)], np.zeros(16)
    by_chance = np.tile([0.3, -0.1], 8) - 0.09  # mean 0.01, standard error 0.05
    assert simplest(choices, [before, by_chance]) == 0
    assert simplest(choices, [before, by_chance + 0.05]) == 1
    assert simplest(choices[:1], [before]) == 0
