"""Leave-one-out errors of both interpolations of the blending space (Agethen et al. 2017, section 8.2).

All errors are ``100 * (predicted suitability - left-out suitability)`` in percent.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from walklab.errors import InputError
from walklab.evaluation.bootstrap import RESAMPLES, Array, Integers, cluster_codes, cluster_counts, interval, resampled_sums
from walklab.evaluation.folds import by_participant
from walklab.randomness import generator
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.suitability import normalise
from walklab.steering.training import TrainingSettings, train_blending_space
from walklab.steering.weighting import Weighting, weights

_ROWS = 500  # maps predicted at once, which bounds the memory
COLUMNS = ["method", "map", "participant", "is_blend", "error_percent"]

# ASSUME: Section 8.2 subtracts the suitability scores without saying which from which; the left-out score is taken
# from the predicted one, so that a positive difference means a prediction that is too favourable.


def k_nearest_errors(
    space: BlendingSpace, k: int, how: Weighting = "linear", participants: Sequence[str] | None = None
) -> pd.DataFrame:
    """Each map predicted by its k nearest others: median difference over the cells.

    The paper's reading: blends of the left-out map stay among its neighbours, so that the
    answer leaks; :func:`left_out_participant_errors` is the reading without the leak.

    Parameters
    ----------
    participants : participant of each captured map; a blend counts to the parent with the largest weight

    Returns
    -------
    DataFrame[method = "k_nearest", map (index in the space), participant, is_blend, error_percent], a row per map

    Raises
    ------
    InputError
        If the space has fewer than k + 1 maps.
    """
    count = len(space)
    if k > count - 1:
        raise InputError(f"leave-one-out: k = {k} needs at least {k + 1} maps, the blending space has {count}; lower k")
    indices, shares = _others(space, k, how)
    errors = np.empty(count)
    for start in range(0, count, _ROWS):
        rows = slice(start, start + _ROWS)
        errors[rows] = _median_difference(indices[rows], shares[rows], space.maps, space.maps[rows])
    main = space.parents[np.arange(count), np.argmax(space.parent_weights, axis=1)]
    owners = np.asarray(participants, dtype=str)[main] if participants is not None else np.array([f"map_{i}" for i in main])
    return _rows("k_nearest", np.arange(count), owners, space.is_blend, errors)


def _others(space: BlendingSpace, k: int, how: Weighting) -> tuple[Integers, Array]:
    """Indices and weights of the k nearest other maps of each map, each (N, k)."""
    count = len(space)
    wanted = min(k + 2, count)
    indices, distances = space.nearest(space.vectors, wanted)
    own = indices == np.arange(count)[:, None]
    # Where many maps share one vector, a map may not be among its own nearest; then the farthest is left out.
    own[~own.any(axis=1), -1] = True
    indices, distances = (values[~own].reshape(count, wanted - 1) for values in (indices, distances))
    beyond = distances[:, k] if wanted == k + 2 else None
    return indices[:, :k], weights(distances[:, :k], how, beyond=beyond)


def _median_difference(indices: Integers, shares: Array, maps: Array, truth: Array) -> Array:
    rows, k = indices.shape
    mixing = csr_array((shares.ravel(), indices.ravel(), np.arange(0, rows * k + 1, k)), shape=(rows, len(maps)))
    return 100 * np.median(mixing @ maps - truth, axis=1)


def left_out_participant_errors(
    scores: Array, vectors: pd.DataFrame, participants: Sequence[str], settings: TrainingSettings, seed: int, replicate: int
) -> pd.DataFrame:
    """Each captured map predicted from a blending space that was up-sampled without its participant.

    Parameters
    ----------
    scores : (W, C) raw scores of the captured walks
    vectors : (W, D) their dependencies; the columns name them
    participants : (W,) who walked

    Returns
    -------
    DataFrame[method = "k_nearest_by_participant", map (index of the walk), participant, is_blend = False, error_percent]

    Raises
    ------
    InputError
        If there is only one participant.
    """
    owners = np.asarray(participants, dtype=str)
    maps = normalise(scores, settings.normalisation)
    frames = []
    for name, (rest, left_out) in by_participant(owners).items():
        rng = generator(seed, replicate, "leave_one_out", name)
        space = train_blending_space(scores[rest], vectors.iloc[rest], owners[rest].tolist(), settings, rng)
        asked = vectors.iloc[left_out].to_numpy(dtype=float)
        indices, shares = space.neighbours(asked, min(settings.k, len(space)), settings.weights)
        errors = _median_difference(indices, shares, space.maps, maps[left_out])
        frames.append(_rows("k_nearest_by_participant", left_out, owners[left_out], np.zeros(len(left_out), bool), errors))
    return pd.concat(frames, ignore_index=True).sort_values("map", ignore_index=True)


def rbf_errors(interpolant: GridInterpolant, maps: ArrayLike, rng: np.random.Generator, cells_per_map: int = 100) -> pd.DataFrame:
    """Leave-one-cell-out error of the radial basis functions at random cells of each map, their median per map.

    Without solving anew (Rippa 1999): the interpolant without node i misses it by
    ``f_i - s_i(x_i) = c_i / (A^-1)_ii``, with ``A`` the system including its polynomial part.

    Parameters
    ----------
    maps : (N, C) suitability
    cells_per_map : cells drawn per map without replacement; all where a map has fewer

    Returns
    -------
    DataFrame[method = "rbf", map, participant = "", is_blend = False, error_percent], a row per map
    """
    values = np.atleast_2d(np.asarray(maps, dtype=float))
    cells = interpolant.cells
    drawn = min(cells_per_map, cells)
    errors = np.empty(len(values))
    for start in range(0, len(values), _ROWS):
        chunk = values[start : start + _ROWS]
        picked = np.argsort(rng.random(chunk.shape), axis=1)[:, :drawn]
        missed = left_out_cell_errors(interpolant, chunk)
        errors[start : start + _ROWS] = 100 * np.median(np.take_along_axis(missed, picked, axis=1), axis=1)
    count = len(values)
    return _rows("rbf", np.arange(count), np.full(count, ""), np.zeros(count, bool), errors)


def left_out_cell_errors(interpolant: GridInterpolant, maps: Array) -> Array:
    """Predicted - true value of every cell from all others, (N, C), by Rippa's closed form."""
    return -interpolant.coefficients(maps)[:, : interpolant.cells] / interpolant.inverse_diagonal


