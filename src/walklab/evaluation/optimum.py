"""How sure the optimum of P_Stat is (Agethen et al. 2017, section 7.3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from walklab.errors import InputError
from walklab.evaluation.bootstrap import RESAMPLES, Array, cluster_codes, cluster_counts, interval, resampled_sums
from walklab.steering.space import ParameterSpace


def optimum_table(
    optimum: Sequence[float],
    on_edge: Sequence[str],
    scores: Array,
    participants: Sequence[str],
    space: ParameterSpace,
    rng: np.random.Generator,
    resamples: int = RESAMPLES,
) -> pd.DataFrame:
    """The optimum with 95 % intervals: the best cell of the mean map when participants are resampled.

    The grid resolves no better than half a step, so the interval is widened by half a step on each
    side, inside the parameter space; and it always holds the optimum itself.

    Parameters
    ----------
    optimum : (P,) found by annealing
    on_edge : names of the parameters whose optimum lies on the border of the space
    scores : (W, C) of the training walks, smaller is better
    participants : (W,) who walked

    Returns
    -------
    DataFrame[parameter, unit, value, low, high, on_edge]
    """
    if scores.shape != (len(participants), len(space.cells)):
        raise InputError(f"optimum: scores {scores.shape} do not fit {len(participants)} walks and {len(space.cells)} cells")
    codes, clusters = cluster_codes(participants)
    counts = cluster_counts(clusters, resamples, rng)
    sizes = resampled_sums(np.ones(len(codes)), codes, counts)
    mean_maps = resampled_sums(np.asarray(scores, dtype=float), codes, counts) / sizes[:, None]
    low, high = interval(space.to_unit(space.cells[np.argmin(mean_maps, axis=1)]), clusters)
    last = np.array(space.shape) - 1.0
    low, high = (space.from_unit(np.clip(steps, 0, last)) for steps in (low - 0.5, high + 0.5))
    return pd.DataFrame(
        {
            "parameter": list(space.names),
            "unit": [axis.unit for axis in space.axes],
            "value": np.asarray(optimum, dtype=float),
            "low": np.minimum(low, optimum),
            "high": np.maximum(high, optimum),
            "on_edge": [name in on_edge for name in space.names],
        }
    )
