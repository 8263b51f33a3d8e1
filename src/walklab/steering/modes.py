"""Highest point of interpolated maps: a refined lattice, then projected Newton steps from its best peaks."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.steering import kernels
from walklab.steering.bounds import lattice, points_of
from walklab.steering.interpolation import GridInterpolant, Interpolant
from walklab.steering.multilinear import MultilinearInterpolant

Array = NDArray[np.float64]
Shape = NDArray[np.int64]

REFINEMENT = 2  # lattice points per grid step
STARTS = 10  # peaks of the lattice that are followed up
BATCH = 128  # maps per matrix product, always filled up, so that a map's result cannot depend on its company
LATTICE_BLOCK = 8192  # lattice points per matrix product, which bounds the memory
TIE = 1e-9  # suitability differences below this are rounding


def highest_points(interpolant: Interpolant, coefficients: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """:func:`modes` of whichever basis."""
    if isinstance(interpolant, MultilinearInterpolant):
        return interpolant.modes(coefficients, lower, upper)
    return modes(interpolant, coefficients, lower, upper)


def modes(interpolant: GridInterpolant, coefficients: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Maximum of each interpolated map in a box.

    Clipping at zero and a positive exponent do not move a positive maximum, so neither is applied.

    Parameters
    ----------
    coefficients : (W, terms)
    lower, upper : (P,) box in grid steps; equal where a parameter is held

    Returns
    -------
    (W, P) maxima in grid steps and (W,) values there
    """
    # ASSUME: Where several points share the maximum within 1e-9 (a parameter without effect, as omega on a straight
    # walk), the one with the lowest parameters, first axis first, is the mode; the paper has no rule.
    lines = lattice(interpolant.shape, REFINEMENT)
    axes = [_between(line, low, high) for line, low, high in zip(lines, lower, upper, strict=True)]
    points = points_of(axes)
    extent = np.array([len(axis) for axis in axes], dtype=np.int64)
    best, heights = np.empty((len(coefficients), len(axes))), np.empty(len(coefficients))
    parts = [interpolant.basis(points[i : i + LATTICE_BLOCK]) for i in range(0, len(points), LATTICE_BLOCK)]
    for first in range(0, len(coefficients), BATCH):
        rows = np.ascontiguousarray(coefficients[first : first + BATCH], dtype=float)
        padded = np.zeros((BATCH, interpolant.terms))
        padded[: len(rows)] = rows
        surface = np.concatenate([part @ padded.T for part in parts]).T[: len(rows)]
        found = _climb_all(np.ascontiguousarray(surface), rows, points, extent, lower, upper, *interpolant.compiled)
        best[first : first + BATCH], heights[first : first + BATCH] = found
    return best, heights


def _between(line: Array, low: float, high: float) -> Array:
    return np.unique(np.concatenate([[low], line[(line > low) & (line < high)], [high]]))


@njit(cache=True)
def _climb_all(
    surface: Array, c: Array, points: Array, extent: Shape, lower: Array, upper: Array, shape: Shape, kind: int, epsilon: float,
    degree: int,
) -> tuple[Array, Array]:  # fmt: skip
    cells = 1
    for n in shape:
        cells *= n
    s, at = np.empty(cells), np.empty(len(shape))
    best = np.empty((len(c), len(shape)))
    heights = np.full(len(c), -np.inf)
    for row in range(len(c)):
        for start in _peaks(surface[row], extent):
            if start < 0:
                break
            for axis in range(len(shape)):
                at[axis] = points[start, axis]
            height = _climb(c[row], at, lower, upper, shape, kind, epsilon, degree, s)
            if height > heights[row] + TIE:
                heights[row] = height
            elif not (height > heights[row] - TIE and _comes_first(at, best[row])):
                continue
            for axis in range(len(shape)):
                best[row, axis] = at[axis]
    return best, heights


@njit(cache=True)
def _comes_first(at: Array, other: Array) -> bool:
    for axis in range(len(at)):
        if abs(at[axis] - other[axis]) > 1e-6:
            return at[axis] < other[axis]
    return False


@njit(cache=True)
def _peaks(surface: Array, extent: Shape) -> Shape:
    """Lattice indices of the highest local maxima, highest first, -1 where there are fewer than STARTS.

    A point is one if no neighbour along an axis is higher; on a plateau its first point stands for it.
    """
    found = np.full(STARTS, -1, np.int64)
    for i in range(len(surface)):
        here = surface[i]
        if found[-1] >= 0 and here <= surface[found[-1]] + TIE:
            continue
        peak = True
        stride = 1
        for axis in range(len(extent) - 1, -1, -1):
            place = (i // stride) % extent[axis]
            if place > 0 and surface[i - stride] >= here - TIE:
                peak = False
                break
            if place < extent[axis] - 1 and surface[i + stride] > here + TIE:
                peak = False
                break
            stride *= extent[axis]
        if not peak:
            continue
        slot = STARTS - 1
        while slot > 0 and (found[slot - 1] < 0 or here > surface[found[slot - 1]] + TIE):
            found[slot] = found[slot - 1]
            slot -= 1
        found[slot] = i
    return found


@njit(cache=True)
def _climb(
    c: Array, at: Array, lower: Array, upper: Array, shape: Shape, kind: int, epsilon: float, degree: int, s: Array
) -> float:
    """Move ``at`` to a local maximum in the box by projected Newton steps with backtracking; its value."""
    axes = len(shape)
    gradient = np.empty(axes)
    hessian = np.empty((axes, axes))
    height = kernels.value(c, at, shape, kind, epsilon, degree, s)
    for _ in range(60):
        kernels.expand(c, at, shape, kind, epsilon, degree, s, gradient, hessian)
        free = np.flatnonzero((upper > lower) & ~((at <= lower) & (gradient <= 0)) & ~((at >= upper) & (gradient >= 0)))
        if len(free) == 0 or np.abs(gradient[free]).max() < 1e-10:
            break
        step = np.zeros(axes)
        ascent = _ascent(gradient[free], hessian, free)
        for i in range(len(free)):
            step[free[i]] = ascent[i]
        moved = False
        scale = 1.0
        for _ in range(30):
            trial = np.minimum(np.maximum(at + scale * step, lower), upper)
            reached = kernels.value(c, trial, shape, kind, epsilon, degree, s)
            if reached > height:
                moved = np.abs(trial - at).max() > 1e-9
                for axis in range(axes):
                    at[axis] = trial[axis]
                height = reached
                break
            scale *= 0.5
        if not moved:
            break
    return height


@njit(cache=True)
def _ascent(gradient: Array, hessian: Array, free: Shape) -> Array:
    """Newton step for a maximum, at most one grid step long; the Hessian is shifted to be negative definite."""
    bent = np.empty((len(free), len(free)))
    for a in range(len(free)):
        for b in range(len(free)):
            bent[a, b] = -hessian[free[a], free[b]]
    smallest = np.linalg.eigvalsh(bent)[0]
    floor = 1e-6 + 1e-3 * np.abs(bent).max()
    if smallest < floor:
        for a in range(len(free)):
            bent[a, a] += floor - smallest
    step = np.empty(len(free))
    step[:] = np.linalg.solve(bent, gradient.reshape(-1, 1))[:, 0]  # a matrix: one vector takes longer to compile
    longest = np.abs(step).max()
    if longest > 1.0:
        step /= longest
    return step
