"""One walk of one person: where the centre of mass is at each moment.

A path (:mod:`walklab.capture.paths`) is travelled with a bell- or plateau-shaped speed
profile, slowed by curvature, with the sway of the gait on top. No limit of speed,
acceleration or turning enters: the profile is drawn, not steered.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from walklab.capture.constants import WalkerConstants
from walklab.capture.paths import SPACING_M, Habit, normals, wander
from walklab.geometry.curves import arc_length, resample

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bell:
    """A speed profile: smooth rise to ``peak_m_s``, plateau, smooth fall.

    The rise is ``peak * q(t / start_s)`` with ``q(u) = 10 u^3 - 15 u^4 + 6 u^5``, so
    that it covers half of ``peak * start_s``.
    """

    peak_m_s: float
    start_s: float
    plateau_s: float
    stop_s: float

    @property
    def duration_s(self) -> float:
        return self.start_s + self.plateau_s + self.stop_s

    def speed(self, time_s: Array) -> Array:
        """Speed at each time, (n,) array, m/s; zero outside the walk."""
        up = np.clip(time_s / self.start_s, 0, 1)
        down = np.clip((self.duration_s - time_s) / self.stop_s, 0, 1)
        return self.peak_m_s * np.minimum(smooth_step(up), smooth_step(down))

    def travelled(self, time_s: Array) -> Array:
        """Integral of the speed from 0 to each time, (n,) array, metres."""
        up = np.clip(time_s / self.start_s, 0, 1)
        flat = np.clip(time_s - self.start_s, 0, self.plateau_s)
        down = np.clip((time_s - self.start_s - self.plateau_s) / self.stop_s, 0, 1)
        rise = self.start_s * smooth_step_integral(up)
        fall = self.stop_s * (0.5 - smooth_step_integral(1 - down))
        return self.peak_m_s * (rise + flat + fall)


def smooth_step(u: Array) -> Array:
    """From 0 at u = 0 to 1 at u = 1 with zero first and second derivatives there."""
    return u**3 * (10 - 15 * u + 6 * u**2)


def smooth_step_integral(u: Array) -> Array:
    """Integral of :func:`smooth_step` from 0."""
    return u**4 * (2.5 - 3 * u + u**2)


class SpeedProfile(Protocol):
    """Speed over time from standing to standing, however it was made."""

    @property
    def peak_m_s(self) -> float: ...
    @property
    def duration_s(self) -> float: ...
    def speed(self, time_s: Array) -> Array: ...
    def travelled(self, time_s: Array) -> Array: ...


class WalkSource(Protocol):
    """Where a person's walks come from if they are not made of traits."""

    def draw(self, path: Array, rng: np.random.Generator) -> PlannedWalk: ...


@dataclass(frozen=True)
class Person:
    """The traits of one participant that shape a walk; see :mod:`walklab.capture.constants` for each."""

    comfortable_speed_m_s: float
    norm_speed_m_s: float
    distance_constant_m: float
    start_time_s: float
    stop_time_s: float
    turn_exponent: float
    walk_ratio_m_min: float
    sway_lateral_m: float
    sway_fore_aft_m: float
    wander_ratio: float
    belt_gap_error_m: float
    torso_depth_m: float
    height_m: float
    habit: Habit
    source: WalkSource | None = None


MakePerson = Callable[[pd.Series, WalkerConstants], Person]


def person_from_row(row: pd.Series, constants: WalkerConstants) -> Person:
    """A person from a row of the participants table."""
    norm = norm_speed_m_s(str(row["sex"]), float(row["age_years"]), float(row["height_m"]), constants)
    direct = ("distance_constant_m", "start_time_s", "stop_time_s", "walk_ratio_m_min", "sway_lateral_m", "sway_fore_aft_m")
    own: dict[str, Any] = {name: float(row[f"trait_{name}"]) for name in (*direct, "belt_gap_error_m")}
    habit = Habit(
        float(row["trait_clearance_m"]),
        constants.least_clearance_m,
        constants.freedom_at_station_m,
        float(row["trait_rounding_m"]),
    )
    return Person(
        **own,
        norm_speed_m_s=norm,
        comfortable_speed_m_s=norm * float(row["trait_speed_ratio"]),
        turn_exponent=float(row["trait_turn_exponent"]) if constants.effect_of_curvature else 0.0,
        wander_ratio=float(row["trait_wander_ratio"]) if constants.paths_wander else 0.0,
        torso_depth_m=float(row["torso_depth_m"]),
        height_m=float(row["height_m"]),
        habit=habit,
    )


def norm_speed_m_s(sex: str, age_years: float, height_m: float, constants: WalkerConstants) -> float:
    """The speed that long walks tend to, by sex and age (Bohannon 1997) and stature (dynamic similarity), m/s."""
    woman = sex == "female"
    by_decade = constants.comfortable_women_m_s if woman else constants.comfortable_men_m_s
    norm = constants.peak_over_norm * float(np.interp(age_years, 25.0 + 10.0 * np.arange(len(by_decade)), by_decade))
    if not constants.effect_of_height:
        return norm
    reference_m = constants.reference_height_women_m if woman else constants.reference_height_men_m
    return norm * (height_m / reference_m) ** constants.height_exponent


def peak_speed_m_s(person: Person, length_m: float, constants: WalkerConstants) -> float:
    """The speed a person wants to reach on a walk of this length, m/s."""
    if not constants.effect_of_length:
        return person.comfortable_speed_m_s
    return person.comfortable_speed_m_s * (
        1 - constants.short_walk_shortfall * float(np.exp(-length_m / person.distance_constant_m))
    )


