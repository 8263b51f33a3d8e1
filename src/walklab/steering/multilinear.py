"""Multilinear interpolation on the parameter grid: the bounded, non-negative alternative to radial basis functions.

Between the nodes the surface is a weighted mean of the corners of the block it is in. So it never
leaves the range of the map, a map without negative values needs no clipping, a blend of maps is a mixture of
densities, and no system is solved. It has creases at the grid lines, where radial basis functions are smooth.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError

Array = NDArray[np.float64]
Shape = NDArray[np.int64]

TIE = 1e-9  # suitability differences below this are rounding


@dataclass(frozen=True)
class MultilinearInterpolant:
    """``f(x) = sum over the 2^P corners of x's block of prod_a (1 - |x_a - corner_a|) m(corner)``.

    The coefficients of a map are its values. Coordinates are grid steps, as for
    :class:`~walklab.steering.interpolation.GridInterpolant`.

    Attributes
    ----------
    shape : number of values on each of the P axes
    """

    shape: tuple[int, ...]

    name = "multilinear"

    @property
    def cells(self) -> int:
        """Number of grid nodes, C."""
        return int(np.prod(self.shape))

    @property
    def terms(self) -> int:
        """Number of coefficients of a map: C."""
        return self.cells

    @cached_property
    def corners(self) -> Shape:
        """(2^P,) flat distances from a block's lowest node to its corners, last axis fastest."""
        strides = np.append(np.cumprod(self.shape[:0:-1])[::-1], 1).astype(np.int64)
        return np.array([np.dot(corner, strides) for corner in product((0, 1), repeat=len(self.shape))], dtype=np.int64)

    def coefficients(self, maps: ArrayLike) -> Array:
        """Coefficients of (N, C) maps: the maps themselves.

        Raises
        ------
        InputError
            If the maps have another number of cells or a negative value.
        """
        values = np.atleast_2d(np.ascontiguousarray(maps, dtype=float))
        if values.shape[1] != self.cells:
            raise InputError(
                f"maps have {values.shape[1]} cells, the parameter grid {self.cells}: they belong to different spaces"
            )
        if values.size and values.min() < 0:
            raise InputError(f"maps: suitability {values.min():.3g} is negative; the multilinear basis needs values from 0 up")
        return values

    def evaluate(self, coefficients: ArrayLike, steps: ArrayLike) -> Array:
        """The interpolated map at (L, P) points in grid steps, (L,)."""
        points = np.ascontiguousarray(np.atleast_2d(steps), dtype=float)
        shape = np.array(self.shape, dtype=np.int64)
        return _values(np.ascontiguousarray(coefficients, dtype=float), points, shape, self.corners)

    def slice(self, coefficients: Array, held: Mapping[int, float]) -> tuple[MultilinearInterpolant, Array]:
        """The maps where some axes are held (axis -> grid steps): an interpolant over the other axes, and their values."""
        values = coefficients.reshape(-1, *self.shape)
        for axis in sorted(held, reverse=True):
            node = min(int(held[axis]), self.shape[axis] - 2)
            part = held[axis] - node
            values = np.asarray((1 - part) * values.take(node, axis + 1) + part * values.take(node + 1, axis + 1))
        remaining = MultilinearInterpolant(values.shape[1:])
        return remaining, np.ascontiguousarray(values.reshape(len(values), -1))

    def modes(self, coefficients: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
        """Maximum of each of (W, C) maps in a box; it lies on a grid line or the box's border along every axis.

        See :func:`walklab.steering.modes.modes`; among equals the lowest parameters win here too.
        """
        points = np.array(list(product(*self._lines(lower, upper))))
        surface = np.array([self.evaluate(row, points) for row in coefficients]).reshape(-1, len(points))
        best = np.argmax(surface >= surface.max(axis=1, keepdims=True) - TIE, axis=1)
        return points[best], surface[np.arange(len(surface)), best]

    def _lines(self, lower: Array, upper: Array) -> Iterator[Array]:
        for low, high in zip(lower, upper, strict=True):
            yield np.unique(np.concatenate([[low], np.arange(np.ceil(low), np.floor(high) + 1), [high]]))


@njit(cache=True, nogil=True)
def locate(at: Array, shape: Shape, shares: Array) -> int:
    """Flat index of the lowest node of the block around ``at``; fills ``shares`` (2^P,) of its corners."""
    shares[0] = 1.0
    count = 1
    lowest = 0
    for axis in range(len(shape)):
        node = min(int(at[axis]), shape[axis] - 2)
        part = at[axis] - node
        lowest = lowest * shape[axis] + node
        for i in range(count - 1, -1, -1):
            whole = shares[i]
            shares[2 * i], shares[2 * i + 1] = whole * (1.0 - part), whole * part
        count *= 2
    return lowest


@njit(cache=True, nogil=True)
def value(c: NDArray, lowest: int, corners: Shape, shares: Array) -> float:
    """The interpolant where :func:`locate` was asked."""
    total = 0.0
    for corner in range(len(corners)):
        total += shares[corner] * c[lowest + corners[corner]]
    return total


@njit(cache=True, nogil=True)
def _values(c: Array, points: Array, shape: Shape, corners: Shape) -> Array:
    shares = np.empty(len(corners))
    result = np.empty(len(points))
    for row in range(len(points)):
        lowest = locate(points[row], shape, shares)
        result[row] = value(c, lowest, corners, shares)
    return result
