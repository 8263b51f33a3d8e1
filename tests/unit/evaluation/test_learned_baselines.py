"""What a sceptic would fit: forecasts that hold where their assumptions do, and a Gaussian process by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.gaussian_process import GaussianProcessRegressor

from walklab.evaluation.learned_baselines import (
    _fit_kernel,
    fit_gaussian_process,
    personal_regression,
    quantile_regression,
    with_residuals,
)


def people(count: int, walks: int, rng: np.random.Generator, prefix: str = "p") -> tuple[np.ndarray, list[str], np.ndarray]:
    """Dependencies (length, curvature, a height for each person), owners, and which person each walk is of."""
    number = np.arange(count * walks) % count
    heights = rng.normal(1.75, 0.08, count)
    vectors = np.column_stack([rng.uniform(1, 5, len(number)), rng.uniform(0, 1, len(number)), heights[number]])
    return vectors, [f"{prefix}{i}" for i in number], number


def held(members: np.ndarray, captured: np.ndarray) -> float:
    low, high = np.quantile(members, [0.05, 0.95], axis=1)
    return float(np.mean((low <= captured) & (captured <= high)))


def test_regressions_are_calibrated_where_their_assumptions_hold() -> None:
    rng = np.random.default_rng(8)
    x, wanted = rng.uniform(0, 3, (400, 2)), rng.uniform(0.2, 2.8, (2000, 2))
    truth = lambda d: 2 + 0.8 * d[:, 0]  # noqa: E731
    y, captured = truth(x) + rng.normal(0, 0.2, 400), truth(wanted) + rng.normal(0, 0.2, 2000)
    members = quantile_regression(y, x, wanted)
    assert 0.86 < held(members, captured) < 0.94
    assert np.abs(np.median(members, axis=1) - truth(wanted)).mean() < 0.06
    owners = [f"p{i % 40}" for i in range(400)]
    asked_owners = [f"q{i % 40}" for i in range(2000)]
    mine, theirs = (rng.normal(0, 0.5, 40)[[int(name[1:]) for name in names]] for names in (owners, asked_owners))
    members = personal_regression(y + mine, x, owners, captured + theirs, wanted, asked_owners)
    late = np.arange(2000) > 800
    assert np.abs(np.median(members, axis=1) - captured - theirs)[late].mean() < 0.2  # the noise alone is 0.16
    spread = with_residuals([2.0], rng.normal(0.1, 0.2, 5000), 400)[0]
    assert spread.mean() == pytest.approx(2.1, abs=0.01)
    assert spread.std() == pytest.approx(0.2, abs=0.01)


def test_gaussian_process_covers_new_people_and_leaves_out_what_only_tells_persons_apart() -> None:
    """A curved truth and people with a pace of their own: white noise alone would take their walks as independent."""
    rng = np.random.default_rng(3)
    truth = lambda d: 0.3 + 0.8 * np.log(d[:, 0]) + 0.2 * np.sin(3 * d[:, 1])  # noqa: E731
    (x, owners, who), (wanted, _, whose) = people(25, 12, rng), people(100, 10, rng, "q")
    paces = rng.normal(0, 0.08, 25)
    paces -= np.polyval(np.polyfit(x[:25, 2], paces, 2), x[:25, 2])  # the height tells nothing, by chance either
    times = np.exp(truth(x) + paces[who] + rng.normal(0, 0.04, 300))
    captured = np.exp(truth(wanted) + rng.normal(0, 0.08, 100)[whose] + rng.normal(0, 0.04, 1000))
    fitted = fit_gaussian_process(times, x, owners, np.arange(150))
    assert fitted.columns == (0, 1)
    assert fitted.effect.person_sd == pytest.approx(0.08, rel=0.4)
    members = fitted.new_person(wanted)
    assert 0.84 < held(members, captured) < 0.96
    assert np.abs(np.log(np.median(members, axis=1)) - truth(wanted)).mean() < 0.04
    # All walks are conditioned on, not only the few that the kernel is fitted to.
    other = times.copy()
    other[200:] *= 1.2
    assert np.median(fit_gaussian_process(other, x, owners, np.arange(150)).new_person(wanted) / members) > 1.02
    # Where the height does tell the pace, it is among the inputs.
    tall = times * np.exp(-3 * (x[:, 2] - 1.75))
    assert fit_gaussian_process(tall, x, owners, np.arange(150)).columns == (0, 1, 2)


def test_people_are_left_out_of_the_process_as_by_conditioning_on_the_others() -> None:
    rng = np.random.default_rng(5)
    x, owners, who = people(6, 8, rng)
    times = 0.5 * x[:, 0] + rng.normal(0, 0.3, 6)[who] + rng.normal(0, 0.1, 48)
    kernel, effect, scores = _fit_kernel(x[:, :2], times, np.array(owners))
    at, standard = (x[:, :2] - x[:, :2].mean(axis=0)) / x[:, :2].std(axis=0), (times - times.mean()) / times.std()
    off = np.empty(48)
    for person in range(6):
        own = who == person
        others = GaussianProcessRegressor(kernel, optimizer=None).fit(at[~own], standard[~own])
        off[own] = (standard[own] - others.predict(at[own])) * times.std()
    means = np.array([off[who == person].mean() for person in range(6)])
    within = np.mean([off[who == person].var(ddof=1) for person in range(6)])
    assert effect.mean == pytest.approx(means.mean(), abs=1e-9)
    assert effect.walk_sd == pytest.approx(np.sqrt(within))
    assert effect.person_sd == pytest.approx(np.sqrt(max(means.var(ddof=1) - within / 8, 0)))
    spread = np.hypot(effect.person_sd, effect.walk_sd)
    each = -np.log(spread) - off**2 / spread**2 / 2
    assert scores == pytest.approx([each[who == person].mean() for person in range(6)])
