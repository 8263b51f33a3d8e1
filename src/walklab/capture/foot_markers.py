"""A walk of 20 m there and back, standing before and after, seen by markers on both feet (gaitmap, Kuederle et al. 2022)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.standing import speeds

Array = NDArray[np.float64]

RATE_HZ = 100.0  # the file does not say; ORIGIN.md of the recording does
REACHED = 0.9  # share of the cruising speed at which a start is over
STEP_S = 0.55  # over which the mean of both feet is averaged: one step of this person


@dataclass(frozen=True)
class Ramps:
    """How one person got going from standing and came to stand again.

    Attributes
    ----------
    start, stop : (n,) arrays of speed averaged over one step, from standing up to nearly cruising (1) and back
    step_s : between samples
    cruising_speed_m_s : median speed between start and stop, the turn left out
    """

    start: Array
    stop: Array
    step_s: float
    cruising_speed_m_s: float


def read_feet(path: str | Path) -> Array:
    """Mean of all markers of both feet on the floor, (n, 2) array, metres; a table with two header rows, in millimetres.

    Raises
    ------
    InputError
        If the table is unreadable, lacks an axis or a foot, or has missing values.
    """
    try:
        table = pd.read_csv(path, header=[0, 1], index_col=0)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a table with two header rows ({str(error).splitlines()[0]}); fetch it again") from error
    names = table.columns.get_level_values(0)
    for foot in ("L_", "R_"):
        if not any(str(name).startswith(foot) for name in names):
            raise InputError(f"{path}: no marker {foot}* of that foot; fetch the table again")
    feet = []
    for foot in ("L_", "R_"):
        own = table.loc[:, [str(name).startswith(foot) for name in names]]
        try:
            feet.append(np.column_stack([own.xs(axis, axis=1, level=1).to_numpy().mean(axis=1) for axis in ("x", "y")]))
        except KeyError as error:
            raise InputError(f"{path}: markers of foot {foot}* lack the axis {error}; fetch the table again") from error
    middle = np.mean(feet, axis=0) / 1000
    if not np.isfinite(middle).all():
        row = int(np.flatnonzero(~np.isfinite(middle).all(axis=1))[0])
        raise InputError(f"{path}: row {row}: a marker is missing; fetch the table again")
    return middle


def step_mean(values: Array, frames: int) -> Array:
    """Moving mean over one step, ends held, same shape; takes the swing within each step out of positions or speeds."""
    window = np.ones(max(1, frames)) / max(1, frames)
    before, after = (len(window) - 1) // 2, len(window) // 2
    padded = np.concatenate([np.repeat(values[:1], before, axis=0), values, np.repeat(values[-1:], after, axis=0)])
    if values.ndim == 1:
        return np.convolve(padded, window, mode="valid")
    return np.column_stack([np.convolve(padded[:, axis], window, mode="valid") for axis in range(values.shape[1])])


def ramps(feet_m: Array, rate_hz: float = RATE_HZ, standing_speed_m_s: float = 0.05) -> Ramps:
    """Start and stop of a walk from standing to standing that turns round once on its way.

    The start ends, and the stop begins, where the speed averaged over a step first (last) reaches ``REACHED`` of the
    cruising speed.

    Raises
    ------
    InputError
        If the recording does not begin and end standing, or nobody walks in it.
    """
    speed = speeds(step_mean(feet_m, round(STEP_S * rate_hz)), 1 / rate_hz)
    moving = np.flatnonzero(speed >= standing_speed_m_s)
    if moving.size == 0 or moving[0] == 0:
        raise InputError("foot markers: the recording does not go from standing to walking; use another one")
    fast = speed[speed > 0.5 * speed.max()]
    cruising = float(np.median(fast))
    reached = np.flatnonzero(speed >= REACHED * cruising)
    first, last = int(reached[0]), int(reached[-1])
    stopped = last + int(np.argmax(speed[last:] < standing_speed_m_s))
    if stopped == last:
        raise InputError("foot markers: the recording does not end standing; use another one")
    start, stop = speed[moving[0] - 1 : first + 1], speed[last : stopped + 1]
    return Ramps(start / start[-1], stop / stop[0], 1 / rate_hz, cruising)
