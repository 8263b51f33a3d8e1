"""A user's own walks: a plain CSV or Parquet table of positions becomes walks and samples.

Rows in messages count from 1, the first row below the header.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.imported_walks import ImportRules, Positions, build_tables
from walklab.capture.walks import ACCEPTED, SAMPLES, WALKS, check
from walklab.errors import InputError
from walklab.geometry import curves
from walklab.geometry.standing import Standing, speeds
from walklab.storage import read_table

Array = NDArray[np.float64]

LENGTH_UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001}
TIME_UNITS_S = {"s": 1.0, "ms": 0.001}

FASTEST_M_S = 12.0  # faster than any person runs
HEIGHTS_M = (0.5, 2.5)
RATES_HZ = (5.0, 2000.0)
FARTHEST_M = 1000.0  # what the samples table holds
GAP_STEPS = 1.5  # a step longer than this many usual ones is a gap


@dataclass(frozen=True)
class OwnColumns:
    """What the columns of the file are called; None where there is no such column.

    Attributes
    ----------
    walk : tells one participant's walks apart; None if each participant has one
    time : None if every walk is sampled at the given rate without gaps
    scene : name of the scene of each walk; None if all are in the same
    """

    participant: str = "participant"
    walk: str | None = "walk"
    time: str | None = "time_s"
    x: str = "x_m"
    y: str = "y_m"
    height: str = "height_m"
    scene: str | None = None

    def used(self) -> dict[str, str]:
        """Meaning -> column, for those the file must have."""
        return {name: column for name, column in vars(self).items() if column is not None}


def import_walks(
    path: str | Path,
    columns: OwnColumns | None = None,
    length_unit: str = "m",
    time_unit: str = "s",
    rate_hz: float | None = None,
    standing: Standing | None = None,
    curvature_scale_m: float = 0.1,
    height_unit: str | None = None,
    scene: str = "open",
    rules: ImportRules | None = None,
    dataset: str = "own",
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Read a table of positions; each (participant, walk) is one candidate for a walk.

    Positions are smoothed (sigma 2 frames as in Agethen et al. 2017, section 4.4), cut where the person stands at the
    ends, and described; see :func:`walklab.capture.imported_walks.cut_walk`. Other columns of the file are ignored.

    Parameters
    ----------
    path : CSV or Parquet file
    length_unit, height_unit : "m", "cm" or "mm"; the height's unit is the length's unless given
    time_unit : "s" or "ms"
    rate_hz : frames per second; needed without a time column, a check on it otherwise
    standing : speeds that separate standing from walking
    curvature_scale_m : smoothing of the curvature along the path
    scene : where there is no scene column

    Returns
    -------
    walks, samples : conforming to ``capture.walks.WALKS`` and ``SAMPLES``; walk ids such as "own/P01/straight_1"

    Raises
    ------
    InputError
        One line with file, column and row: missing or empty file, missing column, empty or non-numeric value, times
        that do not ascend or have a gap, a rate, height, position or speed that no person has (wrong unit), and if
        not one candidate is a walk.
    """
    columns, source = columns or OwnColumns(), _Source(Path(path))
    _check_options(length_unit, height_unit or length_unit, time_unit, rate_hz, columns)
    table = source.read(columns)
    length, height = LENGTH_UNITS_M[length_unit], LENGTH_UNITS_M[height_unit or length_unit]
    numbers = {name: source.numbers(table, column) for name, column in columns.used().items() if name in _NUMERIC}
    units = {"x": length, "y": length, "height": height, "time": TIME_UNITS_S[time_unit]}
    table = table.assign(**{_si(name): values * units[name] for name, values in numbers.items()})
    groups = [columns.participant] + ([columns.walk] if columns.walk else [])
    candidates = [source.candidate(group, columns, rate_hz, scene, dataset) for _, group in table.groupby(groups, sort=False)]
    rules = rules or ImportRules()
    for group, positions in candidates:
        source.check_speed(group, columns, positions, rules)
    walks, samples = build_tables([found for _, found in candidates], standing or Standing(), curvature_scale_m, rules)
    if not (walks["rejection"] == ACCEPTED).any():
        first = walks.iloc[0]
        source.fail(f"no walk in it: {first['walk']} is {first['rejection']}; check length_unit, time_unit and the rate")
    return check(walks, WALKS, path), check(samples, SAMPLES, path)


