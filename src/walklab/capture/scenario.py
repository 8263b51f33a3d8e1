"""Experiment 2: sets of assembly tasks, recorded as the pose of a controller at the belt (Agethen et al. 2017, 7.2, 7.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from walklab.capture.constants import WalkerConstants
from walklab.capture.paths import habitual_path, move_ends
from walklab.capture.sensor import short_dropouts, standing_sway
from walklab.capture.timeline import NO_FLAW, Leg, Track, choose_flawed, lay_track, lose_frames, make_leg, scattered
from walklab.capture.training import concatenate, recording_keys
from walklab.capture.walker import MakePerson, Person, person_from_row, smooth_step
from walklab.errors import InputError
from walklab.geometry.plans import Plan, Station
from walklab.geometry.standing import Standing
from walklab.randomness import generator

Array = NDArray[np.float64]

# Columns: the controller's axes in the body's (forward, left, up); z points into the body.
_MOUNTING = Rotation.from_matrix(np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))


@dataclass(frozen=True)
class ScenarioDesign:
    """What the participants do.

    Attributes
    ----------
    sets : for each participant of the group how many sets of tasks
    rate_hz : of the tracking system
    flawed_walks : over all participants, spoilt and to be rejected
    controller_offset_m : stated distance between controller and skin
    upper_shelf_m : visits of a station with a work height alternate between this height and the station's
    first_standing_s, last_standing_s : before the first and after the last task of a set
    """

    sets: tuple[int, ...] = (20, 19, 18, 17, 19, 18, 17, 18, 18, 17)
    rate_hz: float = 60.0
    flawed_walks: int = 0
    controller_offset_m: float = 0.02
    upper_shelf_m: float = 1.0
    first_standing_s: tuple[float, float] = (2.0, 3.0)
    last_standing_s: tuple[float, float] = (2.0, 3.0)


@dataclass(frozen=True)
class Bend:
    """One bending: first frame, frames down, held and up, how far below upright reach, and where the person faces."""

    start: int
    down: int
    hold: int
    depth_m: float
    facing_rad: float


@dataclass
class _Script:
    """A set as it unfolds: legs, bends, and the turn on the spot before and after each leg in frames."""

    legs: list[Leg]
    bends: list[Bend]
    turns: list[tuple[int, int]]
    facings_rad: list[tuple[float, float]]
    frames: int = 0


def record_scenario(
    participants: pd.DataFrame,
    plan: Plan,
    design: ScenarioDesign,
    constants: WalkerConstants,
    seed: int,
    replicate: int,
    all_participants: Sequence[str] | None = None,
    standing: Standing | None = None,
    make_person: MakePerson = person_from_row,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Record some or all participants of one scenario of experiment 2, one recording per set.

    Parameters
    ----------
    participants : rows of the participants table; any subset gives the same rows for each of them
    all_participants : names of the whole group, in the order of ``design.sets``; default the given ones
    standing : speeds that bound the true walks; default ``Standing()``
    make_person : from a row of the participants table to who walks; default the first generator's people

    Returns
    -------
    poses : DataFrame[recording, participant, configuration (empty), scene, time_s, x_m, y_m, z_m, qw, qx, qy, qz];
        NaN where the sensor lost a frame; the quaternion turns the controller's axes into the room's (z up)
    truth : DataFrame[recording, participant, configuration, toward, start_s, end_s, flaw]

    Raises
    ------
    InputError
        If the number of participants differs from that of ``design.sets``, or consecutive walks do not chain.
    """
    names = list(all_participants or participants["participant"])
    if len(names) != len(design.sets):
        raise InputError(f"{plan.scene.name}: sets has {len(design.sets)} entries for {len(names)} participants; give one each")
    for (_, end), (start, _) in zip(plan.walks, plan.walks[1:], strict=False):
        if end != start:
            raise InputError(
                f"config/scenes/{plan.scene.name}.yaml: walks: one ends at {end}, the next starts at {start}; make them chain"
            )
    flaws = _flaws(names, plan, design, constants, seed, replicate)
    pieces, truths = [], []
    for _, row in participants.iterrows():
        name, person = str(row["participant"]), make_person(row, constants)
        paths = {
            (a, b): habitual_path(plan.scene, plan.stations[a].position_m, plan.stations[b].position_m, person.habit)
            for a, b in set(plan.walks)
        }
        for index in range(design.sets[names.index(name)]):
            rng = generator(seed, replicate, plan.scene.name, name, index)
            own = [flaws.get((name, index, walk), NO_FLAW) for walk in range(len(plan.walks))]
            script = _perform(person, plan, paths, own, design, constants, rng)
            labels = {
                "recording": recording_keys(plan.scene.name, name, f"set_{index + 1:02d}"),
                "participant": name,
                "configuration": "",
                "scene": plan.scene.name,
            }
            track = lay_track(script.legs, script.frames, design.rate_hz, person, constants, standing)
            pieces.append(labels | _seen(person, script, track, design, constants, rng))
            truths += [
                {"recording": labels["recording"], "participant": name, "configuration": leg.configuration, "toward": True}
                | {"start_s": start, "end_s": end, "flaw": leg.flaw}
                for leg, (start, end) in zip(script.legs, track.spans_s, strict=True)
            ]
    return concatenate(pieces), pd.DataFrame(truths)


