"""Size and power of the mixed model with a random intercept per participant, by simulation on the design at hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr

from walklab.steering.pace import fit_pace

Array = NDArray[np.float64]

REPEATS = 1000  # a share of 5 % is then known to 0.7 %
LARGEST_RATIO = 1e6  # of the variance between people to that within
COARSE, STEPS = 31, 24  # values of its logarithm that are tried first, and steps of the golden section about the best of them


def simulated_mixed_power(
    difference: Array, codes: NDArray[np.int64], effect: float, rng: np.random.Generator, alpha: float, repeats: int = REPEATS
) -> tuple[float, float]:
    """How often the mixed model rejects when the true mean is 0, and when it is ``effect``.

    Participants, walks of each and the variance components are those of the differences. Only what the model reads is
    drawn: the participants' means, normal, and the sum of squares within them, a multiple of chi-squared.

    Parameters
    ----------
    difference, codes : (N,) paired differences, and whose they are, as numbers from 0
    effect : in the unit of the differences
    """
    sizes = np.bincount(codes).astype(float)
    known = fit_pace(difference, [str(code) for code in codes])
    within, free = max(known.walk_sd, 1e-12), len(codes) - len(sizes)
    means = known.person_sd * rng.standard_normal((repeats, len(sizes)))
    means += within / np.sqrt(sizes) * rng.standard_normal((repeats, len(sizes)))
    squares = within**2 * (rng.chisquare(free, repeats) if free else np.zeros(repeats))
    # A true mean moves every estimate by as much, and leaves what varies alone: one fit tells both.
    mean, error = estimated(means, squares, sizes)
    size, power = ((p_of(mean + true, error, len(sizes)) < alpha).mean() for true in (0.0, effect))
    return float(size), float(power)


def estimated(means: Array, squares: Array, sizes: Array) -> tuple[Array, Array]:
    r"""Intercept of ``y ~ 1`` and its standard error, with a random intercept per participant, of many data sets at once.

    REML: with :math:`\lambda` the variance between people over that within and :math:`w_i = n_i / (1 + \lambda n_i)`, the
    least of :math:`(N - 1) \ln(S_w + \sum w_i (m_i - \mu)^2) + \sum \ln(1 + \lambda n_i) + \ln \sum w_i` (the restricted
    likelihood with mean and scale at their optimum).

    Parameters
    ----------
    means : (R, P) of each participant
    squares : (R,) sums of squares about them
    sizes : (P,) walks of each

    Returns
    -------
    (R,) estimates, (R,) standard errors
    """
    top = np.log(LARGEST_RATIO)
    grid = np.linspace(-top, top, COARSE)
    tried = np.stack([_criterion(np.full(len(means), at), means, squares, sizes) for at in grid])
    best = grid[tried.argmin(axis=0)]
    step = grid[1] - grid[0]
    low, high, golden = best - step, best + step, (np.sqrt(5) - 1) / 2
    for _ in range(STEPS):
        left, right = high - golden * (high - low), low + golden * (high - low)
        less = _criterion(left, means, squares, sizes) < _criterion(right, means, squares, sizes)
        low, high = np.where(less, low, left), np.where(less, right, high)
    # The smallest ratio tried is no variance between people.
    mean, scale, weights = _fit(np.exp((low + high) / 2), means, squares, sizes)
    return mean, np.sqrt(scale / weights.sum(axis=1))


def p_of(mean: Array, error: Array, people: int) -> Array:
    """Two-sided p by Student's t with (participants - 1) degrees of freedom, as in :mod:`walklab.evaluation.mixed`."""
    return np.asarray(2 * stdtr(people - 1, -np.abs(mean) / error))


def _fit(ratio: Array, means: Array, squares: Array, sizes: Array) -> tuple[Array, Array, Array]:
    """Mean, variance within and weights of the participants, (R,), (R,) and (R, P)."""
    weights = sizes / (1 + ratio[:, None] * sizes)
    mean = (weights * means).sum(axis=1) / weights.sum(axis=1)
    total = squares + (weights * (means - mean[:, None]) ** 2).sum(axis=1)
    return mean, total / (sizes.sum() - 1), weights


def _criterion(log_ratio: Array, means: Array, squares: Array, sizes: Array) -> Array:
    ratio = np.exp(log_ratio)
    _, scale, weights = _fit(ratio, means, squares, sizes)
    spread = np.log1p(ratio[:, None] * sizes).sum(axis=1)
    return np.asarray((sizes.sum() - 1) * np.log(scale) + spread + np.log(weights.sum(axis=1)))
