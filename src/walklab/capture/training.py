"""Experiment 1: straight walks and turns around a pole, recorded continuously (Agethen et al. 2017, section 4.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.constants import WalkerConstants
from walklab.capture.paths import habitual_path, move_ends
from walklab.capture.sensor import short_dropouts, standing_sway
from walklab.capture.timeline import NO_FLAW, Leg, choose_flawed, lay_track, lose_frames, make_leg, scattered
from walklab.capture.walker import MakePerson, Person, person_from_row
from walklab.errors import InputError
from walklab.geometry.plans import OPEN, Plan
from walklab.geometry.standing import Standing
from walklab.randomness import generator

Array = NDArray[np.float64]
DATASET = "training"


@dataclass(frozen=True)
class TrainingDesign:
    """What every participant walks.

    Attributes
    ----------
    straight_distances_m, turning_angles_deg, turning_distances_m : the configurations
    straight_repetitions, turning_repetitions : walks out (each has a walk back) per configuration
    standing_s : standing at either end
    rate_hz : of the capture system
    flawed_walks : walks out, over all participants, that are spoilt and have to be rejected
    """

    straight_distances_m: tuple[float, ...] = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0)
    turning_angles_deg: tuple[float, ...] = (45.0, 90.0, 135.0, 180.0)
    turning_distances_m: tuple[float, ...] = (3.0, 4.0)
    straight_repetitions: int = 5
    turning_repetitions: int = 3
    standing_s: float = 5.0
    rate_hz: float = 120.0
    flawed_walks: int = 72


@dataclass(frozen=True)
class Configuration:
    """One condition: its name, its plan, where it starts and ends, its length and how often it is walked."""

    name: str
    plan: Plan
    start_m: Array
    end_m: Array
    length_m: float
    repetitions: int


def configurations(design: TrainingDesign, plans: Mapping[str, Plan]) -> list[Configuration]:
    """All conditions of the design.

    Raises
    ------
    InputError
        If a turning angle has no plan ``turn_<angle>`` or a plan lacks the stations ``start_<m>``, ``end_<m>``.
    """
    made = [
        Configuration(
            f"straight_{distance:.1f}", OPEN, np.zeros(2), np.array([distance, 0.0]), distance, design.straight_repetitions
        )
        for distance in design.straight_distances_m
    ]
    for angle in design.turning_angles_deg:
        if (scene := f"turn_{angle:g}") not in plans:
            raise InputError(f"config/scenes/{scene}.yaml: no plan for a turn of {angle:g} degrees; add it or drop the angle")
        plan = plans[scene]
        for distance in design.turning_distances_m:
            ends = [f"start_{distance:g}", f"end_{distance:g}"]
            if missing := [name for name in ends if name not in plan.stations]:
                raise InputError(
                    f"config/scenes/{scene}.yaml: stations: {missing[0]} is missing; turns of {distance:g} m need it"
                )
            start, end = (np.array(plan.stations[name].position_m) for name in ends)
            made.append(Configuration(f"{scene}_{distance:.1f}", plan, start, end, distance, design.turning_repetitions))
    return made


def record_training(
    participants: pd.DataFrame,
    design: TrainingDesign,
    plans: Mapping[str, Plan],
    constants: WalkerConstants,
    seed: int,
    replicate: int,
    all_participants: Sequence[str] | None = None,
    standing: Standing | None = None,
    make_person: MakePerson = person_from_row,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Record some or all participants of experiment 1.

    Parameters
    ----------
    participants : rows of the participants table; any subset gives the same rows for each of them
    all_participants : names of the whole group, by which the flawed walks are chosen; default the given ones
    standing : speeds that bound the true walks; default ``Standing()``
    make_person : from a row of the participants table to who walks; default the first generator's people

    Returns
    -------
    recording : DataFrame[recording, participant, configuration, scene, time_s, x_m, y_m]; NaN where the sensor lost a frame
    truth : DataFrame[recording, participant, configuration, toward, start_s, end_s, flaw]
    """
    everything = configurations(design, plans)
    flaws = _flaws(list(all_participants or participants["participant"]), everything, design, constants, seed, replicate)
    frames, truths = [], []
    for _, row in participants.iterrows():
        name, person = str(row["participant"]), make_person(row, constants)
        order = generator(seed, replicate, DATASET, name, "order").permutation(len(everything))
        for index in order:
            configuration = everything[index]
            rng = generator(seed, replicate, DATASET, name, configuration.name)
            own = [flaws.get((name, configuration.name, i), NO_FLAW) for i in range(configuration.repetitions)]
            recorded, truth = _record(person, name, configuration, own, design, constants, rng, standing)
            frames.append(recorded)
            truths.append(truth)
    return concatenate(frames), pd.DataFrame([entry for truth in truths for entry in truth])


