"""Scores of a forecast that is a density over the cells of the parameter grid: weighted sums over all cells, nothing drawn.

Every cell is simulated once per walk (:mod:`walklab.planning.tracing`); whatever the density, its scores are then sums.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from walklab.planning.tracing import Traces

Array = NDArray[np.float64]

PAIRS, STEP = 610, 377  # neighbouring Fibonacci numbers: of the pairs that stand for two draws in the energy score's spread


def grid_crps(times_s: ArrayLike, density: ArrayLike, observed_s: ArrayLike, order: NDArray[np.int64] | None = None) -> Array:
    r"""CRPS of a discrete distribution, :math:`\int (F(t) - 1\{t \ge y\})^2 dt` exactly.

    Parameters
    ----------
    times_s, density : (W, C) travel time of each cell and its probability
    observed_s : (W,)
    order : (W, C) cells by ascending time, if it is known already

    Returns
    -------
    (W,) array, seconds
    """
    times, observed = np.asarray(times_s, dtype=float), np.asarray(observed_s, dtype=float)[:, None]
    order = np.argsort(times, axis=1, kind="stable") if order is None else order
    ascending = np.take_along_axis(times, order, axis=1)
    below = np.cumsum(np.take_along_axis(np.asarray(density, dtype=float), order, axis=1), axis=1)[:, :-1]
    steps = np.diff(ascending, axis=1)
    before = np.clip(observed - ascending[:, :-1], 0, steps)
    inside = (below**2 * before + (1 - below) ** 2 * (steps - before)).sum(axis=1)
    outside = np.maximum(ascending[:, :1] - observed, 0) + np.maximum(observed - ascending[:, -1:], 0)
    return np.asarray(inside + outside[:, 0])


def grid_quantiles(
    times_s: ArrayLike, density: ArrayLike, levels: ArrayLike, order: NDArray[np.int64] | None = None
) -> tuple[Array, NDArray[np.int64]]:
    """Quantiles of every row's distribution, and the cells they fall on: both (W, levels)."""
    times, asked = np.asarray(times_s, dtype=float), np.asarray(levels, dtype=float)
    order = np.argsort(times, axis=1, kind="stable") if order is None else order
    cumulative = np.cumsum(np.take_along_axis(np.asarray(density, dtype=float), order, axis=1), axis=1)
    places = np.stack([np.searchsorted(row, asked * row[-1]) for row in cumulative])
    cells = np.take_along_axis(order, np.minimum(places, times.shape[1] - 1), axis=1)
    return np.take_along_axis(times, cells, axis=1), cells


def captured_distances(traces: Traces, captured_m: Array) -> NDArray[np.float32]:
    """Distance of every cell's trajectory from the captured one: root mean square over the K times, (W, C), metres.

    ``captured_m`` : (W, K, 2) captured places at the times of the traces
    """
    result = np.empty(traces.travel_s.shape, np.float32)
    for walk in range(len(traces)):  # one by one: the differences of all walks would not fit the memory
        gaps = traces.places_m[walk] - captured_m[walk].astype(np.float32)
        result[walk] = np.sqrt((gaps**2).sum(axis=2).mean(axis=1))
    return result


def grid_energy(
    distances_m: ArrayLike,
    density: Array,
    places_m: NDArray[np.float32],
    travel_s: ArrayLike,
    order: NDArray[np.int64] | None = None,
) -> Array:
    r"""Energy score :math:`E d(X, y) - \frac{1}{2} E d(X, X')` of the trajectory, d as in :func:`captured_distances`; metres.

    The first term is summed over all cells. The second is the mean over n pairs of cells, at the quantiles ``(k + 1/2) / 2n`` of
    the travel time, each of which has a part once: ``k = 2 i`` beside ``k = 2 g i + 1 mod 2n``. That is a Fibonacci lattice,
    n and g being neighbouring Fibonacci numbers, which covers the square of two independent draws evenly (Sloan & Joe 1994,
    Lattice Methods for Multiple Integration, section 1.3). With so many cells it hardly matters which one stands for a quantile,
    and the score is smooth in the density; all pairs of cells would cost a thousand times as much.

    Parameters
    ----------
    distances_m : (W, C) from :func:`captured_distances`
    density : (W, C)
    places_m, travel_s : of the traces, (W, C, K, 2) and (W, C)
    """
    first = (np.asarray(distances_m, dtype=float) * density).sum(axis=1)
    order = np.argsort(np.asarray(travel_s), axis=1, kind="stable") if order is None else order
    return np.asarray(first - 0.5 * _mean_gaps(places_m, np.asarray(density, dtype=float), order))


@njit(cache=True)
def _mean_gaps(places: NDArray[np.float32], density: Array, order: NDArray[np.int64]) -> Array:
    """Mean distance between the trajectories of the lattice's pairs of cells, (W,); the same cell twice has none."""
    result = np.zeros(len(order))
    cells = np.zeros(2 * PAIRS, np.int64)
    for walk in range(len(order)):
        last, total = order.shape[1] - 1, density[walk].sum()
        rank, below = 0, density[walk, order[walk, 0]]
        for level in range(2 * PAIRS):
            while below < (level + 0.5) / (2 * PAIRS) * total and rank < last:
                rank += 1
                below += density[walk, order[walk, rank]]
            cells[level] = order[walk, rank]
        for i in range(PAIRS):
            first, second = cells[2 * i], cells[(2 * i * STEP + 1) % (2 * PAIRS)]
            squared = 0.0
            for k in range(places.shape[2]):
                for axis in range(2):
                    gap = float(places[walk, first, k, axis]) - float(places[walk, second, k, axis])
                    squared += gap * gap
            result[walk] += np.sqrt(squared / places.shape[2])
    return result / PAIRS
