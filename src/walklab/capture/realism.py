"""How real the synthetic capture is: the same measures of synthetic and of recorded walks, side by side.

What the recordings cannot tell is not compared: the goal-directed walks have lost their time, the CMU walks begin and end
while walking, and the recording of the feet is one person's. Nothing is fitted to any of these numbers afterwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import ks_2samp

from walklab.capture.foot_markers import REACHED, STEP_S, Ramps, step_mean
from walklab.capture.goal_directed import STRAIGHT_RAD, GoalDirectedWalk
from walklab.capture.walks import Walk
from walklab.geometry.curves import RESAMPLING_M, length, mean_curvature, resample, smooth
from walklab.geometry.standing import speeds

Array = NDArray[np.float64]

MEASURES = {
    "lateral_excursion": "m",
    "excess_length": "%",
    "curvature": "1/m",
    "peak_speed": "m/s",
    "speed_swing": "%",
    "lateral_sway": "m",
    "rise_time": "s",
    "fall_time": "s",
}
SHAPE, PEAK = ("lateral_excursion", "excess_length", "curvature"), ("peak_speed",)
PROFILES = ("start_profile", "stop_profile")  # of speed, as shares of its top; for the figure alone
PROFILE_AT = np.linspace(0, 1, 21)  # shares of the time from a tenth to nine tenths of the top, or back
GAIT, RAMPS = ("speed_swing", "lateral_sway"), ("rise_time", "fall_time")
# By the straight distance from start to end; the recorded distances leave 2.25 to 3 m empty.
DISTANCE_EDGES_M = (0.4, 1.25, 2.25, 3.0, 3.75, 4.5)
# Walks whose path is longer turn round something or shift about at the start; their peak speeds are not those of their distance.
DIRECT_RATIO = 1.3
# ORIGIN.md of the recording: the velocities of subjects 8 to 10 have spikes (their paths have none).
SPIKED_SUBJECTS = (8, 9, 10)
# Bohannon 1997: mean maximum gait speed of men in their twenties, the fastest group. A peak above it is a spike, not a walk.
FASTEST_GAIT_M_S = 2.533
STEADY_M = 3.5  # straight walks from here on have a middle at nearly constant speed
STRIDE_S = 2 * STEP_S
PATH_SCALE_M = 0.1  # smoothing of every path before it is measured


@dataclass(frozen=True)
class Sample:
    """One measure of some walks: values, the straight distance of each, where they come from; of a profile, its place."""

    measure: str
    value: Array
    distance_m: Array
    source: str
    group: str
    at: float = np.nan


def path_measures(path_m: Array) -> tuple[float, float, float]:
    """Largest lateral excursion from the straight line (m), length in excess of it (%), mean absolute curvature (1/m).

    The path is resampled by arc length and smoothed by a Gaussian of 0.1 m first, whoever recorded it.
    """
    even = resample(path_m)
    path = smooth(even, PATH_SCALE_M / RESAMPLING_M)
    chord = path[-1] - path[0]
    distance = float(np.hypot(*chord))
    offset = (path - path[0]) @ np.array([-chord[1], chord[0]]) / distance
    return float(np.abs(offset).max()), 100 * (length(path) / distance - 1), mean_curvature(path_m, PATH_SCALE_M)


def gait_measures(position_m: Array, step_s: float) -> tuple[float, float]:
    """Swing of speed within a step (% of the mean speed) and lateral sway within a stride (m), as standard deviations.

    Each is what a moving mean over one step (one stride) takes away, in the middle of the walk, where speed is nearly constant.
    """
    speed = speeds(position_m, step_s)
    chord = position_m[-1] - position_m[0]
    aside = (position_m - position_m[0]) @ np.array([-chord[1], chord[0]]) / np.hypot(*chord)
    margin = round(STRIDE_S / 2 / step_s)
    middle = slice(max(margin, len(speed) // 4), min(len(speed) - margin, len(speed) - len(speed) // 4))
    swing = (speed - step_mean(speed, round(STEP_S / step_s)))[middle]
    sway = (aside - step_mean(aside, round(STRIDE_S / step_s)))[middle]
    return 100 * float(swing.std() / speed[middle].mean()), float(sway.std())


def rise_time(speed: Array, step_s: float, top: float | None = None) -> float:
    """From a tenth to nine tenths of the largest speed (or of ``top``), s; speed is averaged over one step first."""
    first, last, _ = _rise(speed, top)
    return float(last - first) * step_s


def rise_profile(speed: Array, top: float | None = None) -> tuple[float, ...]:
    """Speed over its top (1) at equal shares of the time of :func:`rise_time`: the shape of a start, whatever its pace."""
    first, last, top = _rise(speed, top)
    return tuple(np.interp(first + PROFILE_AT * (last - first), np.arange(len(speed)), speed) / top)


def _rise(speed: Array, top: float | None) -> tuple[int, int, float]:
    """Frames at a tenth and at nine tenths of the top, and the top."""
    top = float(speed.max()) if top is None else top
    return int(np.argmax(speed >= 0.1 * top)), int(np.argmax(speed >= min(0.9 * top, speed.max()))), top


def _even_steps(walk: Walk) -> float:
    return float(np.mean(np.diff(walk.time_s)))


def _columns(
    names: Sequence[str], values: Iterable[tuple[float, ...]], distance_m: Array, source: str, group: str
) -> list[Sample]:
    table = np.array(list(values), dtype=float).reshape(-1, len(names))
    return [Sample(name, table[:, column], distance_m, source, group) for column, name in enumerate(names)]


def _profiles(
    starts_and_stops: Iterable[tuple[Array, Array]], distance_m: Array, source: str, group: str, top: float | None = None
) -> list[Sample]:
    """Profiles of starts and of stops, these backwards in time: a sample for each of ``PROFILE_AT``."""
    both = [[rise_profile(speed, top) for speed in ramps] for ramps in starts_and_stops]
    table = np.array(both, dtype=float).reshape(-1, len(PROFILES), len(PROFILE_AT))
    return [
        Sample(name, table[:, number, place], distance_m, source, group, float(at))
        for number, name in enumerate(PROFILES)
        for place, at in enumerate(PROFILE_AT)
    ]


def synthetic_samples(walks: Sequence[Walk]) -> list[Sample]:
    """Everything that is measured on captured walks of experiment 1."""
    straight = [walk for walk in walks if str(walk.row["configuration"]).startswith("straight")]
    direct = [walk for walk in walks if float(walk.row["length_m"]) <= DIRECT_RATIO * _distance(walk)]
    steady = [walk for walk in straight if _distance(walk) >= STEADY_M]
    origin = "synthetic capture", "synthetic"
    return [
        *_columns(SHAPE, (path_measures(walk.position_m) for walk in straight), _distances(straight), *origin),
        *_columns(PEAK, ((float(_speeds(walk).max()),) for walk in direct), _distances(direct), *origin),
        *_columns(GAIT, (gait_measures(walk.position_m, _step_s(walk)) for walk in steady), _distances(steady), *origin),
        *_columns(RAMPS, (_rise_and_fall(walk) for walk in steady), _distances(steady), *origin),
        *_profiles((_start_and_stop(walk) for walk in steady), _distances(steady), *origin),
    ]


def _rise_and_fall(walk: Walk) -> tuple[float, float]:
    start, stop = _start_and_stop(walk)
    return rise_time(start, _step_s(walk)), rise_time(stop, _step_s(walk))


def _start_and_stop(walk: Walk) -> tuple[Array, Array]:
    """Speed averaged over a step, m/s, forwards and backwards in time."""
    step_s = _step_s(walk)
    # A person stands before and after the walk: the mean over a step reaches into these moments.
    still = np.zeros(round(STEP_S / step_s))
    speed = step_mean(np.concatenate([still, _speeds(walk), still]), len(still))
    return speed, speed[::-1]


def _speeds(walk: Walk) -> Array:
    return speeds(walk.position_m, _step_s(walk))


def _step_s(walk: Walk) -> float:
    return float(np.mean(np.diff(walk.time_s)))


def _distance(walk: Walk) -> float:
    return float(np.hypot(*(walk.position_m[-1] - walk.position_m[0])))


def _distances(walks: Iterable[Walk]) -> Array:
    return np.array([_distance(walk) for walk in walks], dtype=float)


def goal_directed_samples(walks: Iterable[GoalDirectedWalk]) -> list[Sample]:
    """Path shapes of the straight walks of all subjects; peak speeds of the direct walks, the spiked subjects apart.

    Shapes are given a second time for those who faced the goal within 10 degrees: turning towards it is then no excuse.
    """
    everyone = list(walks)
    source = "Maroger et al. 2020"
    found: list[Sample] = []
    for group, within_rad in (("recorded", STRAIGHT_RAD), ("recorded, facing within 10 degrees", np.deg2rad(10.0))):
        straight = [walk for walk in everyone if walk.facing_off_rad <= within_rad]
        ways = np.array([walk.distance_m for walk in straight])
        found += _columns(SHAPE, (path_measures(walk.position_m) for walk in straight), ways, source, group)
    direct = [walk for walk in everyone if length(walk.position_m) <= DIRECT_RATIO * walk.distance_m]
    used = [walk for walk in direct if walk.subject not in SPIKED_SUBJECTS and walk.peak_speed_m_s <= FASTEST_GAIT_M_S]
    spiked = [walk for walk in direct if walk.subject in SPIKED_SUBJECTS]
    for group, chosen in (("recorded", used), ("recorded, subjects with spikes", spiked)):
        ways = np.array([walk.distance_m for walk in chosen])
        found += _columns(PEAK, ((walk.peak_speed_m_s,) for walk in chosen), ways, source, group)
    return found


def gait_samples(walks: Sequence[Walk]) -> list[Sample]:
    """Swing of speed and lateral sway of recorded walks at steady speed."""
    measured = (gait_measures(walk.position_m, _step_s(walk)) for walk in walks)
    return _columns(GAIT, measured, _distances(walks), "CMU", "recorded")


def ramp_samples(ramps: Ramps, distance_m: float = 20.0) -> list[Sample]:
    """Rise and fall of one person's walk over 20 m, of its cruising speed: times and profiles."""
    both, top = (ramps.start, ramps.stop[::-1]), 1 / REACHED
    measured = tuple(rise_time(ramp, ramps.step_s, top) for ramp in both)
    origin = np.array([distance_m]), "gaitmap", "recorded"
    return [*_columns(RAMPS, [measured], *origin), *_profiles([both], *origin, top=top)]