def speed_profile(person: Person, length_m: float, effective_m: float, constants: WalkerConstants, variation: Array) -> Bell:
    """The profile of one walk.

    Parameters
    ----------
    length_m : length of the path, which sets the peak speed
    effective_m : length that the profile has to cover, with the slowing in turns divided out
    variation : (3,) standard normal array: how this repetition's speed, start and stop differ
    """
    peak = peak_speed_m_s(person, length_m, constants) * float(np.exp(constants.repeated_speed_sd * variation[0]))
    start = person.start_time_s * float(np.exp(constants.repeated_start_stop_sd * variation[1]))
    stop = person.stop_time_s * float(np.exp(constants.repeated_start_stop_sd * variation[2]))
    room = 2 * effective_m / (start + stop)
    if peak <= room:
        return Bell(peak, start, effective_m / peak - (start + stop) / 2, stop)
    if constants.effect_of_length:
        # Too short for a plateau: the wanted peak is reached by a shorter start and stop.
        squeeze = room / peak
        return Bell(peak, start * squeeze, 0.0, stop * squeeze)
    # Without an effect of length the start-up stays as vigorous and is merely broken off: speed and time shrink alike.
    share = float(np.sqrt(room / peak))
    return Bell(peak * share, start * share, 0.0, stop * share)


@dataclass(frozen=True)
class Motion:
    """The centre of mass and the direction of walking at each frame of a walk."""

    position_m: Array
    heading_rad: Array
    stride_phase_rad: Array
    speed_m_s: Array


@dataclass(frozen=True)
class PlannedWalk:
    """A walk that is drawn but not yet sampled: its path, its profile and its gait."""

    path: Array
    along_m: Array
    effective_m: Array
    bell: SpeedProfile
    phase_rad: float

    @property
    def duration_s(self) -> float:
        return self.bell.duration_s


def draw_walk(person: Person, path: Array, constants: WalkerConstants, rng: np.random.Generator) -> PlannedWalk:
    """Draw one repetition of a walk along a habitual path."""
    if person.source is not None:
        return person.source.draw(path, rng)
    own = resample(wander(path, person.wander_ratio, constants.wander_modes, rng), SPACING_M)
    along = arc_length(own)
    slowing = turn_slowing(own, person.turn_exponent, constants)
    effective = np.concatenate([[0.0], np.cumsum(np.diff(along) * 0.5 * (1 / slowing[1:] + 1 / slowing[:-1]))])
    variation = rng.standard_normal(3)
    foot = 0.0 if constants.repeated_speed_sd == 0 else np.pi * rng.integers(2)
    return PlannedWalk(own, along, effective, speed_profile(person, along[-1], effective[-1], constants, variation), foot)


def turn_slowing(path: Array, exponent: float, constants: WalkerConstants) -> Array:
    """Speed on each point of a path relative to the straight.

    ``(1 + (kappa / kappa_0)^2)^(-beta / 2)``, which tends to the power law ``kappa^-beta`` in tight turns.
    """
    if exponent == 0 or len(path) < 5:
        return np.ones(len(path))
    step = np.hypot(*(path[1] - path[0]))
    heading = np.unwrap(np.arctan2(*np.diff(path, axis=0).T[::-1]))
    turning = np.abs(np.diff(gaussian_filter1d(heading, constants.turn_look_ahead_m / 2 / step, mode="nearest"))) / step
    curvature = np.concatenate([turning[:1], turning, turning[-1:]])
    return (1 + (curvature / constants.turn_onset_1_m) ** 2) ** (-exponent / 2)


def sample_walk(walk: PlannedWalk, time_s: Array, person: Person, constants: WalkerConstants) -> Motion:
    """The centre of mass at times since the walk's beginning; before and after, it rests at the ends.

    Lateral sway goes with the stride, fore-aft sway with the step; both grow with speed.
    """
    covered = np.minimum(walk.bell.travelled(time_s), walk.effective_m[-1])
    along = np.interp(covered, walk.effective_m, walk.along_m)
    position = np.column_stack([np.interp(along, walk.along_m, walk.path[:, axis]) for axis in (0, 1)])
    left_path = normals(walk.path)
    left = np.column_stack([np.interp(along, walk.along_m, left_path[:, axis]) for axis in (0, 1)])
    speed = walk.bell.speed(time_s)
    stride = walk.phase_rad + _stride_phase(walk, time_s, person)
    strength = speed**2 / (speed**2 + constants.sway_onset_m_s**2)
    sideways = person.sway_lateral_m * strength * np.sin(stride)
    forwards = person.sway_fore_aft_m * strength * np.sin(2 * stride)
    ahead = np.column_stack([left[:, 1], -left[:, 0]])
    heading = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    return Motion(position + sideways[:, None] * left + forwards[:, None] * ahead, heading, stride, speed)


def _stride_phase(walk: PlannedWalk, time_s: Array, person: Person) -> Array:
    """Stride angle: half a turn each step, at the step rate ``sqrt(speed / (60 * walk ratio))`` per second of the peak speed.

    Step rate follows the speed only weakly while starting and stopping, so the peak's rate stands for the walk.
    """
    steps_per_s = np.sqrt(60 * walk.bell.peak_m_s / person.walk_ratio_m_min) / 60
    return np.pi * steps_per_s * np.clip(time_s, 0.0, walk.duration_s)
