"""Distances between a captured walk and its simulations (Agethen et al. 2017, section 4.3, eq. 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.standing import Standing, travel_time_s

Array = NDArray[np.float64]
Horizon = Literal["captured", "both"]


class Distance(Protocol):
    """(captured (T, 2), simulated (C, T, 2), step_s, length_m) -> (C,)."""

    def __call__(self, captured: Array, simulated: Array, step_s: float, length_m: float) -> Array: ...


@dataclass(frozen=True)
class Metric:
    """A distance, its unit and how long it looks.

    Attributes
    ----------
    name, unit : what results call it
    distance : the function; smaller is better
    horizon : "captured" compares the frames of the captured walk only; "both" goes on until
        captured and simulated walk have both ended, each standing at its end after that
    """

    name: str
    unit: str
    distance: Distance
    horizon: Horizon = "captured"

    def __call__(self, captured: Array, simulated: Array, step_s: float, length_m: float) -> Array:
        return self.distance(captured, simulated, step_s, length_m)


def _separations(captured: Array, simulated: Array) -> Array:
    return np.hypot(simulated[..., 0] - captured[:, 0], simulated[..., 1] - captured[:, 1])


def euclid(captured: Array, simulated: Array, step_s: float, length_m: float) -> Array:
    """m_Euclid, eq. 5: ``sum_t |T(t) - A(t)| * step_s / length_m`` (s).

    The step makes the sum an integral over time, so that the value does not depend
    on the sampling rate.
    """
    return _separations(captured, simulated).sum(axis=-1) * step_s / length_m


def mean_distance(captured: Array, simulated: Array, step_s: float, length_m: float) -> Array:
    """Mean distance over the frames (m)."""
    return _separations(captured, simulated).mean(axis=-1)


def end_point(captured: Array, simulated: Array, step_s: float, length_m: float) -> Array:
    """Distance at the last frame (m)."""
    return _separations(captured[-1:], simulated[:, -1:])[:, 0]


def travel_time(captured: Array, simulated: Array, step_s: float, length_m: float, standing: Standing | None = None) -> Array:
    """Absolute difference of the travel times (s); a person stands below the speed of ``standing`` or its default."""
    threshold = (standing or Standing()).standing_speed_m_s
    own = travel_time_s(captured, step_s, threshold)
    return np.array([abs(travel_time_s(walk, step_s, threshold) - own) for walk in simulated])


def frechet(captured: Array, simulated: Array, step_s: float, length_m: float) -> Array:
    """Discrete Frechet distance between the two paths, whatever their timing (m; Eiter & Mannila 1994)."""
    return np.array([_frechet(captured, walk) for walk in simulated])


@njit(cache=True)
def _frechet(first: Array, second: Array) -> float:
    above = np.empty(len(second))
    row = np.empty(len(second))
    for i in range(len(first)):
        for j in range(len(second)):
            gap = np.hypot(first[i, 0] - second[j, 0], first[i, 1] - second[j, 1])
            if i == 0 and j == 0:
                reach = gap
            elif i == 0:
                reach = max(gap, row[j - 1])
            elif j == 0:
                reach = max(gap, above[j])
            else:
                reach = max(gap, min(above[j], row[j - 1], above[j - 1]))
            row[j] = reach
        above, row = row, above
    return above[-1]


METRICS: dict[str, Metric] = {
    metric.name: metric
    for metric in (
        Metric("euclid", "s", euclid),
        Metric("euclid_until_both_end", "s", euclid, "both"),
        Metric("mean_distance", "m", mean_distance),
        Metric("end_point", "m", end_point),
        Metric("frechet", "m", frechet, "both"),
        Metric("travel_time", "s", travel_time, "both"),
    )
}


def metric_named(name: str, standing: Standing | None = None) -> Metric:
    """The metric of that name.

    Parameters
    ----------
    standing : speeds by which the metric tells standing from walking, if it does; by default those of ``Standing()``

    Raises
    ------
    InputError
        If there is none.
    """
    if name not in METRICS:
        raise InputError(f"metric: there is no {name!r}; choose one of {', '.join(sorted(METRICS))}")
    metric = METRICS[name]
    if standing is not None and metric.distance is travel_time:
        return replace(metric, distance=partial(travel_time, standing=standing))
    return metric
