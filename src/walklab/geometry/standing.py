"""When a person stands and when a person walks: one definition for captured and simulated motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Standing:
    """Speeds that separate standing from walking.

    Attributes
    ----------
    standing_speed_m_s : below this a person stands
    walking_speed_m_s : a movement that never gets above this is not a walk (sway, bending)
    """

    standing_speed_m_s: float = 0.05
    walking_speed_m_s: float = 0.30


def speeds(points_m: Array, step_s: float) -> Array:
    """Speed at each sample by central differences, (n,) array, m/s."""
    if len(points_m) < 2:
        return np.zeros(len(points_m))
    return np.hypot(*np.gradient(points_m, step_s, axis=0).T)


def moving_span(speed_m_s: Array, threshold_m_s: float) -> tuple[int, int]:
    """Last standing frame before the first movement and first standing frame after the last.

    Frames outside the array count as standing only at its ends: a trajectory that
    starts (ends) above the threshold has its first (last) frame as boundary.

    Returns
    -------
    (start, end) frame indices; (0, 0) if nothing moves
    """
    moving = np.flatnonzero(speed_m_s >= threshold_m_s)
    if moving.size == 0:
        return 0, 0
    return max(int(moving[0]) - 1, 0), min(int(moving[-1]) + 1, len(speed_m_s) - 1)


def travel_time_s(points_m: Array, step_s: float, threshold_m_s: float) -> float:
    """Duration from the last standing frame to the first standing frame, seconds."""
    start, end = moving_span(speeds(points_m, step_s), threshold_m_s)
    return (end - start) * step_s