def value_table(samples: Iterable[Sample]) -> pd.DataFrame:
    """Every value, for the figure: DataFrame[quantity, group, source, at (NaN but of profiles), distance_m, value]."""
    frames = [
        pd.DataFrame(
            {
                "quantity": s.measure,
                "group": s.group,
                "source": s.source,
                "at": s.at,
                "distance_m": s.distance_m,
                "value": s.value,
            }
        )
        for s in samples
    ]
    return pd.concat(frames, ignore_index=True)


def compare(samples: Sequence[Sample], absent: Sequence[str] = ()) -> pd.DataFrame:
    """Synthetic beside recorded, by measure and distance.

    Parameters
    ----------
    samples : of both kinds; measures of path and peak speed are split by distance, the others are not
    absent : why a recording could not be read, one sentence each

    Returns
    -------
    DataFrame[quantity, unit, distance_low_m, distance_high_m, synthetic_median, synthetic_q25, synthetic_q75, n_synthetic,
    recorded_median, recorded_q25, recorded_q75, n_recorded, ks_distance, source, remark]; ``ks_distance`` is the largest
    distance of the two distribution functions (Kolmogorov and Smirnov), without a p value because walks of one person
    are not independent
    """
    rows = []
    for measure, unit in MEASURES.items():
        own = [sample for sample in samples if sample.measure == measure]
        synthetic = next(sample for sample in own if sample.group == "synthetic")
        recorded: list[Sample | None] = [sample for sample in own if sample.group != "synthetic"]
        remark = "" if recorded else "; ".join(absent)
        for low, high in _spans(measure):
            for other in recorded or [None]:
                row = _row(synthetic, other, low, high)
                if row["n_synthetic"] + row["n_recorded"]:
                    rows.append({"quantity": measure, "unit": unit, **row, "remark": remark})
    return pd.DataFrame(rows)


