"""Reading and writing what the captures produce before walks are cut: people, recordings, poses, truth, travel times."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pandera.pandas as pa

from walklab.capture.walks import check
from walklab.errors import InputError
from walklab.storage import read_table, write_table

_LABEL: dict[str, Any] = {"dtype": "category", "coerce": True, "nullable": False}
_NUMBER: dict[str, Any] = {"nullable": False, "coerce": True}
_IN_ROOM = pa.Check.in_range(-1000, 1000)

PARTICIPANTS = pa.DataFrameSchema(
    {
        "participant": pa.Column(str, unique=True, description="who, as group_Pnn"),
        "sex": pa.Column(str, pa.Check.isin(["female", "male"]), description="female or male, as the paper counts them"),
        "age_years": pa.Column(float, pa.Check.in_range(0, 120), description="age", **_NUMBER),
        "height_m": pa.Column(float, pa.Check.in_range(0.5, 2.5), description="body height", **_NUMBER),
        "mass_kg": pa.Column(float, pa.Check.in_range(10, 300), description="body mass", **_NUMBER),
        "torso_depth_m": pa.Column(
            float, pa.Check.in_range(0.05, 0.6), description="from the belly to the middle of the body", **_NUMBER
        ),
        "trait_.+": pa.Column(
            float,
            regex=True,
            required=False,
            description="how this synthetic person walks; read by the generator alone",
            **_NUMBER,
        ),
    },
    strict=True,
)

_LABELS = {
    name: pa.Column(**_LABEL, description=what)
    for name, what in {
        "recording": "name of the continuous recording",
        "participant": "who was recorded",
        "configuration": "what was walked",
        "scene": "name of the plan view, or open for none",
    }.items()
}
_TIME = {"time_s": pa.Column(float, pa.Check.ge(0), description="time from the start of the recording", **_NUMBER)}
_PLACE = {
    name: pa.Column(
        float, _IN_ROOM, nullable=True, coerce=True, description="measured position on the floor; missing in a dropout"
    )
    for name in ("x_m", "y_m")
}

RECORDING = pa.DataFrameSchema(_LABELS | _TIME | _PLACE, strict=True, ordered=True)

POSES = pa.DataFrameSchema(
    _LABELS
    | _TIME
    | _PLACE
    | {"z_m": pa.Column(float, _IN_ROOM, nullable=True, coerce=True, description="height of the controller above the floor")}
    | {
        name: pa.Column(
            float, pa.Check.in_range(-1.01, 1.01), nullable=True, coerce=True, description="unit quaternion of the controller"
        )
        for name in ("qw", "qx", "qy", "qz")
    },
    strict=True,
    ordered=True,
)

TRUTH = pa.DataFrameSchema(
    {
        "recording": pa.Column(str, description="name of the recording"),
        "participant": pa.Column(str, description="who walked"),
        "configuration": pa.Column(str, description="what was walked"),
        "toward": pa.Column(bool, description="to the target, not back"),
        "start_s": pa.Column(float, pa.Check.ge(0), description="true begin of the movement", **_NUMBER),
        "end_s": pa.Column(float, pa.Check.ge(0), description="true end of the movement", **_NUMBER),
        "flaw": pa.Column(str, description="how the movement was spoilt on purpose; empty for none"),
    },
    strict=True,
    ordered=True,
)

TRAVEL_TIMES = pa.DataFrameSchema(
    {
        "walk": pa.Column(str, unique=True, description="name of the walk"),
        "participant": pa.Column(str, description="who walked"),
        "height_m": pa.Column(float, pa.Check.in_range(0.5, 2.5), description="body height", **_NUMBER),
        "distance_m": pa.Column(float, pa.Check.gt(0), description="distance walked", **_NUMBER),
        "repetition": pa.Column(int, pa.Check.ge(0), coerce=True, description="which of the repetitions"),
        "travel_time_s": pa.Column(float, pa.Check.gt(0), description="counted in video frames", **_NUMBER),
    },
    strict=True,
    ordered=True,
)


def write_participants(participants: pd.DataFrame, path: str | Path) -> None:
    """Check and write the participants table."""
    write_table(check(participants, PARTICIPANTS, path), path)


def read_participants(path: str | Path, group: str | None = None) -> pd.DataFrame:
    """The participants table, checked; those of one group only if it is named.

    Raises
    ------
    InputError
        If the table breaks its schema or nobody belongs to the group.
    """
    participants = check(read_table(path), PARTICIPANTS, path)
    if group is None:
        return participants
    own = participants[participants["participant"].str.startswith(f"{group}_P")].reset_index(drop=True)
    if own.empty:
        raise InputError(f"{path}: column participant: nobody is called {group}_P..; draw the participants of that group")
    return own


def write_recording(recording: pd.DataFrame, path: str | Path) -> None:
    """Check and write positions over time."""
    write_table(_check_times(check(recording, RECORDING, path), path), path)


def read_recording(path: str | Path) -> pd.DataFrame:
    """Positions over time, checked; NaN positions are lost frames."""
    return _check_times(check(read_table(path), RECORDING, path), path)


def write_poses(poses: pd.DataFrame, path: str | Path) -> None:
    """Check and write poses over time."""
    write_table(_check_times(check(poses, POSES, path), path), path)


def read_poses(path: str | Path) -> pd.DataFrame:
    """Poses over time, checked; NaN poses are lost frames."""
    return _check_times(check(read_table(path), POSES, path), path)


def write_truth(truth: pd.DataFrame, path: str | Path) -> None:
    """Check and write the true boundaries of a synthetic capture."""
    write_table(check(truth, TRUTH, path), path)


def read_truth(path: str | Path) -> pd.DataFrame:
    """The true boundaries of a synthetic capture, checked."""
    return check(read_table(path), TRUTH, path)


def write_travel_times(times: pd.DataFrame, path: str | Path) -> None:
    """Check and write travel times over long distances."""
    write_table(check(times, TRAVEL_TIMES, path), path)


def read_travel_times(path: str | Path) -> pd.DataFrame:
    """Travel times over long distances, checked."""
    return check(read_table(path), TRAVEL_TIMES, path)


def _check_times(frames: pd.DataFrame, source: str | Path) -> pd.DataFrame:
    """Rows of a recording stand together and their times ascend."""
    codes = frames["recording"].cat.codes.to_numpy()
    time_s = frames["time_s"].to_numpy()
    new = np.diff(codes) != 0
    if np.any(wrong := ~new & (np.diff(time_s) <= 0)):
        row = int(np.flatnonzero(wrong)[0]) + 1
        raise InputError(
            f"{source}: column time_s, row {row}: {time_s[row]:g} s does not ascend within its recording; sort the rows by time"
        )
    if new.sum() + 1 > len(np.unique(codes)):
        raise InputError(f"{source}: column recording: rows of one recording stand apart; sort the rows by recording and time")
    return frames
