"""From recordings to walks, by the phases of standing between them (Agethen et al. 2017, section 4.2)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from walklab.capture.walks import ACCEPTED, SAMPLES, WALKS, check
from walklab.errors import InputError
from walklab.geometry.curves import length, mean_curvature
from walklab.geometry.scene import Point
from walklab.geometry.standing import Standing, speeds

Array = NDArray[np.float64]

WALK_BACK = "walk back"


@dataclass(frozen=True)
class SegmentationRules:
    """When a movement is a walk, and when a walk is rejected.

    Attributes
    ----------
    minimum_standing_s : two movements with less standing between them are one interrupted walk
    minimum_distance_m : a movement that ends closer than this to where it began is no walk (bending, shifting)
    longest_dropout_s : lost frames are interpolated up to this duration; a longer loss spoils the walk
    smoothing_sigma_frames : Gaussian smoothing of the positions (Agethen et al. 2017, section 4.4: 2)
    """

    minimum_standing_s: float = 1.5
    minimum_distance_m: float = 0.25
    longest_dropout_s: float = 0.1
    smoothing_sigma_frames: float = 2.0


@dataclass(frozen=True)
class Candidate:
    """Frames ``start`` to ``end`` of a recording that may be a walk, and why not (empty if it is one)."""

    start: int
    end: int
    reason: str


def fill_short_gaps(points_m: Array, longest_frames: int) -> tuple[Array, list[tuple[int, int]]]:
    """Interpolate lost frames (NaN) linearly.

    Returns
    -------
    (n, 2) array without NaN, and the gaps longer than ``longest_frames`` as (first lost, first found again):
    in these the interpolated values are only a bridge, no measurement.
    """
    lost = np.isnan(points_m).any(axis=1)
    if not lost.any():
        return points_m, []
    found = np.flatnonzero(~lost)
    if found.size < 2:
        raise InputError(f"a recording of {len(points_m)} frames has fewer than two valid positions; leave it out")
    at = np.arange(len(points_m))
    filled = np.column_stack([np.interp(at, found, points_m[found, axis]) for axis in (0, 1)])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], lost, [False]]).astype(np.int8)))
    gaps = [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > longest_frames]
    return filled, gaps


def find_walks(
    points_m: Array, gaps: list[tuple[int, int]], rate_hz: float, standing: Standing, rules: SegmentationRules
) -> list[Candidate]:
    """Cut smoothed positions into walks.

    A movement lasts while the speed stays above the standing speed. It counts if it
    exceeds the walking speed at some moment and covers ground; bending does not.

    Parameters
    ----------
    points_m : (n, 2) array, smoothed, without NaN
    gaps : lost stretches that were too long to interpolate
    """
    speed = speeds(points_m, 1 / rate_hz)
    moving = np.concatenate([[False], speed >= standing.standing_speed_m_s, [False]])
    edges = np.flatnonzero(np.diff(moving.astype(np.int8)))
    movements = [
        (max(int(a) - 1, 0), min(int(b), len(speed) - 1))
        for a, b in zip(edges[::2], edges[1::2], strict=True)
        if speed[a:b].max() >= standing.walking_speed_m_s
    ]
    movements = [(a, b) for a, b in movements if np.hypot(*(points_m[b] - points_m[a])) >= rules.minimum_distance_m]
    return [_judge(group, gaps, speed, rate_hz, standing) for group in _grouped(movements, rules.minimum_standing_s * rate_hz)]


def _grouped(movements: list[tuple[int, int]], minimum_frames: float) -> list[list[tuple[int, int]]]:
    groups: list[list[tuple[int, int]]] = []
    for movement in movements:
        if groups and movement[0] - groups[-1][-1][1] < minimum_frames:
            groups[-1].append(movement)
        else:
            groups.append([movement])
    return groups


def _judge(
    group: list[tuple[int, int]], gaps: list[tuple[int, int]], speed: Array, rate_hz: float, standing: Standing
) -> Candidate:
    start, end = group[0][0], group[-1][1]
    if len(group) > 1:
        pause_s = (group[1][0] - group[0][1]) / rate_hz
        return Candidate(start, end, f"interrupted: stood for only {pause_s:.2f} s on the way")
    lost = [b - a for a, b in gaps if a <= end and b > start]
    if lost:
        return Candidate(start, end, f"dropout of {max(lost) / rate_hz:.2f} s")
    if speed[start] >= standing.standing_speed_m_s:
        return Candidate(start, end, "recording begins while walking")
    if speed[end] >= standing.standing_speed_m_s:
        return Candidate(start, end, "recording ends while walking")
    return Candidate(start, end, ACCEPTED)


def extract_walks(
    recording: pd.DataFrame,
    participants: pd.DataFrame,
    standing: Standing,
    rules: SegmentationRules,
    curvature_scale_m: float,
    stations: Mapping[str, Mapping[str, Point]] | None = None,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Cut recordings into walks.

    Without ``stations`` a recording is a protocol of walks out and back: it begins at the
    start place, and a walk that leads back to it is listed as rejected. With ``stations``
    every walk counts and its configuration is named after the nearest stations.

    Parameters
    ----------
    recording : DataFrame[recording, participant, configuration, scene, time_s, x_m, y_m], NaN where a frame was lost
    participants : DataFrame with participant and height_m
    curvature_scale_m : smoothing of the path before its curvature is taken
    stations : scene -> name -> position

    Returns
    -------
    walks, samples : tables as in :mod:`walklab.capture.walks`; rejected walks are in ``walks`` with their reason

    Raises
    ------
    InputError
        If a participant or the stations of a scene are missing, or times do not ascend evenly.
    """
    heights = dict(zip(participants["participant"].astype(str), participants["height_m"], strict=True))
    rows: list[dict] = []
    samples: list[pd.DataFrame] = []
    for name, part in _recordings(recording):
        participant, scene, configuration = (str(part[column].iloc[0]) for column in ("participant", "scene", "configuration"))
        if participant not in heights:
            raise InputError(f"participants: no row for {participant} of recording {name}; add the participant with height_m")
        if stations is not None and scene not in stations:
            raise InputError(f"stations: none for scene {scene} of recording {name}; add them to config/scenes/{scene}.yaml")
        time_s = part["time_s"].to_numpy()
        rate_hz = _rate_hz(time_s, name)
        raw, gaps = fill_short_gaps(part[["x_m", "y_m"]].to_numpy(), int(rules.longest_dropout_s * rate_hz))
        smoothed = gaussian_filter1d(raw, rules.smoothing_sigma_frames, axis=0, mode="nearest")
        for index, found in enumerate(find_walks(smoothed, gaps, rate_hz, standing, rules)):
            path = smoothed[found.start : found.end + 1]
            where = configuration if stations is None else _between(path, stations[scene])
            row = {"walk": f"{name}/{index:04d}", "participant": participant, "scene": scene, "configuration": where}
            reason = WALK_BACK if stations is None and _leads_back(path, smoothed, found) else found.reason
            rows.append(row | _measures(path, time_s, found, heights[participant], curvature_scale_m, reason))
            if reason == ACCEPTED:
                samples.append(_samples(row["walk"], time_s[found.start : found.end + 1], path))
    if not rows:
        raise InputError(f"recording: no walk found in {len(recording)} frames; check units and the standing speeds")
    empty = pd.DataFrame({"walk": pd.Series(dtype=str)} | {name: pd.Series(dtype=float) for name in ("time_s", "x_m", "y_m")})
    table = pd.concat(samples, ignore_index=True) if samples else empty
    return check(pd.DataFrame(rows), WALKS, "extracted walks"), check(table, SAMPLES, "extracted walks")


