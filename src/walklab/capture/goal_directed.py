"""The 400 goal-directed walks of Maroger et al. 2020: path shapes and hodographs, without their time.

Ten people walked from forty start configurations (ten places, four directions to face) to one goal. The published file
holds positions at equal arc length and, separately, velocities at equal steps along the hodograph. When either was
reached is lost, so that no duration, mean speed or rise time can be had from them; path shapes and peak speeds can.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.curves import length

Array = NDArray[np.float64]

SUBJECTS = 10
# Initial of the direction in which a person stands at first (French: est, nord, ouest, sud), radians from +x.
FACING_RAD = {"E": 0.0, "N": np.pi / 2, "O": np.pi, "S": -np.pi / 2}

# ASSUME: A walk is straight if the goal lies within 30 degrees of where the person faced, since nobody in experiment 1 had to
# turn first.
STRAIGHT_RAD = np.deg2rad(30.0)


@dataclass(frozen=True)
class GoalDirectedWalk:
    """One real walk without its time.

    Attributes
    ----------
    configuration : start configuration as in the file, e.g. ``E1540``
    subject : 1 to 10
    position_m : (n, 2) array, equally spaced along the path
    peak_speed_m_s : largest speed of the hodograph; noise and spikes of the recording make it larger, never smaller
    """

    configuration: str
    subject: int
    position_m: Array
    peak_speed_m_s: float

    @property
    def distance_m(self) -> float:
        """From start to end, straight."""
        return float(np.hypot(*(self.position_m[-1] - self.position_m[0])))

    @property
    def facing_off_rad(self) -> float:
        """How far the way to the end lies from where the person faces before the start, absolute, radians."""
        x, y = self.position_m[-1] - self.position_m[0]
        off = np.arctan2(y, x) - FACING_RAD[self.configuration[0]]
        return float(abs(np.arctan2(np.sin(off), np.cos(off))))


def read_goal_directed(path: str | Path) -> list[GoalDirectedWalk]:
    """All walks of the archive, by configuration and subject.

    The archive has one array per configuration: 11 (the mean, then ten subjects) x 6 (x, y, vx, vy and two angles) x samples.

    Raises
    ------
    InputError
        If the file is no such archive, or a walk has values that are not numbers or leads nowhere.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            stacks = {name: np.asarray(archive[name], dtype=float) for name in sorted(archive.files) if archive[name].ndim == 3}
    except (OSError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(f"{path}: not a readable archive of walks ({reason}); fetch it again from its origin") from error
    if not stacks:
        raise InputError(f"{path}: holds no walks (arrays of three dimensions); fetch it again from its origin")
    walks = []
    for name, stack in stacks.items():
        if stack.shape[0] != SUBJECTS + 1 or stack.shape[1] < 4 or name[0] not in FACING_RAD:
            raise InputError(
                f"{path}: key {name}: shape {stack.shape} is not (11, 6, samples) of a direction E, N, O or S; fetch it again"
            )
        walks += [_walk(name, subject, stack[subject], path) for subject in range(1, SUBJECTS + 1)]
    return walks


def _walk(name: str, subject: int, rows: Array, path: str | Path) -> GoalDirectedWalk:
    if not np.isfinite(rows[:4]).all() or length(rows[:2].T) == 0:
        raise InputError(f"{path}: key {name}, subject {subject}: not a walk of finite positions; fetch it again")
    return GoalDirectedWalk(name, subject, np.ascontiguousarray(rows[:2].T), float(np.hypot(rows[2], rows[3]).max()))
