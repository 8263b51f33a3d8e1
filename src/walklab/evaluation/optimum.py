"""How sure the optimum of P_Stat is (Agethen et al. 2017, section 7.3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from walklab.errors import InputError
from walklab.evaluation.bootstrap import DECIMALS, RESAMPLES, Array, cluster_codes, cluster_counts, interval, resampled_sums
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.modes import modes
from walklab.steering.space import ParameterSpace

MOST_RESAMPLES = 1000  # each is a search of its own


def optimum_table(
    optimum: Sequence[float],
    on_edge: Sequence[str],
    spread: Sequence[float],
    scores: Array,
    participants: Sequence[str],
    space: ParameterSpace,
    rng: np.random.Generator,
    resamples: int = RESAMPLES,
) -> pd.DataFrame:
    """The optimum with 95 % intervals: how far it moves when participants are resampled.

    In every resample the optimum is sought between the cells, on the mean map interpolated as P_Adapt interpolates its
    maps, so the interval is as wide as the resamples differ and may be narrower than a grid step. ``interpolated`` is
    the same search on the mean map of all participants. Annealing found the optimum on exact simulations, so what
    ``interpolated`` is off it is the error of the interpolation; all resamples share it, and the interval is moved
    by it (``optimum + resampled - interpolated``, inside the parameter space).

    Parameters
    ----------
    optimum : (P,) found by annealing
    on_edge : names of the parameters whose optimum lies on the border of the space
    spread : (P,) how far apart the optima of all runs lie
    scores : (W, C) of the training walks, smaller is better
    participants : (W,) who walked
    resamples : of the participants; no more than 1000 are made

    Returns
    -------
    DataFrame[parameter, unit, value, low, high, interpolated, spread, on_edge]
    """
    if scores.shape != (len(participants), len(space.cells)):
        raise InputError(f"optimum: scores {scores.shape} do not fit {len(participants)} walks and {len(space.cells)} cells")
    codes, clusters = cluster_codes(participants)
    counts = cluster_counts(clusters, min(resamples, MOST_RESAMPLES), rng)
    counts = np.concatenate([np.ones((1, clusters), dtype=counts.dtype), counts])
    sizes = resampled_sums(np.ones(len(codes)), codes, counts)
    mean_maps = resampled_sums(np.asarray(scores, dtype=float), codes, counts) / sizes[:, None]
    interpolant = GridInterpolant(space.shape)
    # The search is for the highest point and takes heights for suitability, at most 1.
    heights = -mean_maps / np.abs(mean_maps).max(axis=1, keepdims=True).clip(min=np.finfo(float).tiny)
    # A smooth map is highest within a step of its best cell, so the cells beyond that are left out of the search.
    nodes, last = interpolant.nodes[np.argmax(heights, axis=1)], np.array(space.shape) - 1.0
    lower, upper = np.maximum(nodes.min(axis=0) - 1, 0), np.minimum(nodes.max(axis=0) + 1, last)
    parameters = space.from_unit(modes(interpolant, interpolant.coefficients(heights), lower, upper)[0])
    moved = np.asarray(optimum, dtype=float) + parameters[1:] - parameters[0]
    low, high = interval(np.clip(moved, *space.bounds.T), clusters)
    return pd.DataFrame(
        {
            "parameter": list(space.names),
            "unit": [axis.unit for axis in space.axes],
            "value": np.asarray(optimum, dtype=float),
            "low": low,
            "high": high,
            "interpolated": np.round(parameters[0], DECIMALS),
            "spread": np.asarray(spread, dtype=float),
            "on_edge": [name in on_edge for name in space.names],
        }
    )
