"""P_Prob (extended): a person's own pace, which no dependency tells, as a random effect.

All times of a walk from rest are multiplied by ``s = exp(b)``: the parameters drawn for it become ``(v / s, a / s^2, omega)``, by
which a path-following walker goes the same path s times as slowly. b is normal over people, and what a person's earlier walks
say about it is its posterior, as in any random-intercept model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

Array = NDArray[np.float64]

NODES = 15


@dataclass(frozen=True)
class PaceEffect:
    """Normal effects in the logarithm of the travel time.

    Attributes
    ----------
    mean : of all people; what the sharpened density is off by
    person_sd : between people
    walk_sd : between walks of one person, about the median of the forecast
    """

    mean: float
    person_sd: float
    walk_sd: float

    def posterior(self, residuals: ArrayLike, participants: Sequence[str]) -> tuple[Array, Array]:
        """Mean and standard deviation of a person's effect before each walk, from that person's *earlier* walks alone.

        Parameters
        ----------
        residuals : (W,) ``log(captured / median)`` in the order in which they were walked
        participants : (W,) who walked

        Returns
        -------
        two (W,) arrays; a first walk has the mean and the spread of all people
        """
        owners, off = np.asarray(participants, dtype=str), np.asarray(residuals, dtype=float) - self.mean
        count, sums = np.zeros(len(off)), np.zeros(len(off))
        for owner in np.unique(owners):
            own = np.flatnonzero(owners == owner)
            count[own] = np.arange(len(own))
            sums[own[1:]] = np.cumsum(off[own])[:-1]
        precision = 1 / max(self.person_sd, 1e-9) ** 2 + count / max(self.walk_sd, 1e-9) ** 2
        return self.mean + sums / max(self.walk_sd, 1e-9) ** 2 / precision, 1 / np.sqrt(precision)


def fit_pace(residuals: ArrayLike, participants: Sequence[str]) -> PaceEffect:
    """Pace effect from log residuals by the analysis of variance; every person counts the same."""
    owners, values = np.asarray(participants, dtype=str), np.asarray(residuals, dtype=float)
    groups = [values[owners == owner] for owner in np.unique(owners)]
    means = np.array([group.mean() for group in groups])
    repeated = [group for group in groups if len(group) > 1]
    within = float(np.mean([group.var(ddof=1) for group in repeated])) if repeated else 0.0
    noise = within * float(np.mean([1 / len(group) for group in groups]))
    between = max(float(means.var(ddof=1)) - noise, 0.0) if len(groups) > 1 else 0.0
    return PaceEffect(float(means.mean()), float(np.sqrt(between)), float(np.sqrt(within)))


def paced(members_s: Array, mean: Array, sd: Array, walk_sd: ArrayLike, levels: Array) -> Array:
    """Quantiles of ``exp(b + e) T`` at the levels, (W, levels).

    Parameters
    ----------
    members_s : (W, M) equally likely T of the sharpened density
    mean, sd : (W,) of the normal b
    walk_sd : of the walks of one person; e is normal with what the density's own spread leaves of it
    """
    nodes = ndtri((np.arange(NODES) + 0.5) / NODES)
    missing = np.maximum(np.asarray(walk_sd) ** 2 - np.log(members_s).var(axis=1), 0.0)
    effects = np.exp(mean[:, None] + np.sqrt(sd**2 + missing)[:, None] * nodes)
    mixed = (effects[:, :, None] * members_s[:, None, :]).reshape(len(members_s), -1)
    return np.asarray(np.quantile(mixed, levels, axis=1).T)
