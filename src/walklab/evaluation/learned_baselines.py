"""What a sceptic would fit to the same dependencies instead: quantile regression, a Gaussian process, personal intercepts.

The regressions of log T are in :mod:`walklab.evaluation.log_regression`. Like the other baselines
(:mod:`walklab.evaluation.baselines`) each returns equally likely travel times, (N, members), seconds.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from walklab.evaluation.baselines import levels
from walklab.evaluation.log_regression import column_choices, log_members, log_score, logged, simplest
from walklab.steering.pace import PaceEffect, fit_pace

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

FITTED_LEVELS = (0.025, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.975)


def designs(vectors: ArrayLike, asked_vectors: ArrayLike) -> tuple[Array, Array]:
    """Known and asked dependencies, standardised by the known ones; those without spread in training are left out."""
    known, asked = np.atleast_2d(np.asarray(vectors, dtype=float)), np.atleast_2d(np.asarray(asked_vectors, dtype=float))
    varies = known.std(axis=0) > 1e-9 * np.maximum(np.abs(known).max(axis=0), 1.0)
    centre, scale = known[:, varies].mean(axis=0), known[:, varies].std(axis=0)
    return (known[:, varies] - centre) / scale, (asked[:, varies] - centre) / scale


def quantile_regression(durations_s: ArrayLike, vectors: ArrayLike, asked_vectors: ArrayLike, members: int = 200) -> Array:
    """Linear quantiles ``q_p(T) = b_p . (1, d)`` (statsmodels ``QuantReg``), fitted at nine levels.

    Quantiles that cross are sorted; between the levels they are interpolated, beyond the outermost held.
    """
    from statsmodels.regression.quantile_regression import QuantReg  # late: a second of imports
    from statsmodels.tools.tools import add_constant

    known, asked = designs(vectors, asked_vectors)
    design, wanted = add_constant(known, has_constant="add"), add_constant(asked, has_constant="add")
    with warnings.catch_warnings():
        # Captured times are multiples of a frame; among ties the iteration may alternate between equally good lines.
        warnings.simplefilter("ignore")
        model = QuantReg(np.asarray(durations_s, dtype=float), design)
        fitted = np.sort(np.stack([wanted @ model.fit(q=level).params for level in FITTED_LEVELS], axis=1), axis=1)
    return np.maximum([np.interp(levels(members), FITTED_LEVELS, row) for row in fitted], 0.0)


@dataclass(frozen=True)
class GaussianProcess:
    """A Gaussian process of log T, and how people depart from it.

    Attributes
    ----------
    columns : dependencies among the inputs
    centre, scale : (P,) of each input
    process : of the standardised inputs (scikit-learn), conditioned on all training walks
    noise : its variance of single walks, as it would be if all were of different people
    effect : of people, from walks whose person was left out
    """

    columns: tuple[int, ...]
    centre: Array
    scale: Array
    process: Any
    noise: float
    effect: PaceEffect

    def new_person(self, vectors: ArrayLike, members: int = 200) -> Array:
        """(W, members) travel times of somebody new, seconds: how unsure the process is of its mean, a person, and a walk."""
        inputs = (logged(vectors)[:, list(self.columns)] - self.centre) / self.scale
        mean, sd = self.process.predict(inputs, return_std=True)
        # Of people left out, the spread holds already how unsure the mean of the others is.
        spread = np.sqrt(np.maximum(sd**2 - self.noise, 0.0) + self.effect.person_sd**2)
        return log_members(mean, (np.zeros(len(mean)), spread), self.effect, members)


def fit_gaussian_process(
    durations_s: ArrayLike, vectors: ArrayLike, participants: Sequence[str], few: Rows | None = None
) -> GaussianProcess:
    """A Gaussian process of log T with one length scale per dependency and white noise (scikit-learn).

    The kernel is a maximum of the marginal likelihood of a few walks, from one start. Whether dependencies that belong to a
    person are among its inputs is chosen by the log score of participants left out of these (by the likelihood itself they
    always would be: they tell persons apart), see :func:`walklab.evaluation.log_regression.simplest`. The process is then
    conditioned on all walks.

    Parameters
    ----------
    durations_s, vectors, participants : (W,), (W, D), (W,) of the training walks; the length is the first dependency
    few : rows of the walks that the kernel is fitted to; None: all
    """
    from sklearn.gaussian_process import GaussianProcessRegressor  # late: half a second of imports

    times, owners = np.log(np.asarray(durations_s, dtype=float)), np.asarray(participants, dtype=str)
    inputs = logged(vectors)
    rows = np.arange(len(times)) if few is None else few
    choices = column_choices(inputs, owners.tolist())
    found = [_fit_kernel(inputs[rows][:, list(columns)], times[rows], owners[rows]) for columns in choices]
    taken = simplest(choices, [scores for _, _, scores in found])
    columns, (kernel, effect, _) = choices[taken], found[taken]
    chosen = inputs[:, list(columns)]
    centre, scale = chosen[rows].mean(axis=0), chosen[rows].std(axis=0)
    # Nothing more is learned here: one factorisation for all walks.
    process = GaussianProcessRegressor(kernel, optimizer=None, normalize_y=True).fit((chosen - centre) / scale, times)
    return GaussianProcess(columns, centre, scale, process, float(kernel.k2.noise_level * times.var()), effect)


def _fit_kernel(inputs: Array, times: Array, owners: NDArray[np.str_]) -> tuple[Any, PaceEffect, Array]:
    """The kernel, people's departures from a process that was conditioned on the others, and (people,) their log scores."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    at = (inputs - inputs.mean(axis=0)) / inputs.std(axis=0)
    start = ConstantKernel(4.0) * RBF(np.full(at.shape[1], 3.0), (0.1, 100)) + WhiteKernel(0.1, (1e-4, 10))
    with warnings.catch_warnings():
        # A length scale at its bound says that the dependency does not matter.
        warnings.simplefilter("ignore", ConvergenceWarning)
        model = GaussianProcessRegressor(start, normalize_y=True).fit(at, times)
    precision = np.linalg.inv(model.kernel_(at))
    pull = precision @ ((times - times.mean()) / times.std())
    off = np.empty(len(times))
    for owner in np.unique(owners):
        own = np.flatnonzero(owners == owner)
        # Of a normal vector: what a block is off by, given all others (Rasmussen & Williams 2006, section 5.4.2, by blocks).
        off[own] = np.linalg.solve(precision[np.ix_(own, own)], pull[own]) * times.std()
    effect = fit_pace(off, owners.tolist())
    spread = float(np.hypot(effect.person_sd, effect.walk_sd))
    return model.kernel_, effect, np.array([log_score(off[owners == owner], spread) for owner in np.unique(owners)])


