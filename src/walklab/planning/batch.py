"""Captured walks brought to a planner's step and packed for compiled loops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.planning.protocol import WalkBatch

Array = NDArray[np.float64]


def resample_time(time_s: Array, position_m: Array, step_s: float) -> Array:
    """Positions every ``step_s`` from the first sample on, linear in between.

    Parameters
    ----------
    time_s : (n,) array, ascending
    position_m : (n, 2) array

    Returns
    -------
    (m, 2) array; a rest shorter than a step at the end is dropped
    """
    count = int(np.floor((time_s[-1] - time_s[0]) / step_s + 1e-6)) + 1
    # Rounding may put the last step a hair behind the last sample; interpolation then holds that sample.
    at = time_s[0] + np.arange(count) * step_s
    return np.column_stack([np.interp(at, time_s, position_m[:, axis]) for axis in (0, 1)])


def pack_walks(
    positions: Sequence[Array],
    routes: Sequence[Array],
    start_speeds: Sequence[float] | Array,
    end_speeds: Sequence[float] | Array,
    lengths: Sequence[float] | Array,
    step_s: float,
) -> WalkBatch:
    """Pack captured walks, sampled every ``step_s``, with the routes they are compared along.

    Parameters
    ----------
    positions : one (n, 2) array per walk, metres, first frame at the start of the walk
    routes : one (m, 2) array per walk, metres
    start_speeds, end_speeds : m/s, one per walk
    lengths : length of each captured walk, metres; scores are divided by it

    Raises
    ------
    InputError
        If the lists differ in length, an array is not (n, 2), or a length is not above 0.
    """
    sizes = {len(positions), len(routes), len(start_speeds), len(end_speeds), len(lengths)}
    if len(sizes) != 1:
        raise InputError(f"walks, routes, speeds and lengths differ in number: {sorted(sizes)}; pass one of each per walk")
    for index, length in enumerate(lengths):
        if not length > 0:
            raise InputError(f"walk {index} of the batch: its length is {length} m; leave walks without length out")
    captured_m, captured_offsets = _joined(positions, "positions", 1)
    routes_m, route_offsets = _joined(routes, "route", 2)
    return WalkBatch(
        routes_m=routes_m,
        route_offsets=route_offsets,
        captured_m=captured_m,
        captured_offsets=captured_offsets,
        start_speeds_m_s=np.asarray(start_speeds, dtype=float),
        end_speeds_m_s=np.asarray(end_speeds, dtype=float),
        lengths_m=np.asarray(lengths, dtype=float),
        step_s=step_s,
    )


def _joined(arrays: Sequence[Array], what: str, fewest: int) -> tuple[Array, NDArray[np.int64]]:
    for index, array in enumerate(arrays):
        if np.ndim(array) != 2 or np.shape(array)[1] != 2 or len(array) < fewest:
            raise InputError(f"walk {index} of the batch: {what} of shape {np.shape(array)}; (n, 2) with n >= {fewest} is needed")
    joined = np.concatenate([np.asarray(array, dtype=float) for array in arrays]) if len(arrays) else np.empty((0, 2))
    offsets = np.concatenate([[0], np.cumsum([len(array) for array in arrays])]).astype(np.int64)
    return np.ascontiguousarray(joined), offsets
