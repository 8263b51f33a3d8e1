"""From a blended map to a density over the cells of the grid: the countermeasures of section 7.5, and one on the metric."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

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


LADDER = tuple(float(2.0 ** (step / 3)) for step in range(20))  # exponents that are told apart: thirds of octaves, 1 to 81


@dataclass(frozen=True)
class SharpnessLaw:
    """Exponent by one dependency: ``level exp(slope (d - centre) / scale)``, rounded to :data:`LADDER`.

    Attributes
    ----------
    level : exponent at the centre
    column, slope : which dependency, and by how much; None: the same exponent everywhere
    centre, scale : in the dependency's unit
    """

    level: float
    column: int | None = None
    slope: float = 0.0
    centre: float = 0.0
    scale: float = 1.0

    def exponents(self, vectors: ArrayLike) -> Array:
        """(W,) exponents for (W, D) dependency vectors."""
        return np.array(LADDER)[self.rungs(vectors)]

    def over(self, columns: Sequence[int]) -> SharpnessLaw:
        """The law for vectors of these columns alone; without its own dependency it keeps the exponent of the centre."""
        if self.column is None or self.column in columns:
            return replace(self, column=None if self.column is None else list(columns).index(self.column))
        return SharpnessLaw(self.level)

    def rungs(self, vectors: ArrayLike) -> NDArray[np.int64]:
        """(W,) their places in :data:`LADDER`."""
        asked = np.atleast_2d(np.asarray(vectors, dtype=float))
        logs = np.full(len(asked), np.log(self.level))
        if self.column is not None:
            logs += self.slope * (asked[:, self.column] - self.centre) / self.scale
        return np.clip(np.rint(logs / np.log(LADDER[1])), 0, len(LADDER) - 1).astype(np.int64)


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
