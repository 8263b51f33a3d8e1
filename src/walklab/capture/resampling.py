"""A second generator: walks resampled from real people, time-scaled to published travel times.

Nothing here steers and nothing is fitted: a path is a real path, turned, scaled and laid on the way of the task; its speed
is a real start, a real swing within each step and a real stop, scaled so that the walk takes a published time. Standing,
bending, sensors and the people themselves are those of the first generator.

What a walk looks like depends on length (published mean speeds), on who walks (published spread of comfortable speeds by
sex, age and stature, and which subject lends the shapes), and on chance (which of the subject's walks; published spread
of repetitions). Curvature has no effect on pace but through the length of the way, since no timed walks with turns exist.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.constants import WalkerConstants
from walklab.capture.foot_markers import Ramps
from walklab.capture.long_distance import DATASET, LongDistanceDesign, travel_time_row
from walklab.capture.paths import SPACING_M, normals
from walklab.capture.published_times import LONG_WALKS, mean_speed_m_s
from walklab.capture.real_shapes import PathShape, RealShapes
from walklab.capture.walker import Person, PlannedWalk, person_from_row
from walklab.errors import InputError
from walklab.geometry.curves import arc_length, resample
from walklab.randomness import generator

Array = NDArray[np.float64]

# ASSUME: One of the three real walks of the most similar distance lends its shape, since a subject has eight straight walks only.
SIMILAR = 3
# ASSUME: Three of ten subjects lend their shapes to the people of the scenarios and the others to those of experiment 1, since
# the held-out people must be other people.
HELD_OUT = 3
IQR_OF_NORMAL = 1.349  # interquartile range of a standard normal


@dataclass(frozen=True)
class RealProfile:
    """Speed over time as resampled: (n,) array every ``step_s``, zero before and after."""

    values_m_s: Array
    step_s: float

    @property
    def peak_m_s(self) -> float:
        return float(self.values_m_s.max())

    @property
    def duration_s(self) -> float:
        return (len(self.values_m_s) - 1) * self.step_s

    def speed(self, time_s: Array) -> Array:
        """Speed at each time, m/s."""
        return np.asarray(np.interp(time_s, self._times(), self.values_m_s, left=0.0, right=0.0), dtype=np.float64)

    def travelled(self, time_s: Array) -> Array:
        """Integral of the speed from 0 to each time, metres."""
        steps = 0.5 * (self.values_m_s[1:] + self.values_m_s[:-1]) * self.step_s
        covered: Array = np.concatenate([[0.0], np.cumsum(steps)])
        return np.asarray(np.interp(time_s, self._times(), covered), dtype=np.float64)

    def _times(self) -> Array:
        return np.asarray(self.step_s * np.arange(len(self.values_m_s)), dtype=np.float64)


@dataclass(frozen=True)
class RealWalks:
    """The real walks that one participant's walks are resampled from; follows ``walker.WalkSource``.

    Attributes
    ----------
    paths, swings : of one subject each
    ramps : start and stop
    pace : this person's speed relative to the published mean
    repeated_speed_sd : published spread of one person's repetitions
    """

    paths: tuple[PathShape, ...]
    swings: tuple[Array, ...]
    ramps: Ramps
    pace: float
    repeated_speed_sd: float

    def draw(self, path: Array, rng: np.random.Generator) -> PlannedWalk:
        """One repetition along the way of a task."""
        way_m = float(arc_length(path)[-1])
        far = np.abs([np.log(shape.distance_m / way_m) for shape in self.paths])
        shape = self.paths[np.argsort(far, kind="stable")[rng.integers(min(SIMILAR, len(far)))]]
        own = resample(lay(shape, path), SPACING_M)
        along = arc_length(own)
        pace = self.pace * float(np.exp(self.repeated_speed_sd * rng.standard_normal()))
        duration_s = way_m / (mean_speed_m_s(way_m) * pace)
        swing = self.swings[rng.integers(len(self.swings))]
        profile = scaled_profile(along[-1], duration_s, self.ramps, swing, int(rng.integers(len(swing))))
        return PlannedWalk(own, along, along, profile, 0.0)


def lay(shape: PathShape, way: Array) -> Array:
    """A real path laid on the way of a task, (n, 2) array.

    On a straight way this is the similarity that takes the real start and end to the task's; on a way round an obstacle
    the real straight line follows the way and the real deviation stands out to its left.
    """
    # ASSUME: Round obstacles people deviate from the intended way as they do from a straight line, since none of the
    # recorded walks leads round anything.
    along = arc_length(way)
    at = shape.along * along[-1]
    left = normals(way)
    base = np.column_stack([np.interp(at, along, way[:, axis]) for axis in (0, 1)])
    out = np.column_stack([np.interp(at, along, left[:, axis]) for axis in (0, 1)])
    ahead = np.column_stack([out[:, 1], -out[:, 0]])
    beyond = np.minimum(at, 0.0) + np.maximum(at - along[-1], 0.0)  # steps back before the start or past the end
    return base + beyond[:, None] * ahead + (shape.aside * along[-1])[:, None] * out


def scaled_profile(length_m: float, duration_s: float, ramps: Ramps, swing: Array, offset: int) -> RealProfile:
    """Real start, cruise and real stop, with a real swing, scaled to a length and a duration.

    A walk that lasts longer than start and stop together cruises between them; a shorter one is start and stop in
    proportionally less time. The swing keeps its time, and is read from ``offset`` on, back and forth.
    """
    step_s = ramps.step_s
    start_s, stop_s = (len(ramps.start) - 1) * step_s, (len(ramps.stop) - 1) * step_s
    squeeze = min(1.0, duration_s / (start_s + stop_s))
    count = max(3, round(duration_s / step_s) + 1)
    time_s = np.linspace(0.0, duration_s, count)
    up = np.interp(time_s, squeeze * step_s * np.arange(len(ramps.start)), ramps.start, right=1.0)
    down = np.interp(time_s, duration_s - squeeze * (stop_s - step_s * np.arange(len(ramps.stop))), ramps.stop, left=1.0)
    back_and_forth = np.concatenate([swing, swing[-2:0:-1]])
    speed = np.minimum(up, down) * back_and_forth[(offset + np.arange(count)) % len(back_and_forth)]
    step_s = duration_s / (count - 1)
    covered = float(np.sum(0.5 * (speed[1:] + speed[:-1])) * step_s)
    return RealProfile(speed * length_m / covered, step_s)


def deal(subjects: Sequence[str], seed: int, purpose: str) -> tuple[list[str], list[str]]:
    """Subjects for the people of experiment 1 and, none of them the same, for those of the scenarios.

    Raises
    ------
    InputError
        If there are too few subjects for both.
    """
    if len(subjects) <= HELD_OUT:
        raise InputError(f"{purpose} of {len(subjects)} subjects: more than {HELD_OUT} are needed to hold some out")
    order = [sorted(subjects)[index] for index in generator(seed, "resampling", purpose).permutation(len(subjects))]
    return order[HELD_OUT:], order[:HELD_OUT]


def resampled_person(row: pd.Series, constants: WalkerConstants, shapes: RealShapes, seed: int) -> Person:
    """A participant who walks as real people did: with no sway of the first generator, and a subject to resample."""
    group, number = str(row["participant"]).rsplit("_P", 1)
    held_out = int(group != "training")
    lent = [deal(list(pool), seed, name)[held_out] for name, pool in (("paths", shapes.paths), ("swings", shapes.swings))]
    path_subject, swing_subject = (subjects[int(number) % len(subjects)] for subjects in lent)
    person = person_from_row(row, constants)
    walks = RealWalks(
        shapes.paths[path_subject],
        shapes.swings[swing_subject],
        shapes.ramps,
        person.comfortable_speed_m_s / (constants.peak_over_norm * constants.comfortable_men_m_s[0]),
        constants.repeated_speed_sd,
    )
    return replace(person, sway_lateral_m=0.0, sway_fore_aft_m=0.0, source=walks)


def resample_long_distance(
    participants: pd.DataFrame, design: LongDistanceDesign, constants: WalkerConstants, seed: int, replicate: int
) -> pd.DataFrame:
    """Travel times of the long walks, drawn around the published medians with the published spread.

    ``T = median * exp(-(b z + w e))`` with z the person's standardised speed, e standard normal, w the published spread of
    repetitions and ``b^2 + w^2 = (IQR / (1.349 median))^2``.

    Returns
    -------
    DataFrame[walk, participant, height_m, distance_m, repetition, travel_time_s], as of the first generator

    Raises
    ------
    InputError
        If no travel time is published for a distance.
    """
    rows = []
    for _, row in participants.iterrows():
        name = str(row["participant"])
        trait = constants.comfortable_ratio
        own = (float(row["trait_speed_ratio"]) - trait.mean) / trait.sd
        for distance in design.distances_m:
            if distance not in LONG_WALKS:
                raise InputError(
                    f"record_long_distance.distances_m: no time is published for {distance:g} m; use {list(LONG_WALKS)}"
                )
            median_s, iqr_s = LONG_WALKS[distance]
            spread = iqr_s / (IQR_OF_NORMAL * median_s)
            within = min(constants.repeated_speed_sd, spread)
            between = float(np.sqrt(spread**2 - within**2))
            for repetition in range(design.repetitions):
                rng = generator(seed, replicate, DATASET, name, f"{distance:g}", repetition)
                time_s = median_s * float(np.exp(-between * own - within * rng.standard_normal()))
                rows.append(travel_time_row(name, float(row["height_m"]), distance, repetition, time_s, design.rate_hz))
    return pd.DataFrame(rows)