def _recordings(recording: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    for name, part in recording.groupby("recording", sort=False, observed=True):
        yield str(name), part


def _rate_hz(time_s: Array, name: str) -> float:
    steps = np.diff(time_s)
    if len(steps) == 0 or steps.min() <= 0 or steps.max() > 1.5 * np.median(steps):
        row = int(np.argmax((steps <= 0) | (steps > 1.5 * np.median(steps)))) + 1 if len(steps) else 0
        raise InputError(
            f"recording {name}: column time_s, frame {row}: times must ascend in even steps; mark lost frames by NaN positions"
        )
    return float(1 / np.mean(steps))


def _leads_back(path: Array, recording: Array, found: Candidate) -> bool:
    """Whether a walk ends closer to the place where the recording began than it started."""
    home = recording[0]
    return bool(np.hypot(*(path[-1] - home)) < np.hypot(*(path[0] - home)))


def _between(path: Array, stations: Mapping[str, Point]) -> str:
    names = list(stations)
    places = np.array([stations[name] for name in names])
    origin, target = (names[int(np.argmin(np.hypot(*(places - point).T)))] for point in (path[0], path[-1]))
    return f"{origin}-{target}"


def _measures(path: Array, time_s: Array, found: Candidate, height_m: float, scale_m: float, reason: str) -> dict:
    return {
        "start_s": time_s[found.start],
        "duration_s": time_s[found.end] - time_s[found.start],
        "length_m": length(path),
        "curvature_1_m": mean_curvature(path, scale_m),
        "height_m": height_m,
        "start_x_m": path[0, 0],
        "start_y_m": path[0, 1],
        "end_x_m": path[-1, 0],
        "end_y_m": path[-1, 1],
        "start_speed_m_s": 0.0,
        "end_speed_m_s": 0.0,
        "rejection": reason,
    }


def _samples(walk: str, time_s: Array, path: Array) -> pd.DataFrame:
    return pd.DataFrame({"walk": walk, "time_s": time_s - time_s[0], "x_m": path[:, 0], "y_m": path[:, 1]})


def compare_boundaries(walks: pd.DataFrame, truth: pd.DataFrame, rate_hz: float) -> pd.DataFrame:
    """How far the boundaries of accepted walks are from the true ones.

    Returns
    -------
    DataFrame[walk, start_error_frames, end_error_frames], found minus true, one row per accepted walk; NaN if
    the recording holds no true walk that overlaps with it
    """
    spans = {str(name): part[["start_s", "end_s"]].to_numpy() for name, part in truth.groupby("recording", observed=True)}
    rows = []
    accepted = walks[walks["rejection"] == ACCEPTED]
    starts_s = accepted["start_s"].to_numpy()
    for name, start, end in zip(accepted["walk"], starts_s, starts_s + accepted["duration_s"].to_numpy(), strict=True):
        known = spans.get(name.rsplit("/", 1)[0], np.empty((0, 2)))
        overlap = np.minimum(known[:, 1], end) - np.maximum(known[:, 0], start)
        error = np.array([start, end]) - known[np.argmax(overlap)] if len(overlap) and overlap.max() > 0 else np.full(2, np.nan)
        rows.append((name, error[0] * rate_hz, error[1] * rate_hz))
    return pd.DataFrame(rows, columns=["walk", "start_error_frames", "end_error_frames"])
