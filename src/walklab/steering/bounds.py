"""Upper bounds of interpolated maps, for rejection sampling.

The surface between the nodes may exceed every node. The box is cut into blocks, one per grid
step along each axis; in each block the map is evaluated on a finer lattice of spacing h, and

    f <= max over the block's lattice points + sum_a h^2/8 max |d^2 f / dx_a^2|,

the error bound of multilinear interpolation, with the second derivatives taken as second
differences of the lattice, doubled because they are seen at lattice points only. Bounds of blends
follow: ``f = sum w_j f_j <= sum w_j M_j`` in every block, since ``w_j >= 0``. Where a tight bound
pays off, the blend's own lattice lowers it, block by block.
"""

from __future__ import annotations

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


def lattice(shape: tuple[int, ...], refinement: int) -> list[Array]:
    """Coordinates along each axis of a lattice with ``refinement`` points per grid step."""
    return [np.arange((n - 1) * refinement + 1) / refinement for n in shape]


def points_of(axes: list[Array]) -> Array:
    """(L, P) points of a lattice, last axis fastest."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def block_bounds(interpolant: GridInterpolant, coefficients: Array) -> NDArray[np.float32]:
    """Upper bound of every map in every block of the grid.

    Parameters
    ----------
    coefficients : (N, terms)

    Returns
    -------
    (N, B) array with B = product of (n - 1) over the axes, last axis fastest; rounded up to single precision
    """
    axes = lattice(interpolant.shape, REFINEMENT)
    basis = interpolant.basis(points_of(axes))
    extent = np.array([len(axis) for axis in axes], dtype=np.int64)
    blocks = np.array(interpolant.shape, dtype=np.int64) - 1
    bounds = np.empty((len(coefficients), int(blocks.prod())), dtype=np.float32)
    for start in range(0, len(coefficients), BATCH):
        surface = np.ascontiguousarray((basis @ coefficients[start : start + BATCH].T).T)
        found = _block_maxima(surface, extent, blocks, REFINEMENT, SAFETY / 8)
        bounds[start : start + BATCH] = np.nextafter(found.astype(np.float32), np.float32(np.inf))
    return bounds


def tightened(interpolant: GridInterpolant, surface: Array, coarse: Array, blocks: Shape) -> float:
    """Upper bound of one interpolated map over some blocks, from its own lattice.

    Blocks are looked at from the highest coarse bound down, until no coarse bound is above what is found.

    Parameters
    ----------
    surface : (terms,) coefficients
    coarse : (b,) bound of the map in each of the blocks, from :func:`block_bounds`
    blocks : (b,) numbers of the blocks
    """
    order = np.argsort(-coarse, kind="stable")
    return _tightened(surface, coarse[order], blocks[order], REFINEMENT, SAFETY / 8, *interpolant.compiled)


@njit(cache=True)
def _tightened(
    c: Array, coarse: Array, blocks: Shape, refinement: int, margin: float, shape: Shape, kind: int, epsilon: float, degree: int
) -> float:
    axes = len(shape)
    cells = 1
    for n in shape:
        cells *= n
    extent = np.full(axes, refinement + 1, np.int64)
    stride = _strides(extent)
    lattice_values = np.empty(extent[0] * stride[0])
    bend = np.empty((axes, len(lattice_values)))
    s, at = np.empty(cells), np.empty(axes)
    best = -np.inf
    for index in range(len(blocks)):
        if coarse[index] <= best:
            break
        for point in range(len(lattice_values)):
            rest = blocks[index]
            for axis in range(axes - 1, -1, -1):
                at[axis] = rest % (shape[axis] - 1) + (point // stride[axis]) % extent[axis] / refinement
                rest //= shape[axis] - 1
            lattice_values[point] = kernels.value(c, at, shape, kind, epsilon, degree, s)
        _second_differences(lattice_values, extent, stride, bend)
        highest = lattice_values.max()
        for axis in range(axes):
            highest += margin * bend[axis].max()
        best = max(best, min(highest, coarse[index]))
    return best


@njit(cache=True)
def _strides(extent: Shape) -> Shape:
    """Flat distance between neighbours along each axis, last axis fastest."""
    stride = np.ones(len(extent), np.int64)
    for axis in range(len(extent) - 2, -1, -1):
        stride[axis] = stride[axis + 1] * extent[axis + 1]
    return stride


@njit(cache=True)
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


@njit(cache=True)
def _second_differences(surface: Array, extent: Shape, stride: Shape, bend: Array) -> None:
    """Fill ``bend`` (P, L) with |f(x - h) - 2 f(x) + f(x + h)|; at a border, with its inner neighbour's."""
    for axis in range(len(extent)):
        step = stride[axis]
        for i in range(len(surface)):
            place = (i // step) % extent[axis]
            inner = i + step * (min(max(place, 1), extent[axis] - 2) - place)
            bend[axis, i] = abs(surface[inner - step] - 2.0 * surface[inner] + surface[inner + step])
