"""Domain of validity: the convex hull of the training dependencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from walklab.steering.scaling import Scaling

Array = NDArray[np.float64]

TOLERANCE = 1e-6  # scaled units; far below the spread of any dependency, far above rounding


class OutsideTrainingRange(UserWarning):
    """A dependency vector lies outside of the walks that the model was trained on."""


@dataclass(frozen=True)
class DomainOfValidity:
    """Convex hull of the scaled training vectors, in the subspace that they span.

    A dependency (or combination) without spread spans nothing: there a vector is inside only
    where it equals the training value.

    Attributes
    ----------
    scaling : of the dependencies
    centre : (D,) array, scaled
    basis : (r, D) array, orthonormal rows that span the training vectors
    equations : (M, r + 1) array; inside where ``equations[:, :r] @ z + equations[:, r] <= 0``
    """

    scaling: Scaling
    centre: Array
    basis: Array
    equations: Array

    def inside(self, vectors: ArrayLike) -> NDArray[np.bool_]:
        """Whether each of the (W, D) dependency vectors lies in the hull, (W,) array."""
        return self.contains(np.array(vectors, dtype=float, ndmin=2, order="C"))

    def contains(self, asked: Array) -> NDArray[np.bool_]:
        """The same for a (W, D) array of numbers as it is; False where one is not a number."""
        return _inside(asked, self.scaling.offset, self.scaling.scale, self.centre, self.basis, self.equations)

    def contains_all(self, asked: Array) -> bool:
        """Whether all of them are inside, at once: what a single draw asks, where microseconds count."""
        return _all_inside(asked, self.scaling.offset, self.scaling.scale, self.centre, self.basis, self.equations)


@njit(cache=True, nogil=True)
def _inside(vectors: Array, offset: Array, scale: Array, centre: Array, basis: Array, equations: Array) -> NDArray[np.bool_]:
    rank, count = basis.shape
    result = np.ones(len(vectors), np.bool_)
    centred, reduced = np.empty(count), np.empty(rank)
    for row in range(len(vectors)):
        for d in range(count):
            centred[d] = (vectors[row, d] - offset[d]) / scale[d] - centre[d]
        for r in range(rank):
            reduced[r] = 0.0
            for d in range(count):
                reduced[r] += basis[r, d] * centred[d]
        for d in range(count):
            along = 0.0
            for r in range(rank):
                along += reduced[r] * basis[r, d]
            if not abs(centred[d] - along) <= TOLERANCE:
                result[row] = False
        for facet in range(len(equations)):
            beyond = equations[facet, rank]
            for r in range(rank):
                beyond += equations[facet, r] * reduced[r]
            if not beyond <= TOLERANCE:
                result[row] = False
    return result


@njit(cache=True, nogil=True)
def _all_inside(vectors: Array, offset: Array, scale: Array, centre: Array, basis: Array, equations: Array) -> bool:
    return bool(_inside(vectors, offset, scale, centre, basis, equations).all())


def fit_domain(vectors: ArrayLike, scaling: Scaling) -> DomainOfValidity:
    """The domain of the (N, D) training vectors."""
    points = scaling.apply(np.atleast_2d(np.asarray(vectors, dtype=float)))
    centre = points.mean(axis=0)
    _, singular, directions = np.linalg.svd(points - centre, full_matrices=False)
    spread = singular / np.sqrt(len(points))
    basis = directions[spread > TOLERANCE]
    return DomainOfValidity(scaling, centre, basis, _hull_equations((points - centre) @ basis.T))


def _hull_equations(reduced: Array) -> Array:
    rank = reduced.shape[1]
    if rank == 0:
        return np.zeros((0, 1))
    if rank == 1:
        return np.array([[1.0, -reduced.max()], [-1.0, reduced.min()]])
    from scipy.spatial import ConvexHull, QhullError  # late: a process that only samples builds no hull

    try:
        hull = ConvexHull(reduced)
    except QhullError:  # nearly flat clouds: Qhull's own joggling resolves them, deterministically
        hull = ConvexHull(reduced, qhull_options="QJ")
    # Neighbouring triangles of one facet repeat its equation; sorted, since Qhull's order is not meaningful.
    return np.unique(hull.equations.round(12), axis=0)


def outside_message(names: Sequence[str], units: Sequence[str], captured: Array, asked: Array, inside: NDArray[np.bool_]) -> str:
    """One line on the first of (W, D) asked vectors that is not inside, beside the range of the (N, D) captured ones."""
    first = asked[np.argmin(inside)]
    ranges = zip(names, units, first, captured.min(axis=0), captured.max(axis=0), strict=True)
    told = ", ".join(f"{name} {value:.4g} {unit} (trained {low:.4g} to {high:.4g})" for name, unit, value, low, high in ranges)
    which = f"{(~inside).sum()} of {len(asked)} walks are" if len(asked) > 1 else "this walk is"
    return f"{which} unlike those the model was trained on: {told}"
