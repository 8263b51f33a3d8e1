"""Intervals by resampling whole participants: the walks of one person are not independent of each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, stdtrit

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

RESAMPLES = 2000
DECIMALS = 9  # of intervals and differences in tables: what is smaller is the noise of floating-point numbers
_CHUNK = 250  # resamples worked on at once: bounds the memory at about 8 bytes x 250 x walks an array


def cluster_codes(labels: ArrayLike) -> tuple[Integers, int]:
    """Number the clusters in sorted order: (n,) codes and how many clusters there are."""
    names, codes = np.unique(np.asarray(labels), return_inverse=True)
    return codes.astype(np.int64), len(names)


def cluster_counts(clusters: int, resamples: int, rng: np.random.Generator) -> Integers:
    """How often each cluster is drawn when ``clusters`` of them are drawn with replacement: (resamples, clusters)."""
    return rng.multinomial(clusters, np.full(clusters, 1 / clusters), size=resamples)


def resampled_quantiles(values: Array, codes: Integers, counts: Integers, levels: Sequence[float]) -> Array:
    """Quantiles of every resample, equal to ``numpy.quantile`` of the values repeated as often as their cluster was drawn.

    Parameters
    ----------
    values : (n,) array
    codes : (n,) cluster of each value
    counts : (resamples, clusters) from :func:`cluster_counts`
    levels : quantile levels in [0, 1]

    Returns
    -------
    (resamples, levels) array
    """
    order = np.argsort(values, kind="stable")
    ascending, ordered_codes = values[order], codes[order]
    result = np.empty((len(counts), len(levels)))
    for start in range(0, len(counts), _CHUNK):
        # Sorting once is enough: a resample only changes how often each value counts.
        cumulative = np.cumsum(counts[start : start + _CHUNK, :][:, ordered_codes], axis=1)
        total = cumulative[:, -1]
        for column, level in enumerate(levels):
            position = (total - 1) * level
            below = np.floor(position).astype(np.int64)
            above = np.minimum(below + 1, total - 1)
            lower, upper = (ascending[(cumulative <= rank[:, None]).sum(axis=1)] for rank in (below, above))
            result[start : start + _CHUNK, column] = lower + (upper - lower) * (position - below)
    return result


def resampled_sums(values: Array, codes: Integers, counts: Integers) -> Array:
    """Sum of the values in every resample, (resamples,) array; ``values`` may have trailing axes."""
    sums = np.zeros((counts.shape[1], *values.shape[1:]))
    np.add.at(sums, codes, values)
    return np.tensordot(counts.astype(float), sums, axes=(1, 0))


def interval(resampled: Array, clusters: int, level: float = 0.95) -> tuple[Any, Any]:
    """Expanded percentile interval along the first axis.

    The plain percentile interval is too narrow for few clusters. Its tail probability is
    replaced by ``Phi(-sqrt(n / (n - 1)) * t_{(1 + level) / 2, n - 1})`` for n clusters
    (Hesterberg 2015, The American Statistician 69(4), section 5.3).

    Returns
    -------
    (low, high), rounded to 1e-9; NaN where there are fewer than two clusters
    """
    if clusters < 2:
        nothing = np.full(resampled.shape[1:], np.nan)[()]
        return nothing, nothing
    tail = ndtr(-np.sqrt(clusters / (clusters - 1)) * stdtrit(clusters - 1, (1 + level) / 2))
    # Adding zero turns a rounded -0.0 into 0.0.
    low, high = np.round(np.quantile(resampled, [tail, 1 - tail], axis=0), DECIMALS) + 0.0
    return low, high
