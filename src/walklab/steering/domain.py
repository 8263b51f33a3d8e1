"""Domain of validity: the convex hull of the training dependencies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull, QhullError

from walklab.steering.scaling import Scaling

Array = NDArray[np.float64]

TOLERANCE = 1e-6  # scaled units; far below the spread of any dependency, far above rounding


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
        centred = self.scaling.apply(np.atleast_2d(np.asarray(vectors, dtype=float))) - self.centre
        reduced = centred @ self.basis.T
        astray = np.abs(centred - reduced @ self.basis).max(axis=1, initial=0.0)
        rank = len(self.basis)
        beyond = (reduced @ self.equations[:, :rank].T + self.equations[:, rank]).max(axis=1, initial=-np.inf)
        return (astray <= TOLERANCE) & (beyond <= TOLERANCE)


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
    try:
        hull = ConvexHull(reduced)
    except QhullError:  # nearly flat clouds: Qhull's own joggling resolves them, deterministically
        hull = ConvexHull(reduced, qhull_options="QJ")
    # Neighbouring triangles of one facet repeat its equation; sorted, since Qhull's order is not meaningful.
    return np.unique(hull.equations.round(12), axis=0)
