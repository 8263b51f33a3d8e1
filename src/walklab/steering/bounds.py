"""Upper bounds of interpolated maps, for rejection sampling.

The surface between the nodes may exceed every node. The box is cut into blocks, one per grid
step along each axis; in each block the map is evaluated on a finer lattice of spacing h, and

    f <= max over the block's lattice points + sum_a h^2/8 max |d^2 f / dx_a^2|,

the error bound of multilinear interpolation, with the second derivatives taken as second
differences of the lattice, doubled because they are seen at lattice points only. Bounds of blends
follow: ``f = sum w_j f_j <= sum w_j M_j`` in every block, since ``w_j >= 0``.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.steering import kernels
from walklab.steering.interpolation import GridInterpolant

Array = NDArray[np.float64]
Shape = NDArray[np.int64]

REFINEMENT = 2  # lattice points per grid step
SAFETY = 2.0  # on the second differences
BATCH = 256  # maps at once, which bounds the memory
LARGEST_RUNG = 255
ROUNDING = 1e-6  # widens the unit, in case the largest bound divided by it comes out above the last rung
TINY = 1e-300


def lattice(shape: tuple[int, ...], refinement: int) -> list[Array]:
    """Coordinates along each axis of a lattice with ``refinement`` points per grid step."""
    return [np.arange((n - 1) * refinement + 1) / refinement for n in shape]


def points_of(axes: list[Array]) -> Array:
    """(L, P) points of a lattice, last axis fastest."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def block_bounds(
    interpolant: GridInterpolant, coefficients: NDArray, held: Mapping[int, float] | None = None
) -> NDArray[np.float32]:
    """Upper bound of every map in every block of the grid, or of the grid's slice where some axes are held.

    Parameters
    ----------
    coefficients : (N, terms)
    held : axis -> where it is held, grid steps

    Returns
    -------
    (N, B) array with B = product of (n - 1) over the axes that are not held, last axis fastest; rounded up to single precision
    """
    held = held or {}
    axes = lattice(interpolant.shape, REFINEMENT)
    free = [axis for axis in range(len(axes)) if axis not in held]
    basis = interpolant.basis(points_of([np.array([held[a]]) if a in held else line for a, line in enumerate(axes)]))
    extent = np.array([len(axes[a]) for a in free], dtype=np.int64)
    blocks = np.array([interpolant.shape[a] for a in free], dtype=np.int64) - 1
    bounds = np.empty((len(coefficients), int(blocks.prod())), dtype=np.float32)
    for start in range(0, len(coefficients), BATCH):
        surface = np.ascontiguousarray((basis @ coefficients[start : start + BATCH].astype(float).T).T)
        found = _block_maxima(surface, extent, REFINEMENT, SAFETY / 8)
        bounds[start : start + BATCH] = np.nextafter(found.astype(np.float32), np.float32(np.inf))
    return bounds


def rungs_above(bounds: NDArray) -> tuple[NDArray[np.uint8], float]:
    """Bounds rounded up to whole numbers of a unit, one byte each; bounds below zero become zero.

    Blends of bounds are read from memory for every sample, and a byte is read eight times as fast as a double.

    Parameters
    ----------
    bounds : (N, E), finite

    Returns
    -------
    (N, E) numbers, at most 255, and the unit: ``bounds <= numbers * unit``
    """
    unit = max(float(bounds.max(initial=0.0)), TINY) / LARGEST_RUNG
    rungs = np.empty(bounds.shape, dtype=np.uint8)
    for start in range(0, len(bounds), BATCH):
        part = np.maximum(bounds[start : start + BATCH], 0.0).astype(float) / unit
        rungs[start : start + BATCH] = np.minimum(np.ceil(part), LARGEST_RUNG)
    return rungs, unit * (1 + ROUNDING)


