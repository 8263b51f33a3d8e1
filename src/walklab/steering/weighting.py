"""How much each neighbour counts in a blend (section 5)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError

Array = NDArray[np.float64]
Weighting = Literal["linear", "inverse", "uniform"]


def weights(distances: ArrayLike, how: Weighting = "linear", beyond: ArrayLike | None = None) -> Array:
    """Blend weights from distances ("weighted linearly", section 5).

    Parameters
    ----------
    distances : (W, k) distances, nearest first
    how : ``linear``: ``w_j ~ d_max - d_j``; ``inverse``: ``w_j ~ 1 / d_j``; ``uniform``
    beyond : (W,) distance of the (k+1)-th neighbour, ``d_max`` of the linear weights; where it is
        not known (k takes in every entry), ``d_k (1 + 1/k)``

    Returns
    -------
    (W, k) array, not negative, each row sums to 1
    """
    # ASSUME: Section 5 says "weighted linearly" without a formula; w_j is proportional to d_max - d_j with d_max the
    # distance of the (k+1)-th neighbour, so that a map enters and leaves the blend at weight 0 and the k-th still counts.
    near = np.atleast_2d(np.asarray(distances, dtype=float))
    k = near.shape[1]
    if how == "linear":
        farthest = near[:, -1] * (1 + 1 / k) if beyond is None else np.asarray(beyond, dtype=float)
        raw = np.maximum(farthest[:, None] - near, 0.0)
    elif how == "inverse":
        # An exact hit would weigh infinitely; a floor of 1e-12 scaled units lets hits share the blend.
        raw = 1.0 / np.maximum(near, 1e-12)
    elif how == "uniform":
        raw = np.ones_like(near)
    else:
        raise InputError(f"weights: there is no {how!r}; choose linear, inverse or uniform")
    total = raw.sum(axis=1, keepdims=True)
    # All k at the distance of the next one: none is nearer, so they share equally.
    return np.where(total > 0, raw / np.where(total > 0, total, 1.0), 1.0 / k)


@njit(cache=True, nogil=True)
def mix(rows: NDArray, indices: NDArray[np.int64], shares: Array) -> Array:
    """``sum_j shares_j rows[indices_j]`` in the order given: (N, C) rows, (k,) indices and shares -> (C,).

    Compiled, since gathering the rows first would cost as much as adding them up.
    """
    total = np.zeros(rows.shape[1])
    for j in range(len(indices)):
        row = rows[indices[j]]
        for c in range(len(total)):
            total[c] += shares[j] * row[c]
    return total