def _flaws(
    names: Sequence[str], plan: Plan, design: ScenarioDesign, constants: WalkerConstants, seed: int, replicate: int
) -> dict[tuple[str, int, int], str]:
    keys = [
        (name, i, walk)
        for name, sets in zip(names, design.sets, strict=True)
        for i in range(sets)
        for walk in range(len(plan.walks))
    ]
    straight = [float(np.hypot(*np.subtract(plan.stations[a].position_m, plan.stations[b].position_m))) for a, b in plan.walks]
    lengths = straight * sum(design.sets)
    if design.flawed_walks > len(keys):
        raise InputError(
            f"{plan.scene.name}: flawed_walks is {design.flawed_walks}, but only {len(keys)} walks are recorded; lower it"
        )
    rng = generator(seed, replicate, plan.scene.name, "flaws")
    return {keys[index]: flaw for index, flaw in choose_flawed(design.flawed_walks, lengths, constants, rng).items()}


def _perform(
    person: Person,
    plan: Plan,
    paths: dict[tuple[str, str], Array],
    flaws: Sequence[str],
    design: ScenarioDesign,
    constants: WalkerConstants,
    rng: np.random.Generator,
) -> _Script:
    """Walk one set: work, turn, walk, turn, work, ... each walk from where the last one ended."""
    script = _Script([], [], [], [])
    rate = design.rate_hz
    visits: dict[str, int] = {}
    here = scattered(np.array(plan.stations[plan.walks[0][0]].position_m), constants, rng)
    frame = round(rng.uniform(*design.first_standing_s) * rate)
    for (origin, target), flaw in zip(plan.walks, flaws, strict=True):
        station, goal = plan.stations[origin], plan.stations[target]
        frame = _work(script, station, visits.get(origin, 0), frame, design, constants, rng)
        visits[origin] = visits.get(origin, 0) + 1
        turn_away, turn_to = (round(rng.uniform(*constants.turning_time_s) * rate) for _ in range(2))
        there = scattered(np.array(goal.position_m), constants, rng)
        path = move_ends(paths[origin, target], here, there)
        leg = make_leg(person, path, frame + turn_away, rate, constants, rng, f"{origin}-{target}", True, flaw)
        script.legs.append(leg)
        script.turns.append((turn_away, turn_to))
        script.facings_rad.append((np.deg2rad(station.facing_deg), np.deg2rad(goal.facing_deg)))
        here, frame = leg.end_m, leg.end_frame
    last = plan.walks[-1][1]
    frame = _work(script, plan.stations[last], visits.get(last, 0), frame, design, constants, rng)
    script.frames = frame + round(rng.uniform(*design.last_standing_s) * rate)
    return script


def _work(
    script: _Script,
    station: Station,
    visit: int,
    frame: int,
    design: ScenarioDesign,
    constants: WalkerConstants,
    rng: np.random.Generator,
) -> int:
    """Fasten a screw standing upright, or bend for one; return the frame after it."""
    if station.work_height_m is None:
        return frame + round(rng.uniform(*constants.fastening_s) * design.rate_hz)
    height_m = station.work_height_m if visit % 2 else design.upper_shelf_m
    pause, down, hold = (
        round(rng.uniform(*span) * design.rate_hz)
        for span in (constants.pause_before_bending_s, constants.bending_down_s, constants.bending_hold_s)
    )
    depth = max(constants.upright_reach_m - height_m, 0.0) * float(np.exp(0.1 * np.clip(rng.standard_normal(), -2, 2)))
    script.bends.append(Bend(frame + pause, down, hold, depth, float(np.deg2rad(station.facing_deg))))
    return frame + pause + 2 * down + hold