def personal_regression(
    durations_s: ArrayLike,
    vectors: ArrayLike,
    participants: Sequence[str],
    asked_durations_s: ArrayLike,
    asked_vectors: ArrayLike,
    asked_participants: Sequence[str],
    members: int = 200,
) -> Array:
    """Regression of T with a random intercept per person, which the person's *earlier* walks inform.

    Ordinary least squares on the dependencies; residuals split into persons and walks (:func:`walklab.steering.pace.fit_pace`);
    forecast: fitted value + posterior of the person's intercept + a walk's own spread. That of log T is
    :meth:`walklab.evaluation.log_regression.LogRegression.after_earlier`.
    """
    from statsmodels.regression.linear_model import OLS  # late: a second of imports
    from statsmodels.tools.tools import add_constant

    known, asked = designs(vectors, asked_vectors)
    fit = OLS(np.asarray(durations_s, dtype=float), add_constant(known, has_constant="add")).fit()
    fitted = fit.predict(add_constant(asked, has_constant="add"))
    effect = fit_pace(fit.resid, participants)
    mean, sd = effect.posterior(np.asarray(asked_durations_s, dtype=float) - fitted, asked_participants)
    spread = np.hypot(sd, effect.walk_sd)
    return np.maximum(fitted[:, None] + mean[:, None] + spread[:, None] * ndtri(levels(members)), 0.0)


def with_residuals(points_s: ArrayLike, residuals_s: ArrayLike, members: int = 200) -> Array:
    """A point forecast with the spread of its training residuals ``captured - forecast``: their quantiles added to it."""
    spread = np.quantile(np.asarray(residuals_s, dtype=float), levels(members))
    return np.maximum(np.asarray(points_s, dtype=float)[:, None] + spread, 0.0)
