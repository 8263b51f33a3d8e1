"""What a sceptic would fit to the same dependencies instead: quantile regression, a Gaussian process, personal intercepts.

Like the other baselines (:mod:`walklab.evaluation.baselines`) each returns equally likely travel times, (N, members), seconds.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from walklab.evaluation.baselines import levels
from walklab.steering.pace import fit_pace

Array = NDArray[np.float64]

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


def gaussian_process(durations_s: ArrayLike, vectors: ArrayLike, asked_vectors: ArrayLike, members: int = 200) -> Array:
    """A Gaussian process with one length scale per dependency and white noise (scikit-learn), fitted by marginal likelihood."""
    from sklearn.gaussian_process import GaussianProcessRegressor  # late: half a second of imports
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    known, asked = designs(vectors, asked_vectors)
    kernel = ConstantKernel(4.0) * RBF(np.full(known.shape[1], 3.0), (0.1, 100)) + WhiteKernel(0.1, (1e-4, 10))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a length scale at its bound says that the dependency does not matter
        model = GaussianProcessRegressor(kernel, normalize_y=True).fit(known, np.asarray(durations_s, dtype=float))
    mean, sd = model.predict(asked, return_std=True)
    return np.maximum(mean[:, None] + sd[:, None] * ndtri(levels(members)), 0.0)


def personal_regression(
    durations_s: ArrayLike,
    vectors: ArrayLike,
    participants: Sequence[str],
    asked_durations_s: ArrayLike,
    asked_vectors: ArrayLike,
    asked_participants: Sequence[str],
    members: int = 200,
    logarithmic: bool = False,
) -> Array:
    """Regression with a random intercept per person, which the person's *earlier* walks inform.

    Ordinary least squares on the dependencies; residuals split into persons and walks (:func:`walklab.steering.pace.fit_pace`);
    forecast: fitted value + posterior of the person's intercept + a walk's own spread. ``logarithmic`` fits log T on log of
    the lengths and the other dependencies as they are, so that the intercept is a pace.
    """
    from statsmodels.regression.linear_model import OLS  # late: a second of imports
    from statsmodels.tools.tools import add_constant

    known, asked = designs(_logged(vectors) if logarithmic else vectors, _logged(asked_vectors) if logarithmic else asked_vectors)
    times, captured = np.asarray(durations_s, dtype=float), np.asarray(asked_durations_s, dtype=float)
    if logarithmic:
        times, captured = np.log(times), np.log(captured)
    fit = OLS(times, add_constant(known, has_constant="add")).fit()
    fitted = fit.predict(add_constant(asked, has_constant="add"))
    effect = fit_pace(fit.resid, participants)
    mean, sd = effect.posterior(captured - fitted, asked_participants)
    spread = np.sqrt(sd**2 + effect.walk_sd**2)
    forecast = fitted[:, None] + mean[:, None] + spread[:, None] * ndtri(levels(members))
    return np.exp(forecast) if logarithmic else np.maximum(forecast, 0.0)


def _logged(vectors: ArrayLike) -> Array:
    """The first dependency, the length, in logarithms."""
    values = np.array(vectors, dtype=float, ndmin=2)
    values[:, 0] = np.log(values[:, 0])
    return values


def with_residuals(points_s: ArrayLike, residuals_s: ArrayLike, members: int = 200) -> Array:
    """A point forecast with the spread of its training residuals ``captured - forecast``: their quantiles added to it."""
    spread = np.quantile(np.asarray(residuals_s, dtype=float), levels(members))
    return np.maximum(np.asarray(points_s, dtype=float)[:, None] + spread, 0.0)
