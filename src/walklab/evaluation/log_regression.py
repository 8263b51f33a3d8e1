"""Regression of the logarithm of the travel time, the strongest thing a sceptic would fit: ``T = exp(b_0 + b . x + effect)``.

x is the logarithm of the length and the other dependencies as they are, so that a constant factor is a pace and a coefficient of
log length a power; in the quadratic version their squares, too. The effect is normal over people, as in P_Prob (extended)
(:class:`walklab.steering.pace.PaceEffect`), and a person's earlier walks inform it in the same way. Whether what never changes
within a person (height) is among x is chosen by leaving out one training participant after the other (:func:`simplest`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.evaluation.baselines import levels
from walklab.evaluation.extended import LEAST_PEOPLE, personal_columns
from walklab.evaluation.folds import by_participant
from walklab.steering.pace import PaceEffect, fit_pace, student

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


def logged(vectors: ArrayLike) -> Array:
    """(W, D) dependencies, of which the first, the length, in logarithms."""
    values = np.array(vectors, dtype=float, ndmin=2)
    values[:, 0] = np.log(np.maximum(values[:, 0], 1e-6))
    return values


def spread_columns(vectors: Array) -> tuple[int, ...]:
    """Columns that vary in training; the others tell nothing."""
    varies = vectors.std(axis=0) > 1e-9 * np.maximum(np.abs(vectors).max(axis=0), 1.0)
    return tuple(int(column) for column in np.flatnonzero(varies))


def column_choices(vectors: Array, participants: Sequence[str]) -> list[tuple[int, ...]]:
    """The dependencies without those that belong to a person, and all of them; one choice where that is the same."""
    every, personal = spread_columns(vectors), personal_columns(vectors, participants)
    general = tuple(column for column in every if column not in personal)
    return [general, every] if general and general != every else [every]


def simplest(choices: Sequence[tuple[int, ...]], scores: Sequence[Array]) -> int:
    """Which choice of columns to take: the first, unless a later one is better by more than one standard error.

    Without that margin, height would come in by chance among some thirty people, and forecasts for statures that nobody of them
    had would be far off. The rule of one standard error is that of Breiman, Friedman, Olshen & Stone (1984), section 3.4.3.

    Parameters
    ----------
    choices : fewest columns first
    scores : (people,) score of each participant when left out, one array per choice; more is better
    """
    taken = 0
    for later in range(1, len(choices)):
        gain = np.asarray(scores[later]) - np.asarray(scores[taken])
        if gain.mean() > gain.std(ddof=1) / np.sqrt(len(gain)):
            taken = later
    return taken


@dataclass(frozen=True)
class LogRegression:
    """A fitted regression of log T.

    Attributes
    ----------
    columns : dependencies among the inputs
    degree : 1, or 2 with the squares
    centre, scale, low, high : (P,) of each input, standardised, and where training began and ended (standardised)
    coefficients : (1 + degree P,)
    effect : of people
    """

    columns: tuple[int, ...]
    degree: int
    centre: Array
    scale: Array
    low: Array
    high: Array
    coefficients: Array
    effect: PaceEffect

    def fitted(self, vectors: ArrayLike) -> Array:
        """(W,) log T of somebody whose effect is zero."""
        return np.asarray(self._design(vectors) @ self.coefficients)

    def _design(self, vectors: ArrayLike) -> Array:
        at = (logged(vectors)[:, list(self.columns)] - self.centre) / self.scale
        # Squares are held beyond the training range, where a parabola would soon turn back; the straight part goes on.
        squares = [np.clip(at, self.low, self.high) ** 2] if self.degree > 1 else []
        return np.hstack([np.ones((len(at), 1)), at, *squares])

    def new_person(self, vectors: ArrayLike, members: int = 200) -> Array:
        """(W, members) travel times of somebody new, seconds: Student's t about the mean of all people."""
        count = len(np.atleast_2d(vectors))
        effect = np.full(count, self.effect.mean), np.full(count, self.effect.new_person_sd)
        return log_members(self.fitted(vectors), effect, self.effect, members)

    def after_earlier(self, vectors: ArrayLike, captured_s: ArrayLike, participants: Sequence[str], members: int = 200) -> Array:
        """(W, members) travel times, each informed by the same person's *earlier* walks among these; seconds.

        Parameters
        ----------
        captured_s, participants : (W,) in the order in which they were walked
        """
        fitted = self.fitted(vectors)
        effect = self.effect.posterior(np.log(np.asarray(captured_s, dtype=float)) - fitted, participants)
        return log_members(fitted, effect, self.effect, members)


def log_members(fitted: Array, effect: tuple[Array, Array], people: PaceEffect, members: int) -> Array:
    """(W, members) travel times about (W,) fitted log T, with mean and spread (W,) of each walker's effect and a walk's own."""
    mean, sd = effect
    at = student(levels(members), people.freedom(sd, people.walk_sd)[:, None])
    return np.exp((fitted + mean)[:, None] + np.hypot(sd, people.walk_sd)[:, None] * at)


def fit_log_regression(durations_s: ArrayLike, vectors: ArrayLike, participants: Sequence[str], degree: int = 1) -> LogRegression:
    """Least squares of log T, with the inputs that forecast left-out training participants best.

    Parameters
    ----------
    durations_s, vectors, participants : (W,), (W, D), (W,) of the training walks; the length is the first dependency
    degree : 1, or 2 with squares
    """
    times, known, owners = (
        np.log(np.asarray(durations_s, dtype=float)),
        np.atleast_2d(vectors),
        np.asarray(participants, dtype=str),
    )
    choices = column_choices(logged(known), owners.tolist())
    if len(choices) > 1 and len(np.unique(owners)) >= LEAST_PEOPLE:
        splits = list(by_participant(owners).values())
        scores = [_left_out_scores(times, known, owners, columns, degree, splits) for columns in choices]
        choices = [choices[simplest(choices, scores)]]
    return _fit(times, known, owners, choices[-1], degree)


def _fit(times: Array, vectors: Array, owners: NDArray[np.str_], columns: tuple[int, ...], degree: int) -> LogRegression:
    inputs = logged(vectors)[:, list(columns)]
    centre, scale = inputs.mean(axis=0), inputs.std(axis=0)
    at: Array = (inputs - centre) / scale
    low, high = np.asarray(at.min(axis=0), dtype=float), np.asarray(at.max(axis=0), dtype=float)
    frame = (columns, degree, centre, scale, low, high)
    design = LogRegression(*frame, np.zeros(0), PaceEffect(0.0, 0.0, 0.0))._design(vectors)
    coefficients: Array = np.asarray(np.linalg.lstsq(design, times, rcond=1e-8)[0], dtype=float)
    return LogRegression(*frame, coefficients, fit_pace(times - design @ coefficients, owners.tolist()))


def _left_out_scores(
    times: Array, vectors: Array, owners: NDArray[np.str_], columns: tuple[int, ...], degree: int, splits: list[tuple[Rows, Rows]]
) -> Array:
    """(people,) mean log score of each participant's walks under a regression of the others."""
    scores = []
    for known, own in splits:
        model = _fit(times[known], vectors[known], owners[known], columns, degree)
        off = times[own] - model.fitted(vectors[own]) - model.effect.mean
        scores.append(log_score(off, np.hypot(model.effect.new_person_sd, model.effect.walk_sd)))
    return np.array(scores)


def log_score(off: Array, sd: ArrayLike) -> float:
    """Mean log density of normal deviations, up to a constant; more is better."""
    spread = np.maximum(np.asarray(sd, dtype=float), 1e-9)
    return float(np.mean(-np.log(spread) - 0.5 * (off / spread) ** 2))