_NUMERIC = ("time", "x", "y", "height")


def _si(name: str) -> str:
    """Where a quantity stands in metres and seconds; no user's column is called so."""
    return f"walklab:{name}"


def _check_options(length_unit: str, height_unit: str, time_unit: str, rate_hz: float | None, columns: OwnColumns) -> None:
    for name, unit, known in (
        ("length_unit", length_unit, LENGTH_UNITS_M),
        ("height_unit", height_unit, LENGTH_UNITS_M),
        ("time_unit", time_unit, TIME_UNITS_S),
    ):
        if unit not in known:
            raise InputError(f"{name}: unknown unit {unit!r}; use one of {', '.join(known)}")
    if rate_hz is None and columns.time is None:
        raise InputError("rate_hz: needed where there is no time column; give the frames per second")
    if rate_hz is not None and not RATES_HZ[0] <= rate_hz <= RATES_HZ[1]:
        raise InputError(f"rate_hz: {rate_hz:g} is outside {RATES_HZ[0]:g} to {RATES_HZ[1]:g} frames per second; correct it")


@dataclass(frozen=True)
class _Source:
    """The file, so that every complaint names it."""

    path: Path

    def fail(self, problem: str) -> NoReturn:
        raise InputError(f"{self.path}: {problem}")

    def fail_at(self, column: str, row: int, problem: str) -> NoReturn:
        self.fail(f"column {column}, row {row + 1}: {problem}")

    def read(self, columns: OwnColumns) -> pd.DataFrame:
        table = read_table(self.path).reset_index(drop=True)
        used = columns.used()
        for name, column in used.items():
            if column not in table.columns:
                self.fail(f"column {column}: no such column for the {name}; the file has {', '.join(map(str, table.columns))}")
        if len(table) == 0:
            self.fail("the file has no rows below its header; add walks")
        for name in ("participant", "walk", "scene"):
            if name in used:
                column = used[name]
                empty = np.flatnonzero(table[column].isna() | (table[column].astype(str).str.strip() == ""))
                if empty.size:
                    self.fail_at(column, int(empty[0]), f"empty; name the {name}")
                table[column] = table[column].astype(str).str.strip()
        return table

    def numbers(self, table: pd.DataFrame, column: str) -> Array:
        values = pd.to_numeric(table[column], errors="coerce").to_numpy(dtype=float)
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            row = int(bad[0])
            found = table[column].iloc[row]
            what = "empty" if pd.isna(found) else f"{str(found)!r} is no finite number"
            self.fail_at(column, row, f"{what}; fill it in or split the walk there")
        return values

    def candidate(
        self, group: pd.DataFrame, columns: OwnColumns, rate_hz: float | None, scene: str, dataset: str
    ) -> tuple[pd.DataFrame, Positions]:
        """One group as evenly sampled positions."""
        self._check_values(group, columns)
        points = group[[_si("x"), _si("y")]].to_numpy()
        participant = group[columns.participant].iloc[0]
        walk = group[columns.walk].iloc[0] if columns.walk else "1"
        start_s = 0.0
        if columns.time is None:
            assert rate_hz is not None
            rate = float(rate_hz)
        else:
            rate, points, start_s = self._even(group, columns.time, points, rate_hz)
        name = f"{dataset}/{participant}/{walk}"
        place = group[columns.scene].iloc[0] if columns.scene else scene
        return group, Positions(name, participant, place, "own", float(group[_si("height")].iloc[0]), start_s, rate, points)

    def _check_values(self, group: pd.DataFrame, columns: OwnColumns) -> None:
        rows, heights = group.index.to_numpy(), group[_si("height")].to_numpy()
        if len(group) < 3:
            self.fail_at(columns.participant, rows[0], f"its walk has {len(group)} samples; a walk needs many more")
        wrong = np.flatnonzero((heights < HEIGHTS_M[0]) | (heights > HEIGHTS_M[1]))
        if wrong.size:
            at = wrong[0]
            self.fail_at(
                columns.height, rows[at], f"{heights[at]:.4g} m is no person's height; check height_unit (or length_unit)"
            )
        changed = np.flatnonzero(heights != heights[0])
        if changed.size:
            self.fail_at(columns.height, rows[changed[0]], "the height changes within a walk; give one height per person")
        if columns.scene and (other := np.flatnonzero(group[columns.scene] != group[columns.scene].iloc[0])).size:
            self.fail_at(columns.scene, rows[other[0]], "the scene changes within a walk; split the walk there")
        for name in ("x", "y"):
            far = np.flatnonzero(np.abs(group[_si(name)].to_numpy()) > FARTHEST_M)
            if far.size:
                column = getattr(columns, name)
                self.fail_at(
                    column, rows[far[0]], f"more than {FARTHEST_M:g} m from the origin; check length_unit or shift the origin"
                )

    def _even(self, group: pd.DataFrame, column: str, points_m: Array, rate_hz: float | None) -> tuple[float, Array, float]:
        """Check the times of one group and resample it to an even rate if they jitter."""
        rows, time_s = group.index.to_numpy(), group[_si("time")].to_numpy()
        steps = np.diff(time_s)
        back = np.flatnonzero(steps <= 0)
        if back.size:
            problem = "the same time twice" if steps[back[0]] == 0 else "time goes back"
            self.fail_at(column, rows[back[0] + 1], f"{problem}; sort each walk by time and give every walk its own name")
        usual = float(np.median(steps))
        if not RATES_HZ[0] <= 1 / usual <= RATES_HZ[1]:
            self.fail_at(
                column,
                rows[1],
                f"frames come every {usual:.4g} s, outside {RATES_HZ[0]:g} to {RATES_HZ[1]:g} Hz; check time_unit",
            )
        if rate_hz is not None and abs(usual * rate_hz - 1) > 0.05:
            self.fail_at(
                column, rows[1], f"frames come at {1 / usual:.4g} Hz, but rate_hz is {rate_hz:g}; correct rate_hz or time_unit"
            )
        gaps = np.flatnonzero(steps > GAP_STEPS * usual)
        if gaps.size:
            at = gaps[0]
            self.fail_at(
                column,
                rows[at + 1],
                f"a gap of {steps[at]:.4g} s before it (usual {usual:.4g} s); fill it or split the walk there",
            )
        frames = max(1, round((time_s[-1] - time_s[0]) / usual))
        rate = frames / (time_s[-1] - time_s[0])
        even = time_s[0] + np.arange(frames + 1) / rate
        resampled = np.column_stack([np.interp(even, time_s, points_m[:, axis]) for axis in (0, 1)])
        return rate, resampled, max(0.0, float(time_s[0]))

    def check_speed(self, group: pd.DataFrame, columns: OwnColumns, positions: Positions, rules: ImportRules) -> None:
        """Speeds are judged after smoothing, so that the noise of a fine sensor is not taken for a wrong unit."""
        speed = speeds(curves.smooth(positions.position_m, rules.smoothing_sigma_frames), 1 / positions.rate_hz)
        fast = np.flatnonzero(speed > FASTEST_M_S)
        if fast.size:
            at = min(int(fast[0]), len(group) - 1)
            self.fail_at(
                columns.x,
                group.index[at],
                f"a speed of {speed[fast[0]]:.3g} m/s; check length_unit, time_unit and the rate, or remove the jump",
            )
