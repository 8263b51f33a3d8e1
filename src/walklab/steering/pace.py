"""A person's own pace, which no dependency tells, as a random effect; the part of P_Prob (extended) that is not a map.

All times of a walk from rest are multiplied by ``s = exp(b)``: the parameters drawn for it become ``(v / s, a / s^2, omega)``, by
which a path-following walker goes the same path s times as slowly. b is a trend over the dependencies plus an effect that is
normal over people; what a person's earlier walks say about it is its posterior, as in any random-intercept model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri, stdtrit

Array = NDArray[np.float64]

NODES = 15


@dataclass(frozen=True)
class PaceEffect:
    """Normal effects in the logarithm of the travel time.

    Attributes
    ----------
    mean : of all people; what the sharpened density is off by
    person_sd : between people
    walk_sd : between walks of one person, about the forecast
    people : from how many it was learned, which leaves their mean and spread uncertain for somebody new; None: exactly known
    """

    mean: float
    person_sd: float
    walk_sd: float
    people: int | None = None

    @property
    def new_person_sd(self) -> float:
        """Of somebody new about the estimated mean: ``person_sd sqrt(1 + 1 / people)``."""
        return self.person_sd * float(np.sqrt(1 + (1 / self.people if self.people else 0.0)))

    def posterior(self, residuals: ArrayLike, participants: Sequence[str]) -> tuple[Array, Array]:
        """Mean and standard deviation of a person's effect before each walk, from that person's *earlier* walks alone.

        Parameters
        ----------
        residuals : (W,) ``log(captured / forecast)`` in the order in which they were walked
        participants : (W,) who walked

        Returns
        -------
        two (W,) arrays; a first walk has the mean and the spread of somebody new
        """
        owners, off = np.asarray(participants, dtype=str), np.asarray(residuals, dtype=float) - self.mean
        count, sums = np.zeros(len(off)), np.zeros(len(off))
        for owner in np.unique(owners):
            own = np.flatnonzero(owners == owner)
            count[own] = np.arange(len(own))
            sums[own[1:]] = np.cumsum(off[own])[:-1]
        precision = 1 / max(self.new_person_sd, 1e-9) ** 2 + count / max(self.walk_sd, 1e-9) ** 2
        return self.mean + sums / max(self.walk_sd, 1e-9) ** 2 / precision, 1 / np.sqrt(precision)

    def freedom(self, sd: ArrayLike, rest_sd: float) -> Array:
        """Degrees of freedom of Student's t for an effect of this sd and a rest (Satterthwaite); infinite if exactly known.

        The spread between people was estimated with ``people - 1`` degrees, the rest with so many that they do not count.
        """
        variance = np.asarray(sd, dtype=float) ** 2
        if self.people is None:
            return np.full(variance.shape, np.inf)
        total = variance + rest_sd**2
        share = np.divide(variance, total, out=np.zeros_like(total), where=total > 0)
        return np.asarray(max(self.people - 1, 1) / np.maximum(share, 1e-6) ** 2)


def fit_pace(residuals: ArrayLike, participants: Sequence[str]) -> PaceEffect:
    """Pace effect from log residuals by the analysis of variance; every person counts the same."""
    owners, values = np.asarray(participants, dtype=str), np.asarray(residuals, dtype=float)
    groups = [values[owners == owner] for owner in np.unique(owners)]
    means = np.array([group.mean() for group in groups])
    repeated = [group for group in groups if len(group) > 1]
    within = float(np.mean([group.var(ddof=1) for group in repeated])) if repeated else 0.0
    noise = within * float(np.mean([1 / len(group) for group in groups]))
    between = max(float(means.var(ddof=1)) - noise, 0.0) if len(groups) > 1 else 0.0
    return PaceEffect(float(means.mean()), float(np.sqrt(between)), float(np.sqrt(within)), len(groups))


@dataclass(frozen=True)
class Trend:
    """Mean of the effect over some dependencies: a polynomial without products, held beyond the training range.

    Attributes
    ----------
    columns : which dependencies
    logged : whether each enters by its logarithm
    centre, scale, low, high : of each, standardised and where training began and ended (standardised)
    degree : 0 is one mean for all
    coefficients : (1 + degree * columns,)
    """

    columns: tuple[int, ...]
    logged: tuple[bool, ...]
    centre: tuple[float, ...]
    scale: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    degree: int
    coefficients: tuple[float, ...]

    def features(self, vectors: ArrayLike) -> Array:
        """(W, 1 + degree * columns) powers of the standardised dependencies."""
        asked = _selected(vectors, self.columns, self.logged)
        at = np.clip((asked - np.array(self.centre)) / np.array(self.scale), self.low, self.high)
        return np.column_stack([np.ones(len(asked)), *(at**power for power in range(1, self.degree + 1))])

    def __call__(self, vectors: ArrayLike) -> Array:
        """(W,) mean effect."""
        return np.asarray(self.features(vectors) @ np.array(self.coefficients))


def fit_trend(
    residuals: ArrayLike,
    vectors: ArrayLike,
    participants: Sequence[str],
    columns: Sequence[int],
    logged: Sequence[bool],
    degree: int,
) -> Trend:
    """Least squares of log residuals over (W, D) dependencies in which every participant counts the same."""
    known = _selected(vectors, columns, logged)
    spread = known.std(axis=0)
    scale = np.where(spread > 1e-9 * np.maximum(np.abs(known).max(axis=0, initial=0.0), 1.0), spread, 1.0)
    centre = known.mean(axis=0)
    at = (known - centre) / scale
    rows = (centre, scale, at.min(axis=0), at.max(axis=0))
    middle, unit, low, high = (tuple(float(value) for value in row) for row in rows)
    empty = Trend(tuple(columns), tuple(logged), middle, unit, low, high, degree, ())
    _, owner, counts = np.unique(np.asarray(participants, dtype=str), return_inverse=True, return_counts=True)
    root = np.sqrt(1 / counts[owner])
    found = np.linalg.lstsq(empty.features(vectors) * root[:, None], np.asarray(residuals, dtype=float) * root, rcond=1e-8)[0]
    return replace(empty, coefficients=tuple(float(value) for value in found))


def _selected(vectors: ArrayLike, columns: Sequence[int], logged: Sequence[bool]) -> Array:
    values = np.atleast_2d(np.asarray(vectors, dtype=float))[:, list(columns)]
    for place, logarithmic in enumerate(logged):
        if logarithmic:
            values[:, place] = np.log(np.maximum(values[:, place], 1e-6))
    return values


def rest_of(residuals: ArrayLike, participants: Sequence[str], variances: ArrayLike) -> float:
    """Spread between walks of one person that the walks' own variances leave.

    That which gives the standardised deviations from the persons' means the variance 1; 0 if they have no more than that without.
    """
    owners, values = np.asarray(participants, dtype=str), np.asarray(residuals, dtype=float)
    _, owner, counts = np.unique(owners, return_inverse=True, return_counts=True)
    repeated = counts[owner] > 1
    if not repeated.any():
        return 0.0
    own = values - (np.bincount(owner, values) / counts)[owner]
    squares = (own**2 * counts[owner] / np.maximum(counts[owner] - 1, 1))[repeated]
    known = np.asarray(variances, dtype=float)[repeated]

    def excess(rest: float) -> float:
        return float(np.mean(squares / np.maximum(known + rest, 1e-18))) - 1

    from scipy import optimize  # late: only learning needs it

    most = float(squares.max())
    return float(np.sqrt(optimize.brentq(excess, 0.0, most))) if most > 0 and excess(0.0) > 0 > excess(most) else 0.0


def student(levels: ArrayLike, freedom: ArrayLike) -> Array:
    """Quantiles of Student's t, of the normal where the degrees of freedom are infinite."""
    degrees = np.asarray(freedom, dtype=float)
    known = np.isinf(degrees)
    return np.where(known, ndtri(levels), stdtrit(np.where(known, 1.0, degrees), levels))