def _flaws(
    names: Sequence[str],
    everything: Sequence[Configuration],
    design: TrainingDesign,
    constants: WalkerConstants,
    seed: int,
    replicate: int,
) -> dict[tuple[str, str, int], str]:
    keys = [(name, c.name, i) for name in names for c in everything for i in range(c.repetitions)]
    lengths = [c.length_m for _ in names for c in everything for _ in range(c.repetitions)]
    if design.flawed_walks > len(keys):
        raise InputError(f"training: flawed_walks is {design.flawed_walks}, but only {len(keys)} walks are recorded; lower it")
    rng = generator(seed, replicate, DATASET, "flaws")
    return {keys[index]: flaw for index, flaw in choose_flawed(design.flawed_walks, lengths, constants, rng).items()}


def _record(
    person: Person,
    name: str,
    configuration: Configuration,
    flaws: Sequence[str],
    design: TrainingDesign,
    constants: WalkerConstants,
    rng: np.random.Generator,
    standing: Standing | None,
) -> tuple[dict, list[dict]]:
    legs, frames = _schedule(person, configuration, flaws, design, constants, rng)
    track = lay_track(legs, frames, design.rate_hz, person, constants, standing)
    step_s = 1 / design.rate_hz
    seen = track.position_m + standing_sway(frames, step_s, constants, rng)
    seen += constants.optical_noise_m * rng.standard_normal(seen.shape)
    lost = short_dropouts(frames, step_s, constants, rng)
    lose_frames(lost, legs, design.rate_hz, constants, rng)
    seen[lost] = np.nan
    keys = recording_keys(DATASET, name, configuration.name)
    labels = {"recording": keys, "participant": name, "configuration": configuration.name}
    truth = [
        labels | {"toward": leg.toward, "start_s": start, "end_s": end, "flaw": leg.flaw}
        for leg, (start, end) in zip(legs, track.spans_s, strict=True)
    ]
    columns = {"time_s": np.arange(frames) * step_s, "x_m": seen[:, 0], "y_m": seen[:, 1]}
    return labels | {"scene": configuration.plan.scene.name} | columns, truth


def _schedule(
    person: Person,
    configuration: Configuration,
    flaws: Sequence[str],
    design: TrainingDesign,
    constants: WalkerConstants,
    rng: np.random.Generator,
) -> tuple[list[Leg], int]:
    """Out and back again, with a standing phase before, between and after."""
    start, end = configuration.start_m, configuration.end_m
    out = habitual_path(configuration.plan.scene, tuple(start), tuple(end), person.habit)
    here, frame, legs = scattered(start, constants, rng), 0, []
    for flaw in flaws:
        for toward, path, aim in ((True, out, end), (False, out[::-1], start)):
            frame += _standing_frames(design, constants, rng)
            there = scattered(aim, constants, rng)
            shaped = move_ends(path, here, there)
            leg = make_leg(
                person, shaped, frame, design.rate_hz, constants, rng, configuration.name, toward, flaw if toward else NO_FLAW
            )
            legs.append(leg)
            here, frame = leg.end_m, leg.end_frame
    return legs, frame + _standing_frames(design, constants, rng)


def _standing_frames(design: TrainingDesign, constants: WalkerConstants, rng: np.random.Generator) -> int:
    return round(
        (design.standing_s + constants.standing_jitter_s * float(np.clip(rng.standard_normal(), -2, 2))) * design.rate_hz
    )


def recording_keys(dataset: str, participant: str, part: str) -> str:
    """Name of a recording: ``training/P03/straight_2.0`` for participant ``training_P03``."""
    return f"{dataset}/{participant.rsplit('_', 1)[-1]}/{part}"


def concatenate(pieces: Sequence[dict]) -> pd.DataFrame:
    """One table from recordings given as dicts of arrays and, for what is constant in a recording, strings.

    Strings become categories: a recording has thousands of rows and one name.
    """
    counts = [len(piece["time_s"]) for piece in pieces]
    columns: dict[str, object] = {}
    for column in pieces[0]:
        values = [piece[column] for piece in pieces]
        if isinstance(values[0], str):
            codes, names = pd.factorize(np.array(values))
            columns[column] = pd.Categorical.from_codes(np.repeat(codes, counts), categories=pd.Index(names))
        else:
            columns[column] = np.concatenate(values)
    return pd.DataFrame(columns)
