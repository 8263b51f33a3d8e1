"""Forecasts of the travel times of a held-out set of walks: the motion models and what a sceptic would put beside them.

Nothing of the walks that are forecast is read but their tasks and dependencies; the two exceptions say so by their names: what
uses a person's *earlier* walks, and the resolution oracle, which reads the walk itself and is no forecast.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.evaluation.baselines import climatology, levels, regression
from walklab.evaluation.calibration import MEMBERS, Calibration
from walklab.evaluation.extended import log_times
from walklab.evaluation.grid_scores import grid_crps, grid_energy, grid_quantiles
from walklab.evaluation.learned_baselines import (
    GaussianProcess,
    fit_gaussian_process,
    personal_regression,
    quantile_regression,
    with_residuals,
)
from walklab.evaluation.log_regression import LogRegression, fit_log_regression
from walklab.evaluation.subject_scores import OWN_MAP
from walklab.planning.tracing import Traces
from walklab.steering.learned import Pace
from walklab.steering.pace import paced
from walklab.steering.sharpness import Sharpness

Array = NDArray[np.float64]

# P_Stat and P_Adapt give one time each; as forecasts they have the spread of their training residuals, and a name of their own.
STATIC, ADAPTIVE = "P_Stat with residual spread", "P_Adapt with residual spread"
BARE = "P_Prob without dependencies"
LITERAL, CALIBRATED = "P_Prob (literal)", "P_Prob (calibrated)"
EXTENDED, EXTENDED_EARLIER = "P_Prob (extended)", "P_Prob (extended), earlier walks"
CLIMATOLOGY, REGRESSION, QUANTILE_REGRESSION = "climatology", "regression", "quantile regression"
LOG_REGRESSION, QUADRATIC_REGRESSION = "log regression", "quadratic log regression"
GAUSSIAN_PROCESS = "Gaussian process"
REGRESSION_EARLIER, LOG_REGRESSION_EARLIER = "regression, earlier walks", "log regression, earlier walks"
QUADRATIC_REGRESSION_EARLIER = "quadratic log regression, earlier walks"
# What forecasts times alone, for somebody new and with that person's earlier walks; its trajectories are the planned route
# (:mod:`walklab.evaluation.route_forecasts`).
FITTED = (CLIMATOLOGY, REGRESSION, QUANTILE_REGRESSION, LOG_REGRESSION, QUADRATIC_REGRESSION, GAUSSIAN_PROCESS)
FITTED_EARLIER = (REGRESSION_EARLIER, LOG_REGRESSION_EARLIER, QUADRATIC_REGRESSION_EARLIER)
TIMES_ALONE = (*FITTED, *FITTED_EARLIER)

INNER = 50  # quantiles of the density that its mixture with a pace is made of

# What uses a person's earlier walks is compared with what uses them too.
INFORMED = (EXTENDED_EARLIER, *FITTED_EARLIER)


@dataclass(frozen=True)
class Known:
    """The training walks as the baselines see them.

    Attributes
    ----------
    durations_s, lengths_m, vectors, participants : (N,), (N,), (N, D), (N,) of all training walks
    few : rows of the walks that the kernel of the Gaussian process is fitted to
    static_residuals_s, adaptive_residuals_s : captured - simulated travel times of training walks
    bare : (C,) mean suitability of all training walks
    progress : :func:`walklab.evaluation.route_forecasts.mean_progress` of all training walks
    """

    durations_s: Array
    lengths_m: Array
    vectors: Array
    participants: Sequence[str]
    few: NDArray[np.int64]
    static_residuals_s: Array
    adaptive_residuals_s: Array
    bare: Array
    progress: Array

    @functools.cached_property
    def log_regressions(self) -> tuple[LogRegression, LogRegression]:
        """Linear and quadratic; like the process below fitted once for all scenarios."""
        walks = self.durations_s, self.vectors, self.participants
        return fit_log_regression(*walks), fit_log_regression(*walks, degree=2)

    @functools.cached_property
    def process(self) -> GaussianProcess:
        """The Gaussian process."""
        return fit_gaussian_process(self.durations_s, self.vectors, self.participants, self.few)


@dataclass(frozen=True)
class Asked:
    """The walks to forecast, in the order in which each person walked them.

    Attributes
    ----------
    captured_s : (W,) read by what uses earlier walks, and by the scores
    lengths_m, vectors, participants : (W,), (W, D), (W,)
    suitability, paced_suitability : (W, C) blended maps; those of P_Prob (extended)
    static_s, adaptive_s, own_map_s : (W,) travel times simulated with P_Stat's, P_Adapt's and the walk's own best parameters
    static_m, adaptive_m, own_map_m : (W,) distances of the trajectories that belong to them from the captured ones
    traces, distances_m : of all cells
    """

    captured_s: Array
    lengths_m: Array
    vectors: Array
    participants: Sequence[str]
    suitability: Array
    paced_suitability: Array
    static_s: Array
    adaptive_s: Array
    own_map_s: Array
    static_m: Array
    adaptive_m: Array
    own_map_m: Array
    traces: Traces
    distances_m: NDArray[np.float32]

    @functools.cached_property
    def order(self) -> NDArray[np.int64]:
        """(W, C) cells of each walk by ascending travel time: every score on the grid sorts by it."""
        return np.argsort(self.traces.travel_s, axis=1, kind="stable")


@dataclass(frozen=True)
class Forecast:
    """(W, M) equally likely travel times and, where there are trajectories, their energy score (W,) in metres.

    What gives one trajectory for each walk (P_Stat, P_Adapt, the resolution oracle) is scored as a point: by its distance. The
    spread of training residuals is one of times and gives no others. What simulates nothing is put on the planned route.
    """

    members_s: Array
    energy_m: Array | None = None


def all_forecasts(known: Known, asked: Asked, calibration: Calibration, volumes: Array) -> dict[str, Forecast]:
    """Every forecast by its name, in the order of the tables."""
    bare = np.tile(known.bare, (len(asked.captured_s), 1))
    found = {
        STATIC: Forecast(with_residuals(asked.static_s, known.static_residuals_s), asked.static_m),
        ADAPTIVE: Forecast(with_residuals(asked.adaptive_s, known.adaptive_residuals_s), asked.adaptive_m),
        LITERAL: on_grid(asked, asked.suitability, 1.0, volumes),
        CALIBRATED: on_grid(asked, asked.suitability, calibration.law.exponents(asked.vectors), volumes),
        BARE: on_grid(asked, bare, calibration.bare_exponent, volumes),
    }
    density = sharpened(asked.paced_suitability, calibration.pace.exponent, volumes)
    for name, effect in effects_before(calibration.pace, asked, density).items():
        found[name] = Forecast(paced_forecast(calibration.pace, asked.traces.travel_s, density, asked.vectors, effect, MEMBERS))
    pairs = known.durations_s, known.vectors
    personal = (*pairs, known.participants, asked.captured_s, asked.vectors, asked.participants)
    (linear, quadratic), walked = known.log_regressions, (asked.vectors, asked.captured_s, asked.participants)
    members = {
        CLIMATOLOGY: climatology(known.durations_s, known.lengths_m, known.participants, asked.lengths_m),
        REGRESSION: regression(*pairs, asked.vectors),
        QUANTILE_REGRESSION: quantile_regression(*pairs, asked.vectors),
        LOG_REGRESSION: linear.new_person(asked.vectors),
        QUADRATIC_REGRESSION: quadratic.new_person(asked.vectors),
        GAUSSIAN_PROCESS: known.process.new_person(asked.vectors),
        REGRESSION_EARLIER: personal_regression(*personal),
        LOG_REGRESSION_EARLIER: linear.after_earlier(*walked),
        QUADRATIC_REGRESSION_EARLIER: quadratic.after_earlier(*walked),
    }
    found |= {name: Forecast(values) for name, values in members.items()}
    return found | {OWN_MAP: Forecast(asked.own_map_s[:, None], asked.own_map_m)}


def effects_before(pace: Pace, asked: Asked, density: Array) -> dict[str, tuple[Array, Array]]:
    """Mean and standard deviation of each walker's pace effect: of somebody new, and by that person's earlier walks."""
    start = log_times(asked.traces.travel_s, density).mean + pace.trend(asked.vectors)
    count = len(asked.captured_s)
    return {
        EXTENDED: (np.full(count, pace.effect.mean), np.full(count, pace.effect.new_person_sd)),
        EXTENDED_EARLIER: pace.effect.posterior(np.log(asked.captured_s) - start, asked.participants),
    }


def paced_forecast(
    pace: Pace, travel_s: NDArray, density: Array, vectors: Array, effect: tuple[Array, Array], members: int
) -> Array:
    """(W, members) travel times of P_Prob (extended)."""
    mean, sd = effect
    inner = grid_quantiles(travel_s, density, levels(INNER))[0]
    freedom = pace.effect.freedom(sd, pace.rest_sd)
    return paced(inner, pace.trend(vectors) + mean, sd, pace.rest_sd, levels(members), freedom)


def on_grid(asked: Asked, maps: Array, exponent: float | Array, volumes: Array) -> Forecast:
    """The forecast of the sharpened density over the cells; one exponent, or one per walk."""
    density = sharpened(maps, exponent, volumes)
    travel_s, places_m = asked.traces.travel_s, asked.traces.places_m
    energy_m = grid_energy(asked.distances_m, density, places_m, travel_s, asked.order)
    return Forecast(grid_quantiles(travel_s, density, levels(MEMBERS), asked.order)[0], energy_m)


def sharpened(maps: Array, exponents: float | Array, volumes: Array) -> Array:
    """(W, C) densities; one exponent, or one per walk."""
    each = np.broadcast_to(np.asarray(exponents, dtype=float), len(maps))
    density = np.empty(maps.shape)
    for value in np.unique(each):
        rows = each == value
        density[rows] = Sharpness("exponent", float(value)).density(maps[rows], volumes)
    return density


def by_exponent(asked: Asked, exponents: Sequence[float], volumes: Array) -> pd.DataFrame:
    """CRPS on these walks by exponent, for the figure alone: nothing is chosen by it. DataFrame[value, crps_s]."""
    rows = []
    for value in exponents:
        density = Sharpness("exponent", value).density(asked.suitability, volumes)
        scores = pd.Series(grid_crps(asked.traces.travel_s, density, asked.captured_s, asked.order))
        rows.append({"value": value, "crps_s": scores.groupby(np.asarray(asked.participants)).mean().mean()})
    return pd.DataFrame(rows)
