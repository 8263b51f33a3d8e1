"""Planned walk distances in classes: the counterpart of figure 3 (Agethen et al. 2017, section 4.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.errors import InputError

# ASSUME: figure 3's bins are not published and Methods-Time Measurement counts walking by paces and by metres, so
# the distance classes are whole metres, with everything above 8 m (the length of an assembly station) in the last.
CLASS_EDGES_M = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)

# The two shares that section 4.1 states of the 3197 planned walk paths: 75 % up to 2 m, and a cut-off of 5 % at 4 m.
PUBLISHED_CUMULATIVE_SHARES = {2.0: 0.75, 4.0: 0.95}


def distance_shares(
    lengths_m: Mapping[str, NDArray[np.float64]],
    edges_m: Sequence[float] = CLASS_EDGES_M,
    published: Mapping[float, float] = PUBLISHED_CUMULATIVE_SHARES,
) -> pd.DataFrame:
    """Share of walks in each distance class, per data set, beside the published shares.

    Parameters
    ----------
    lengths_m : data set -> lengths of its planned routes
    edges_m : ascending class edges from 0; a class holds low < length <= high, and a last open class the rest
    published : upper edge -> published cumulative share

    Returns
    -------
    DataFrame[dataset, low_m, high_m, walks, share, cumulative_share, published_cumulative_share];
    ``high_m`` is infinite in the open class, published shares are NaN where none was stated

    Raises
    ------
    InputError
        If the edges do not ascend or a data set has no walks.
    """
    edges = np.asarray(edges_m, dtype=float)
    if len(edges) < 2 or np.any(np.diff(edges) <= 0):
        raise InputError(f"distance classes: edges {list(edges_m)} must ascend; sort them")
    bounds = np.append(edges, np.inf)
    frames = []
    for name, values in lengths_m.items():
        lengths = np.asarray(values, dtype=float)
        if len(lengths) == 0:
            raise InputError(f"distance classes: data set {name} has no walks; leave it out")
        classes = np.searchsorted(bounds[1:-1], lengths, side="left")
        walks = np.bincount(classes, minlength=len(bounds) - 1)
        share = walks / len(lengths)
        frames.append(
            pd.DataFrame(
                {
                    "dataset": name,
                    "low_m": bounds[:-1],
                    "high_m": bounds[1:],
                    "walks": walks,
                    "share": share,
                    "cumulative_share": np.cumsum(walks) / len(lengths),
                    "published_cumulative_share": [published.get(float(edge), np.nan) for edge in bounds[1:]],
                }
            )
        )
    return pd.concat(frames, ignore_index=True)
