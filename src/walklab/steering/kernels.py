"""Compiled radial basis functions on a lattice: values, gradients and second derivatives at a point.

``s`` is always the squared scaled distance ``(epsilon r)^2``; the terms of the sums are in the
order of the grid cells, then 1 and, for degree 1, the coordinates scaled to [-1, 1].
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Shape = NDArray[np.int64]

MULTIQUADRIC, THIN_PLATE_SPLINE, CUBIC, LINEAR, GAUSSIAN = range(5)

# Sums over nodes may be regrouped for vector instructions: every point is summed by one thread
# in one fixed way, so the result does not depend on how many threads there are.
REGROUP = {"reassoc", "nsz", "contract"}
TINY = 1e-24  # of s: where a derivative has a pole at a node


def apply(kind: int, s: Array) -> Array:
    """``phi`` of an array of squared scaled distances."""
    if kind == MULTIQUADRIC:
        return -np.sqrt(1 + s)
    if kind == THIN_PLATE_SPLINE:
        return 0.5 * s * np.log(np.maximum(s, TINY))
    if kind == CUBIC:
        return s * np.sqrt(s)
    return -np.sqrt(s) if kind == LINEAR else np.exp(-s)


@njit(cache=True, nogil=True, fastmath=REGROUP)
def squared_distances(at: Array, shape: Shape, epsilon: float, s: Array) -> None:
    """Fill ``s`` (C,) with the squared scaled distances from one point to all nodes, last axis fastest."""
    s[0] = 0.0
    count = 1
    for axis in range(len(shape)):
        n = shape[axis]
        # Backwards, so that what is still needed is not overwritten.
        for i in range(count - 1, -1, -1):
            base = s[i]
            for j in range(n):
                gap = (at[axis] - j) * epsilon
                s[i * n + j] = base + gap * gap
        count *= n


@njit(cache=True, nogil=True, fastmath=REGROUP)
def value(c: Array, at: Array, shape: Shape, kind: int, epsilon: float, degree: int, s: Array) -> float:
    """The interpolant at one point; ``s`` (C,) is scratch.

    The distances along all axes but the first are the same in every layer of the grid and computed once.
    """
    layers = shape[0]
    cells = len(s)
    layer = cells // layers
    squared_distances(at[1:], shape[1:], epsilon, s[:layer])
    total = 0.0
    for i in range(layers):
        gap = (at[0] - i) * epsilon
        base = gap * gap
        part = c[i * layer : (i + 1) * layer]
        if kind == MULTIQUADRIC:
            base += 1.0
            for q in range(layer):
                total -= part[q] * np.sqrt(base + s[q])
        elif kind == THIN_PLATE_SPLINE:
            for q in range(layer):
                square = base + s[q]
                total += part[q] * 0.5 * square * np.log(max(square, TINY))
        elif kind == CUBIC:
            for q in range(layer):
                square = base + s[q]
                total += part[q] * square * np.sqrt(square)
        elif kind == LINEAR:
            for q in range(layer):
                total -= part[q] * np.sqrt(base + s[q])
        else:
            for q in range(layer):
                total += part[q] * np.exp(-base - s[q])
    total += c[cells]
    if degree == 1:
        for axis in range(len(shape)):
            half = 0.5 * (shape[axis] - 1)
            total += c[cells + 1 + axis] * (at[axis] - half) / half
    return total


@njit(cache=True, nogil=True)
def values(c: Array, points: Array, shape: Shape, kind: int, epsilon: float, degree: int) -> Array:
    """The interpolant at (L, P) points."""
    cells = 1
    for n in shape:
        cells *= n
    s = np.empty(cells)
    result = np.empty(len(points))
    for row in range(len(points)):
        result[row] = value(c, points[row], shape, kind, epsilon, degree, s)
    return result


@njit(cache=True, nogil=True)
def _derivatives(kind: int, s: float) -> tuple[float, float]:
    """``phi'(s)`` and ``phi''(s)``."""
    if kind == MULTIQUADRIC:
        root = np.sqrt(1.0 + s)
        return -0.5 / root, 0.25 / (root * root * root)
    if kind == GAUSSIAN:
        bell = np.exp(-s)
        return -bell, bell
    s = max(s, TINY)
    if kind == THIN_PLATE_SPLINE:
        return 0.5 * (np.log(s) + 1.0), 0.5 / s
    root = np.sqrt(s)
    if kind == CUBIC:
        return 1.5 * root, 0.75 / root
    return -0.5 / root, 0.25 / (s * root)


@njit(cache=True, nogil=True)
def expand(
    c: Array, at: Array, shape: Shape, kind: int, epsilon: float, degree: int, s: Array, gradient: Array, hessian: Array
) -> None:
    """Fill the (P,) gradient and (P, P) Hessian at one point; ``s`` (C,) is scratch.

    ``grad = sum c_i phi' 2 e^2 (x - x_i)``, ``H = sum c_i (phi'' 4 e^4 (x - x_i)(x - x_i)^T + phi' 2 e^2 I)``.
    """
    squared_distances(at, shape, epsilon, s)
    axes = len(shape)
    gradient[:] = 0.0
    hessian[:] = 0.0
    e2 = epsilon * epsilon
    gap = np.empty(axes)
    for i in range(len(s)):
        rest = i
        for axis in range(axes - 1, -1, -1):
            gap[axis] = at[axis] - rest % shape[axis]
            rest //= shape[axis]
        first, second = _derivatives(kind, s[i])
        first *= 2.0 * e2 * c[i]
        second *= 4.0 * e2 * e2 * c[i]
        for a in range(axes):
            gradient[a] += first * gap[a]
            hessian[a, a] += first
            for b in range(axes):
                hessian[a, b] += second * gap[a] * gap[b]
    if degree == 1:
        for axis in range(axes):
            gradient[axis] += c[len(s) + 1 + axis] * 2.0 / (shape[axis] - 1)
