"""From a blended map to a density over the cells of the grid: the countermeasures of section 7.5, and one on the metric."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.steering.space import ParameterSpace

Array = NDArray[np.float64]
Kind = Literal["exponent", "threshold", "temperature"]


@dataclass(frozen=True)
class Sharpness:
    """How steeply the density falls from the best cell.

    ``exponent``: ``max(f, 0)^value`` of the suitability f; ``threshold``: ``max(f - value max f, 0)``; both named in section
    7.5. ``temperature``: ``exp(-m / value)`` of the metric m itself, value in the metric's unit.

    Raises
    ------
    InputError
        If there is no such kind, or the value is out of range.
    """

    kind: Kind
    value: float

    def __post_init__(self) -> None:
        if self.kind not in ("exponent", "threshold", "temperature"):
            raise InputError(f"sharpness: there is no {self.kind!r}; choose exponent, threshold or temperature")
        if not self.value > 0 or (self.kind == "threshold" and not self.value < 1):
            raise InputError(f"sharpness: a {self.kind} of {self.value} is out of range")

    def density(self, maps: Array, volumes: Array) -> Array:
        """Probability of every cell, (W, C), each row sums to 1.

        Parameters
        ----------
        maps : (W, C) blended suitability; blended metric for a temperature
        volumes : (C,) share of each cell in the parameter space, :func:`cell_volumes`
        """
        if self.kind == "temperature":
            raw = np.exp(-(maps - maps.min(axis=1, keepdims=True)) / self.value)
        else:
            best = maps.max(axis=1, keepdims=True)
            # Relative to the best cell, so that no power underflows everywhere; a map of zeros is uniform.
            relative = np.divide(np.maximum(maps, 0.0), best, out=np.ones_like(maps, dtype=float), where=best > 0)
            raw = relative**self.value if self.kind == "exponent" else np.maximum(relative - self.value, 0.0)
        raw = raw * volumes
        return np.asarray(raw / raw.sum(axis=1, keepdims=True))


def cell_volumes(space: ParameterSpace) -> Array:
    """Weights of the trapezoidal rule over the grid, (C,), summing to 1: cells on a border count half."""
    total = np.ones(1)
    for axis in space.axes:
        values = np.asarray(axis.values, dtype=float)
        widths = np.gradient(values) if len(values) > 1 else np.ones(1)
        if len(values) > 1:
            widths[[0, -1]] /= 2
        total = np.multiply.outer(total, widths / widths.sum()).ravel()
    return total
