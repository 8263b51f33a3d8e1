"""Scaled coordinates of dependency vectors, in which distances are measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError

Array = NDArray[np.float64]
ScalingRule = Literal["standard_deviation", "range", "none"]


@dataclass(frozen=True)
class Scaling:
    """Linear map of dependency vectors to comparable coordinates: ``(d - offset) / scale``.

    Attributes
    ----------
    offset, scale : (D,) arrays in the dependencies' units
    """

    offset: Array
    scale: Array

    def apply(self, vectors: ArrayLike) -> Array:
        """(..., D) dependency vectors in scaled coordinates."""
        return (np.asarray(vectors, dtype=float) - self.offset) / self.scale


def fit_scaling(
    vectors: ArrayLike, participants: Sequence[str] | None = None, how: ScalingRule = "standard_deviation"
) -> Scaling:
    """What makes dependencies comparable.

    Parameters
    ----------
    vectors : (W, D) array
    participants : (W,) participant of each walk; None weighs every walk the same
    how : divide by the ``standard_deviation``, in which every participant counts the same; by the ``range`` (largest - smallest
        value); or by ``none``, which compares metres with 1/m
    """
    if how not in ("standard_deviation", "range", "none"):
        raise InputError(f"scaling: there is no {how!r}; choose standard_deviation, range or none")
    # ASSUME: The paper does not say how length, curvature and height are made comparable before the neighbour
    # search; each is divided by its standard deviation, participants weighing the same, so that nobody's number of
    # walks decides; a dependency without spread is left unscaled.
    values = np.asarray(vectors, dtype=float)
    weights = np.full(len(values), 1.0 / len(values))
    if participants is not None:
        _, owner, counts = np.unique(np.asarray(participants, dtype=str), return_inverse=True, return_counts=True)
        weights = 1.0 / (counts[owner] * len(counts))
    offset = weights @ values
    deviation = np.sqrt(weights @ (values - offset) ** 2)
    negligible = deviation <= 1e-9 * np.maximum(np.abs(offset), 1.0)
    if how == "none":
        return Scaling(offset, np.ones(len(offset)))
    scale = np.ptp(values, axis=0) if how == "range" else deviation
    return Scaling(offset, np.where(negligible, 1.0, scale))