def paced(members_s: Array, mean: Array, sd: Array, rest_sd: float, levels: Array, freedom: ArrayLike = np.inf) -> Array:
    """Quantiles of ``exp(b + e) T`` at the levels, (W, levels).

    Parameters
    ----------
    members_s : (W, M) equally likely T of the sharpened density
    mean, sd : (W,) of b
    rest_sd : of e: what the density's own spread leaves of the spread between walks of one person
    freedom : (W,) or one; degrees of Student's t
    """
    degrees = np.broadcast_to(np.asarray(freedom, dtype=float), mean.shape)
    nodes = student((np.arange(NODES) + 0.5) / NODES, degrees[:, None])
    effects = np.exp(mean[:, None] + np.sqrt(sd**2 + rest_sd**2)[:, None] * nodes)
    mixed = (effects[:, :, None] * members_s[:, None, :]).reshape(len(members_s), -1)
    return _quantiles(mixed, levels)


def _quantiles(members: Array, levels: Array) -> Array:
    """``numpy.quantile`` along each row, to the last digit; for many levels sorting once is some thirty times as fast."""
    ascending = np.sort(members, axis=1)
    at = levels * (ascending.shape[1] - 1)
    before = np.floor(at).astype(int)
    share, low = at - before, ascending[:, before]
    high = ascending[:, np.minimum(before + 1, ascending.shape[1] - 1)]
    return np.where(share < 0.5, low + (high - low) * share, high - (high - low) * (1 - share))
