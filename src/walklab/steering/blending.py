"""Compiled blends: which maps count how much for one dependency vector, and their weighted sums."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.steering.search import nearest, room

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

LINEAR, INVERSE, UNIFORM = range(3)
WEIGHTINGS = {"linear": LINEAR, "inverse": INVERSE, "uniform": UNIFORM}

ROUNDING = np.float32(1.0 + 1e-5)  # covers a single-precision sum of a thousand terms


@njit(cache=True, nogil=True)
def parents_of(
    vector: Array, offset: Array, scale: Array, points: Array, order: Indices, boxes: Array, k: int, how: int
) -> tuple[Indices, Array]:
    """Entries and weights of the blend at one dependency vector, as ``BlendingSpace.neighbours`` but in no order.

    Parameters
    ----------
    vector, offset, scale : (D,) dependency vector and its scaling
    points, order, boxes : of the :class:`~walklab.steering.search.SearchTree`
    k, how : neighbours and how they are weighted
    """
    entries = len(points)
    if len(vector) == 0:
        return np.arange(entries), np.full(entries, 1.0 / entries)
    count = min(k + 1, entries) if how == LINEAR else k
    indices, gaps = np.empty(room(count), np.int64), np.empty(room(count))
    scaled = np.empty(len(vector))
    for axis in range(len(vector)):
        scaled[axis] = (vector[axis] - offset[axis]) / scale[axis]
    nearest(points, order, boxes, scaled, count, indices, gaps)
    for j in range(count):
        gaps[j] = np.sqrt(gaps[j])
    shares = np.ones(k)
    if how == LINEAR:
        farthest = gaps[k] if count > k else gaps[k - 1] * (1.0 + 1.0 / k)
        for j in range(k):
            shares[j] = max(farthest - gaps[j], 0.0)
    elif how == INVERSE:
        for j in range(k):
            shares[j] = 1.0 / max(gaps[j], 1e-12)
    total = 0.0
    for j in range(k):
        total += shares[j]
    for j in range(k):
        shares[j] = shares[j] / total if total > 0.0 else 1.0 / k
    return indices[:k], shares


@njit(cache=True, nogil=True)
def blend(rows: NDArray, indices: Indices, shares: Array) -> Array:
    """``sum_j shares_j rows[indices_j]``: (N, C) rows, (k,) indices and shares -> (C,).

    Four rows at a time: the sum is written less often, and memory delivers four rows at once.
    """
    total = np.zeros(rows.shape[1])
    even = len(indices) // 4 * 4
    for j in range(0, even, 4):
        first, second, third, fourth = rows[indices[j]], rows[indices[j + 1]], rows[indices[j + 2]], rows[indices[j + 3]]
        a, b, c, d = shares[j], shares[j + 1], shares[j + 2], shares[j + 3]
        for i in range(len(total)):
            total[i] += a * first[i] + b * second[i] + c * third[i] + d * fourth[i]
    for j in range(even, len(indices)):
        row = rows[indices[j]]
        for i in range(len(total)):
            total[i] += shares[j] * row[i]
    return total


@njit(cache=True, nogil=True)
def blend_up(rungs: NDArray[np.uint8], unit: float, indices: Indices, shares: Array) -> NDArray[np.float32]:
    """The same for values stored as whole numbers of ``unit``, in single precision, rounded up: for bounds only."""
    total = np.zeros(rungs.shape[1], np.float32)
    even = len(indices) // 4 * 4
    for j in range(0, even, 4):
        first, second, third, fourth = rungs[indices[j]], rungs[indices[j + 1]], rungs[indices[j + 2]], rungs[indices[j + 3]]
        a, b, c, d = np.float32(shares[j]), np.float32(shares[j + 1]), np.float32(shares[j + 2]), np.float32(shares[j + 3])
        for i in range(len(total)):
            total[i] += (
                a * np.float32(first[i]) + b * np.float32(second[i]) + c * np.float32(third[i]) + d * np.float32(fourth[i])
            )
    for j in range(even, len(indices)):
        row = rungs[indices[j]]
        share = np.float32(shares[j])
        for i in range(len(total)):
            total[i] += share * np.float32(row[i])
    widen = np.float32(unit) * ROUNDING
    for i in range(len(total)):
        total[i] *= widen
    return total
