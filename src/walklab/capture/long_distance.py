"""Travel times over 10 to 50 m, timed on video (Agethen et al. 2017, section 8.3); no trajectories exist."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from walklab.capture.constants import WalkerConstants
from walklab.capture.walker import Person, person_from_row, speed_profile
from walklab.randomness import generator

DATASET = "long_distance"


@dataclass(frozen=True)
class LongDistanceDesign:
    """Distances, how often each is walked by each participant, and the frame rate of the video."""

    distances_m: tuple[float, ...] = (10.0, 25.0, 50.0)
    repetitions: int = 4
    rate_hz: float = 25.0


def record_long_distance(
    participants: pd.DataFrame, design: LongDistanceDesign, constants: WalkerConstants, seed: int, replicate: int
) -> pd.DataFrame:
    """Travel times from double stance to double stance, in whole frames.

    Returns
    -------
    DataFrame[walk, participant, height_m, distance_m, repetition, travel_time_s]
    """
    rows = []
    for _, row in participants.iterrows():
        name = str(row["participant"])
        person = _brisk(person_from_row(row, constants), constants)
        for distance in design.distances_m:
            for repetition in range(design.repetitions):
                rng = generator(seed, replicate, DATASET, name, f"{distance:g}", repetition)
                bell = speed_profile(person, distance, distance, constants, rng.standard_normal(3))
                height_m = float(row["height_m"])
                rows.append(travel_time_row(name, height_m, distance, repetition, bell.duration_s, design.rate_hz))
    return pd.DataFrame(rows)


def travel_time_row(
    participant: str, height_m: float, distance_m: float, repetition: int, time_s: float, rate_hz: float
) -> dict[str, object]:
    """One row of the table of travel times; the time is a whole number of frames."""
    return {
        "walk": f"{DATASET}/{participant.rsplit('_', 1)[-1]}/{distance_m:g}/{repetition:04d}",
        "participant": participant,
        "height_m": height_m,
        "distance_m": float(distance_m),
        "repetition": repetition,
        "travel_time_s": float(np.round(time_s * rate_hz) / rate_hz),
    }


def _brisk(person: Person, constants: WalkerConstants) -> Person:
    """The same person told to walk briskly."""
    own = 1 + constants.long_distance_conformity * (person.comfortable_speed_m_s / person.norm_speed_m_s - 1)
    return replace(
        person,
        comfortable_speed_m_s=constants.long_distance_pace * person.norm_speed_m_s * own,
        start_time_s=person.start_time_s * constants.long_distance_start_stop,
        stop_time_s=person.stop_time_s * constants.long_distance_start_stop,
    )