def summarise_leave_one_out(errors: pd.DataFrame, rng: np.random.Generator, resamples: int = RESAMPLES) -> pd.DataFrame:
    """Mean and standard deviation over maps, with 95 % intervals.

    Participants are resampled where the maps have some, maps otherwise (which leaves
    out that blends share parents).

    Returns
    -------
    DataFrame[method, statistic (mean, sd), maps, value, low, high]
    """
    rows = []
    for method, group in errors.groupby("method", sort=False):
        values = group["error_percent"].to_numpy()
        named = group["participant"].to_numpy()
        codes, clusters = cluster_codes(named if (named != "").all() else np.arange(len(values)))
        moments = np.column_stack([np.ones_like(values), values, values**2])
        # Many clusters: drawn in chunks, since the table of counts has a column for each.
        sums = np.concatenate(
            [resampled_sums(moments, codes, cluster_counts(clusters, size, rng)) for size in _chunks(resamples, clusters)]
        )
        mean = sums[:, 1] / sums[:, 0]
        spread = np.sqrt(np.maximum(sums[:, 2] - sums[:, 0] * mean**2, 0) / np.maximum(sums[:, 0] - 1, 1))
        exact = values.mean(), values.std(ddof=1) if len(values) > 1 else np.nan
        for name, value, draws in zip(("mean", "sd"), exact, (mean, spread), strict=True):
            low, high = interval(draws, clusters)
            rows.append({"method": method, "statistic": name, "maps": len(values), "value": value, "low": low, "high": high})
    return pd.DataFrame(rows)


def _chunks(resamples: int, clusters: int) -> list[int]:
    size = max(1, min(resamples, 2_000_000 // clusters))
    return [min(size, resamples - start) for start in range(0, resamples, size)]


def _rows(method: str, index: NDArray[np.intp], owners: NDArray, blends: NDArray[np.bool_], errors: Array) -> pd.DataFrame:
    columns = [np.full(len(index), method), index, owners.astype(str), blends, errors]
    return pd.DataFrame(dict(zip(COLUMNS, columns, strict=True)))
