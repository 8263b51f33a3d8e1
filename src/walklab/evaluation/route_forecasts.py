"""Trajectories for forecasts that give none: along the planned route, in the forecast time, as training walks progressed.

A regression of the travel time says nothing of places. What a sceptic would do about that needs no steering model: the walker is
put on the planned route, where training walks were on average after the same share of their time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.evaluation.tracing import compared_places
from walklab.geometry import curves

Array = NDArray[np.float64]

SHARES = np.linspace(0.0, 1.0, 41)  # of a walk's time
MEMBERS = 50  # travel times of a forecast that are walked, evenly among its members


def mean_progress(walks: Sequence[Walk]) -> Array:
    """(41,) share of their way that walks have gone after each of :data:`SHARES` of their time, on average; from 0 to 1."""
    gone = np.empty((len(walks), len(SHARES)))
    for row, walk in enumerate(walks):
        travelled = curves.arc_length(walk.position_m)
        time_s = walk.time_s - walk.time_s[0]
        gone[row] = np.interp(SHARES * time_s[-1], time_s, travelled / max(travelled[-1], 1e-9))
    return gone.mean(axis=0)


def route_energy(walks: Sequence[Walk], routes: Mapping[str, Array], members_s: Array, progress: Array) -> Array:
    r"""Energy score :math:`E d(X, y) - \frac{1}{2} E d(X, X')` of walking the planned route in each of the forecast times.

    d is that of :func:`walklab.evaluation.grid_scores.grid_energy`: the root mean square distance at the times of
    :func:`walklab.evaluation.tracing.score_times`; after its travel time, a trajectory stands at the end of the route.

    Parameters
    ----------
    members_s : (W, M) equally likely travel times; :data:`MEMBERS` of them are walked
    progress : of :func:`mean_progress`

    Returns
    -------
    (W,) array, metres
    """
    own, times_s, captured = compared_places(walks, routes)
    count = min(MEMBERS, members_s.shape[1])
    taken = np.sort(members_s, axis=1)[:, np.floor((np.arange(count) + 0.5) / count * members_s.shape[1]).astype(np.int64)]
    scores = np.empty(len(walks))
    for row, route in enumerate(own):
        share = np.interp(times_s[row] / np.maximum(taken[row], 1e-9)[:, None], SHARES, progress)
        travelled = curves.arc_length(route)
        places = np.stack([np.interp(share * travelled[-1], travelled, route[:, axis]) for axis in (0, 1)], axis=2)
        scores[row] = _energy(places, captured[row])
    return scores


@njit(cache=True)
def _energy(places: Array, captured: Array) -> float:
    """Of (M, K, 2) equally likely trajectories and the (K, 2) captured one."""
    members = places.shape[0]
    near, apart = 0.0, 0.0
    for i in range(members):
        near += _distance(places[i], captured)
        for j in range(i):
            apart += _distance(places[i], places[j])
    # Members are quantiles, so a member beside itself has its part.
    return near / members - apart / members**2


@njit(cache=True)
def _distance(first: Array, second: Array) -> float:
    squared = 0.0
    for k in range(len(first)):
        squared += (first[k, 0] - second[k, 0]) ** 2 + (first[k, 1] - second[k, 1]) ** 2
    return np.sqrt(squared / len(first))