def _seen(
    person: Person, script: _Script, track: Track, design: ScenarioDesign, constants: WalkerConstants, rng: np.random.Generator
) -> dict[str, Array]:
    """The controller's pose at each frame."""
    frames, step_s = script.frames, 1 / design.rate_hz
    yaw = _yaw(script, track, constants)
    tilt, height = np.zeros(frames), np.full(frames, constants.pelvis_height_ratio * person.height_m)
    pelvis = track.position_m + standing_sway(frames, step_s, constants, rng)
    for bend in script.bends:
        stooped = _stoop(bend, frames) * bend.depth_m
        tilt += constants.pelvis_tilt_rad_per_m * stooped
        height -= constants.pelvis_down_per_m * stooped
        back = np.array([np.cos(bend.facing_rad), np.sin(bend.facing_rad)])
        pelvis -= constants.pelvis_back_per_m * stooped[:, None] * back
    belt_m = person.torso_depth_m / 2 + design.controller_offset_m + person.belt_gap_error_m
    turned = Rotation.from_euler("ZY", np.column_stack([yaw, tilt])) * _MOUNTING
    position = np.column_stack([pelvis, height]) - belt_m * turned.apply([0.0, 0.0, 1.0])
    position += constants.belt_noise_m * rng.standard_normal(position.shape)
    turned = Rotation.from_rotvec(constants.belt_noise_rad * rng.standard_normal((frames, 3))) * turned
    pose = np.column_stack([position, turned.as_quat(scalar_first=True)])
    lost = short_dropouts(frames, step_s, constants, rng)
    lose_frames(lost, script.legs, design.rate_hz, constants, rng)
    pose[lost] = np.nan
    return {"time_s": np.arange(frames) * step_s} | dict(zip(("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"), pose.T, strict=True))


def _stoop(bend: Bend, frames: int) -> Array:
    """0 upright, 1 fully bent."""
    at = np.arange(frames, dtype=float) - bend.start
    return smooth_step(np.clip(at / bend.down, 0, 1)) * smooth_step(np.clip((2 * bend.down + bend.hold - at) / bend.down, 0, 1))


def _yaw(script: _Script, track: Track, constants: WalkerConstants) -> Array:
    """Direction the hip faces: the work while standing, the path while walking, smooth turns on the spot between."""
    yaw = np.full(script.frames, script.facings_rad[0][0])
    motions = iter(track.motions)
    for leg, (away, to), (facing, next_facing) in zip(script.legs, script.turns, script.facings_rad, strict=True):
        heading = np.full(script.frames, np.nan)
        for _ in leg.parts:
            start, motion = next(motions)
            strength = motion.speed_m_s**2 / (motion.speed_m_s**2 + constants.sway_onset_m_s**2)
            turned = motion.heading_rad + constants.pelvic_rotation_rad * strength * np.sin(motion.stride_phase_rad)
            heading[start : start + len(turned)] = turned
        heading = np.unwrap(_hold(heading))
        at = np.arange(script.frames)
        middle = (leg.start_frame + leg.end_frame) // 2
        begun = smooth_step(np.clip((at - leg.start_frame + away) / (away + 6), 0, 1))
        left = 1 - smooth_step(np.clip((at - leg.end_frame + 12) / to, 0, 1))
        first, second = at < middle, at >= middle
        base = leg.start_frame - away
        yaw[first & (at >= base)] = (facing + begun * _short_way(heading, facing, leg.start_frame))[first & (at >= base)]
        yaw[second] = (next_facing + left * _short_way(heading, next_facing, leg.end_frame))[second]
    return yaw


def _hold(values: Array) -> Array:
    known = np.flatnonzero(~np.isnan(values))
    return values[known[np.clip(np.searchsorted(known, np.arange(len(values)), side="right") - 1, 0, None)]]


def _short_way(heading: Array, facing: float, frame: int) -> Array:
    """Heading relative to a facing, by the shorter way round at the given frame."""
    offset = heading - facing
    return offset - 2 * np.pi * np.round(offset[min(frame, len(offset) - 1)] / (2 * np.pi))