def _spans(measure: str) -> list[tuple[float, float]]:
    return list(pairwise(DISTANCE_EDGES_M)) if measure in SHAPE + PEAK else [(0.0, np.inf)]


def _row(synthetic: Sample, recorded: Sample | None, low: float, high: float) -> dict:
    ours = synthetic.value[(synthetic.distance_m >= low) & (synthetic.distance_m < high)]
    theirs = np.empty(0)
    if recorded is not None:
        theirs = recorded.value[(recorded.distance_m >= low) & (recorded.distance_m < high)]
    both = len(ours) > 1 and len(theirs) > 1
    return {
        "distance_low_m": low,
        "distance_high_m": high,
        **_quartiles(ours, "synthetic"),
        **_quartiles(theirs, "recorded"),
        "ks_distance": float(ks_2samp(ours, theirs).statistic) if both else np.nan,
        "source": "" if recorded is None else f"{recorded.source}{recorded.group.removeprefix('recorded')}",
    }


def _quartiles(values: Array, name: str) -> dict:
    q25, median, q75 = np.quantile(values, (0.25, 0.5, 0.75)) if len(values) else (np.nan,) * 3
    return {f"{name}_median": median, f"{name}_q25": q25, f"{name}_q75": q75, f"n_{name}": len(values)}