@njit(cache=True, nogil=True)
def bound_of_block(
    c: Array, corner: Array, free: Array, refinement: int, shape: Shape, kind: int, epsilon: float, degree: int, s: Array
) -> float:
    """Upper bound of one interpolated map in one block, from a lattice as fine as is asked for.

    Parameters
    ----------
    corner, free : (P,) lowest corner in grid steps; 0 for an axis that is held
    s : (C,) scratch
    """
    extent = np.ones(len(shape), np.int64)
    for axis in range(len(shape)):
        if free[axis] > 0.0:
            extent[axis] = refinement + 1
    stride = _strides(extent)
    heights, at = np.empty(extent[0] * stride[0]), np.empty(len(shape))
    for point in range(len(heights)):
        for axis in range(len(shape)):
            at[axis] = corner[axis] + (point // stride[axis]) % extent[axis] / refinement
        heights[point] = kernels.value(c, at, shape, kind, epsilon, degree, s)
    bend = np.empty((len(shape), len(heights)))
    _second_differences(heights, extent, stride, bend)
    highest = heights.max()
    for axis in range(len(shape)):
        highest += SAFETY / 8 * bend[axis].max()
    return highest


@njit(cache=True, nogil=True)
def _strides(extent: Shape) -> Shape:
    """Flat distance between neighbours along each axis, last axis fastest."""
    stride = np.ones(len(extent), np.int64)
    for axis in range(len(extent) - 2, -1, -1):
        stride[axis] = stride[axis + 1] * extent[axis + 1]
    return stride


@njit(cache=True, nogil=True)
def _block_maxima(surface: Array, extent: Shape, refinement: int, margin: float) -> Array:
    axes = len(extent)
    stride = _strides(extent)
    bend = np.empty((axes, surface.shape[1]))
    highest = _window_maxima(surface[0], extent, refinement)
    result = np.empty((len(surface), len(highest)))
    for row in range(len(surface)):
        highest = _window_maxima(surface[row], extent, refinement)
        _second_differences(surface[row], extent, stride, bend)
        for axis in range(axes):
            sharpest = _window_maxima(bend[axis], extent, refinement)
            for block in range(len(highest)):
                highest[block] += margin * sharpest[block]
        for block in range(len(highest)):
            result[row, block] = highest[block]
    return result


@njit(cache=True, nogil=True)
def _window_maxima(values: Array, extent: Shape, refinement: int) -> Array:
    """Highest of the lattice points of each block, (B,), along one axis after the other."""
    reduced = values
    inner, outer = len(values), 1
    for n in extent:
        inner //= n
        blocks = (n - 1) // refinement
        before, reduced = reduced, np.empty(outer * blocks * inner)
        for o in range(outer):
            for b in range(blocks):
                into = reduced[(o * blocks + b) * inner : (o * blocks + b + 1) * inner]
                first = (o * n + b * refinement) * inner
                own = before[first : first + inner]
                for i in range(inner):
                    into[i] = own[i]
                for point in range(1, refinement + 1):
                    own = before[first + point * inner : first + (point + 1) * inner]
                    for i in range(inner):
                        into[i] = own[i] if own[i] > into[i] else into[i]
        outer *= blocks
    return reduced


@njit(cache=True, nogil=True)
def _second_differences(surface: Array, extent: Shape, stride: Shape, bend: Array) -> None:
    """Fill ``bend`` (P, L) with |f(x - h) - 2 f(x) + f(x + h)|; at a border, with its inner neighbour's."""
    for axis in range(len(extent)):
        n, step, own = extent[axis], stride[axis], bend[axis]
        if n == 1:
            own[:] = 0.0
            continue
        for line in range(0, len(surface), n * step):
            for place in range(n):
                at = line + min(max(place, 1), n - 2) * step
                before, here, after = surface[at - step : at], surface[at : at + step], surface[at + step : at + 2 * step]
                into = own[line + place * step : line + (place + 1) * step]
                for i in range(step):
                    into[i] = abs(before[i] - 2.0 * here[i] + after[i])
