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
        found = _block_maxima(surface, extent, blocks, REFINEMENT, SAFETY / 8)
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
def _block_maxima(surface: Array, extent: Shape, blocks: Shape, refinement: int, margin: float) -> Array:
    axes = len(extent)
    stride = _strides(extent)
    total = 1
    corners = 1
    for axis in range(axes):
        total *= blocks[axis]
        corners *= refinement + 1
    origins = np.zeros(total, np.int64)  # flat lattice index of each block's lowest corner
    for block in range(total):
        rest = block
        for axis in range(axes - 1, -1, -1):
            origins[block] += (rest % blocks[axis]) * refinement * stride[axis]
            rest //= blocks[axis]
    offsets = np.zeros(corners, np.int64)
    for corner in range(corners):
        rest = corner
        for axis in range(axes - 1, -1, -1):
            offsets[corner] += (rest % (refinement + 1)) * stride[axis]
            rest //= refinement + 1
    result = np.empty((len(surface), total))
    bend = np.empty((axes, surface.shape[1]))
    for row in range(len(surface)):
        _second_differences(surface[row], extent, stride, bend)
        for block in range(total):
            highest = -np.inf
            for corner in range(corners):
                highest = max(highest, surface[row, origins[block] + offsets[corner]])
            for axis in range(axes):
                sharpest = 0.0
                for corner in range(corners):
                    sharpest = max(sharpest, bend[axis, origins[block] + offsets[corner]])
                highest += margin * sharpest
            result[row, block] = highest
    return result


@njit(cache=True, nogil=True)
def _second_differences(surface: Array, extent: Shape, stride: Shape, bend: Array) -> None:
    """Fill ``bend`` (P, L) with |f(x - h) - 2 f(x) + f(x + h)|; at a border, with its inner neighbour's."""
    for axis in range(len(extent)):
        if extent[axis] == 1:
            bend[axis] = 0.0
            continue
        step = stride[axis]
        for i in range(len(surface)):
            place = (i // step) % extent[axis]
            inner = i + step * (min(max(place, 1), extent[axis] - 2) - place)
            bend[axis, i] = abs(surface[inner - step] - 2.0 * surface[inner] + surface[inner + step])
