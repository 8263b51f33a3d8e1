"""How densely and how evenly a blending space is filled (section 4.4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.steering.scaling import Scaling

Array = NDArray[np.float64]


def density(vectors: ArrayLike, scaling: Scaling, k: int = 100) -> dict[str, float]:
    """How densely and how evenly a blending space is filled, in scaled coordinates.

    Returns
    -------
    dict: ``entries``; ``distinct`` vectors; of the distance to the nearest other distinct vector
    ``nearest_median``, ``nearest_mean``, ``nearest_p95``, ``nearest_cv`` (coefficient of variation,
    0 for a lattice); ``k`` and ``kth_median``, ``kth_p95`` of the distance to the k-th other entry,
    the reach of a blend
    """
    from sklearn.neighbors import KDTree  # late: a second of imports

    points = scaling.apply(vectors)
    distinct = np.unique(points.round(9), axis=0)
    used = min(k, len(points) - 1)
    if points.shape[1] == 0 or len(distinct) < 2 or used < 1:
        return {"entries": float(len(points)), "distinct": float(len(distinct))}
    nearest = KDTree(distinct).query(distinct, 2)[0][:, 1]
    reach = KDTree(points).query(points, used + 1)[0][:, used]
    return {
        "entries": float(len(points)),
        "distinct": float(len(distinct)),
        "nearest_median": float(np.median(nearest)),
        "nearest_mean": float(nearest.mean()),
        "nearest_p95": float(np.quantile(nearest, 0.95)),
        "nearest_cv": float(nearest.std() / nearest.mean()),
        "k": float(used),
        "kth_median": float(np.median(reach)),
        "kth_p95": float(np.quantile(reach, 0.95)),
    }
