"""From captured positions of one walk, in whatever format they came, to a row of the walks table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import ACCEPTED, SAMPLES, WALKS
from walklab.geometry import curves
from walklab.geometry.standing import Standing, speeds

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ImportRules:
    """What counts as a walk from one place to another.

    Attributes
    ----------
    smoothing_sigma_frames : Gaussian smoothing (Agethen et al. 2017, section 4.4: sigma 2)
    step_duration_s : speeds at moving ends are means over this time, about one step
    minimum_distance_m : start and end must be this far apart
    minimum_directness : distance from start to end over length of the path must be at least this
    """

    smoothing_sigma_frames: float = 2.0
    # ASSUME: one step lasts 0.5 s, because people walk about 110-120 steps a minute; the mean over a whole step takes the
    # swing of speed within each step out of the start and end speed, which a mean over the first frames would not.
    step_duration_s: float = 0.5
    minimum_distance_m: float = 0.5
    # ASSUME: a path twice as long as the way from its start to its end is no walk to a goal, because the task holds no
    # other goal than the end; a detour half around a disc is still 0.64.
    minimum_directness: float = 0.5


@dataclass(frozen=True)
class Positions:
    """Captured positions of one candidate, evenly sampled.

    Attributes
    ----------
    walk, participant, scene, configuration, height_m : as the walks table has them
    start_s : time of the first position within its recording
    """

    walk: str
    participant: str
    scene: str
    configuration: str
    height_m: float
    start_s: float
    rate_hz: float
    position_m: Array


def cut_walk(
    positions: Positions, standing: Standing, curvature_scale_m: float, rules: ImportRules
) -> tuple[dict[str, Any], Array]:
    """Smooth one candidate, cut it at its standing phases and describe it.

    Where the person stands at an end, the walk starts (ends) at the last (first) standing frame and the speed there
    is 0. Where the person already (still) walks, the walk starts (ends) with the recording, and the speed there is
    the displacement over the first (last) ``rules.step_duration_s`` divided by that time.

    Returns
    -------
    row : dict with the columns of the walks table; ``rejection`` tells why it is no walk, or is empty
    path_m : (n, 2) array, the smoothed positions between the boundaries
    """
    smoothed = curves.smooth(positions.position_m, rules.smoothing_sigma_frames)
    first, last = walk_span(speeds(smoothed, 1 / positions.rate_hz), standing)
    path = smoothed[first : last + 1]
    speed = speeds(smoothed, 1 / positions.rate_hz)
    frames = max(1, round(rules.step_duration_s * positions.rate_hz))
    start_speed = 0.0 if speed[first] < standing.standing_speed_m_s else _mean_speed(path[: frames + 1], positions.rate_hz)
    end_speed = 0.0 if speed[last] < standing.standing_speed_m_s else _mean_speed(path[-frames - 1 :], positions.rate_hz)
    row = {
        "walk": positions.walk,
        "participant": positions.participant,
        "scene": positions.scene,
        "configuration": positions.configuration,
        "start_s": positions.start_s + first / positions.rate_hz,
        "duration_s": (last - first) / positions.rate_hz,
        "length_m": curves.length(path),
        "curvature_1_m": curves.mean_curvature(path, curvature_scale_m),
        "height_m": positions.height_m,
        "start_x_m": path[0, 0],
        "start_y_m": path[0, 1],
        "end_x_m": path[-1, 0],
        "end_y_m": path[-1, 1],
        "start_speed_m_s": start_speed,
        "end_speed_m_s": end_speed,
        "rejection": _rejection(path, len(path) - 1 < 2 * frames, float(speed.max()), standing, rules),
    }
    return row, path


def walk_span(speed_m_s: Array, standing: Standing) -> tuple[int, int]:
    """Frames of the last standing before, and of the first standing after, the time above walking speed.

    Sway that crosses the standing speed during a standing phase does not move the boundaries, because they are
    sought outwards from where the person undoubtedly walks. Without such a time the whole candidate is returned.
    """
    walking = np.flatnonzero(speed_m_s >= standing.walking_speed_m_s)
    if walking.size == 0:
        return 0, len(speed_m_s) - 1
    still = speed_m_s < standing.standing_speed_m_s
    before, after = np.flatnonzero(still[: walking[0]]), np.flatnonzero(still[walking[-1] :])
    first = int(before[-1]) if before.size else 0
    last = int(walking[-1] + after[0]) if after.size else len(speed_m_s) - 1
    return first, last


def _mean_speed(path_m: Array, rate_hz: float) -> float:
    return float(np.hypot(*(path_m[-1] - path_m[0])) * rate_hz / (len(path_m) - 1)) if len(path_m) > 1 else 0.0


def _rejection(path_m: Array, short: bool, peak_speed_m_s: float, standing: Standing, rules: ImportRules) -> str:
    distance, extent = float(np.hypot(*(path_m[-1] - path_m[0]))), curves.length(path_m)
    if peak_speed_m_s < standing.walking_speed_m_s:
        return f"never faster than {standing.walking_speed_m_s:g} m/s"
    if short:
        return f"shorter than two steps of {rules.step_duration_s:g} s"
    if distance < rules.minimum_distance_m:
        return f"start and end closer than {rules.minimum_distance_m:g} m"
    if distance < rules.minimum_directness * extent:
        return f"path more than {1 / rules.minimum_directness:g} times as long as the way from start to end"
    return ACCEPTED


def build_tables(
    candidates: Sequence[Positions], standing: Standing, curvature_scale_m: float, rules: ImportRules
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The walks table (all candidates) and the samples table (accepted walks only)."""
    rows, samples = [], []
    for positions in candidates:
        row, path = cut_walk(positions, standing, curvature_scale_m, rules)
        rows.append(row)
        if row["rejection"] == ACCEPTED:
            time_s = np.arange(len(path)) / positions.rate_hz
            samples.append(pd.DataFrame({"walk": positions.walk, "time_s": time_s, "x_m": path[:, 0], "y_m": path[:, 1]}))
    empty = pd.DataFrame({name: pd.Series(dtype=object if name == "walk" else float) for name in SAMPLES.columns})
    return pd.DataFrame(rows, columns=list(WALKS.columns)), pd.concat(samples, ignore_index=True) if samples else empty
