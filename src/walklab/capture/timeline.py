"""Legs of walking put on the frames of one continuous recording, and the flaws that spoil some of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walklab.capture.constants import WalkerConstants
from walklab.capture.walker import Motion, Person, PlannedWalk, draw_walk, sample_walk
from walklab.geometry.standing import Standing, moving_span, speeds

Array = NDArray[np.float64]

NO_FLAW, DROPOUT, STOP = "", "dropout", "stop"


@dataclass(frozen=True)
class Leg:
    """One walk in a recording: its parts (two if it is interrupted), each with the frame it begins at."""

    parts: tuple[tuple[int, PlannedWalk], ...]
    end_frame: int
    toward: bool
    configuration: str
    flaw: str = NO_FLAW

    @property
    def start_frame(self) -> int:
        return self.parts[0][0]

    @property
    def end_m(self) -> Array:
        return self.parts[-1][1].path[-1]


def make_leg(
    person: Person,
    path: Array,
    start_frame: int,
    rate_hz: float,
    constants: WalkerConstants,
    rng: np.random.Generator,
    configuration: str,
    toward: bool = True,
    flaw: str = NO_FLAW,
) -> Leg:
    """Draw one walk along a path; a walk with the flaw ``stop`` stands still once on its way."""
    pieces = [path]
    if flaw == STOP:
        cut = int(len(path) * rng.uniform(0.4, 0.6))
        pieces = [path[: cut + 1], path[cut:]]
    parts, frame = [], start_frame
    for index, piece in enumerate(pieces):
        if index:
            frame += round(rng.uniform(*constants.interruption_s) * rate_hz)
        walk = draw_walk(person, piece, constants, rng)
        parts.append((frame, walk))
        frame += int(np.ceil(walk.duration_s * rate_hz))
    return Leg(tuple(parts), frame, toward, configuration, flaw)


@dataclass(frozen=True)
class Track:
    """The walking component of a recording: nothing but walks and rests between them.

    Attributes
    ----------
    position_m : (frames, 2) array
    motions : for each part of each leg its first frame and its motion
    spans_s : for each leg the times between which it moves faster than standing
    """

    position_m: Array
    motions: list[tuple[int, Motion]]
    spans_s: list[tuple[float, float]]


def lay_track(
    legs: Sequence[Leg],
    frames: int,
    rate_hz: float,
    person: Person,
    constants: WalkerConstants,
    standing: Standing | None = None,
) -> Track:
    """Sample all legs on the frames of a recording; between legs the person rests where the last one ended.

    The true boundaries are the last resting frame before and the first after a leg: those at which the speed of
    the walking component passes the threshold of ``standing`` (by default that of ``Standing()``).
    """
    position = np.empty((frames, 2))
    first = legs[0].parts[0][1].path[0]
    position[:] = first
    motions = []
    for leg in legs:
        for start, walk in leg.parts:
            count = int(np.ceil(walk.duration_s * rate_hz)) + 1
            motion = sample_walk(walk, np.arange(count) / rate_hz, person, constants)
            position[start : start + count] = motion.position_m
            position[start + count :] = motion.position_m[-1]
            motions.append((start, motion))
    threshold = (standing or Standing()).standing_speed_m_s
    spans = []
    for leg in legs:
        low, high = max(leg.start_frame - 2, 0), min(leg.end_frame + 3, frames)
        start, end = moving_span(speeds(position[low:high], 1 / rate_hz), threshold)
        spans.append(((low + start) / rate_hz, (low + end) / rate_hz))
    return Track(position, motions, spans)


def lose_frames(
    lost: NDArray[np.bool_], legs: Sequence[Leg], rate_hz: float, constants: WalkerConstants, rng: np.random.Generator
) -> None:
    """Add a long dropout inside each leg that has that flaw."""
    for leg in legs:
        if leg.flaw == DROPOUT:
            room = leg.end_frame - leg.start_frame
            length = min(round(rng.uniform(*constants.long_dropout_s) * rate_hz), int(0.8 * room))
            begin = leg.start_frame + round(rng.uniform(0.1, 0.9) * (room - length))
            lost[begin : begin + length] = True


def scattered(place: Array, constants: WalkerConstants, rng: np.random.Generator) -> Array:
    """Where a person comes to stand who aims at a place: normal scatter, cut at a reach."""
    offset = constants.place_scatter_m * rng.standard_normal(2)
    distance = float(np.hypot(*offset))
    return place + offset * min(1.0, constants.place_reach_m / distance if distance > 0 else 1.0)


def choose_flawed(count: int, lengths_m: Sequence[float], constants: WalkerConstants, rng: np.random.Generator) -> dict[int, str]:
    """Which of the walks are flawed, and how: index -> flaw. Short walks cannot be interrupted and lose frames instead."""
    chosen = np.sort(rng.choice(len(lengths_m), size=count, replace=False))
    stops = rng.random(count) < 0.5
    return {
        int(index): STOP if stop and lengths_m[index] >= constants.shortest_interrupted_m else DROPOUT
        for index, stop in zip(chosen, stops, strict=True)
    }
