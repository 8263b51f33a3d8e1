"""Measures of realism against closed forms, and the comparison of what is there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from recorded_files import write_feet, write_goal_directed

from walklab.capture.foot_markers import STEP_S
from walklab.capture.realism import (
    MEASURES,
    PROFILE_AT,
    PROFILES,
    Sample,
    compare,
    gait_measures,
    goal_directed_samples,
    path_measures,
    rise_profile,
    rise_time,
    synthetic_samples,
    value_table,
)
from walklab.capture.recording_files import GOAL_DIRECTED
from walklab.capture.recordings import recorded_samples
from walklab.capture.walks import pair

CIRCLE_RADIUS_M, CIRCLE_ANGLE = 3.0, 1.0


def test_path_measures_of_an_arc() -> None:
    """Closed form: sagitta R (1 - cos(a / 2)), length R a over chord 2 R sin(a / 2), curvature 1 / R."""
    angle = np.linspace(0, CIRCLE_ANGLE, 300)
    excursion, excess, curvature = path_measures(CIRCLE_RADIUS_M * np.column_stack([np.cos(angle), np.sin(angle)]))
    assert excursion == pytest.approx(CIRCLE_RADIUS_M * (1 - np.cos(CIRCLE_ANGLE / 2)), rel=0.02)
    assert excess == pytest.approx(100 * (CIRCLE_ANGLE / (2 * np.sin(CIRCLE_ANGLE / 2)) - 1), rel=0.05)
    assert curvature == pytest.approx(1 / CIRCLE_RADIUS_M, rel=0.07)  # smoothing straightens the last 0.1 m at either end


def test_path_measures_do_not_depend_on_how_a_path_lies() -> None:
    rng = np.random.default_rng(3)
    share = np.linspace(0, 1, 300)
    path = np.column_stack([3 * share, 0.1 * np.sin(3 * np.pi * share)])
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    np.testing.assert_allclose(path_measures(path), path_measures(path @ turn.T + rng.normal(size=2)), rtol=1e-6)


def test_gait_measures_of_a_known_gait() -> None:
    """Speed v + A sin at the step's period and sway B sin at the stride's: standard deviations A / (v sqrt 2) and B / sqrt 2."""
    step_s, speed, amplitude, sway = 1 / 100, 1.3, 0.1, 0.02
    time_s = np.arange(0, 6 * STEP_S * 2, step_s)
    wave = 2 * np.pi * time_s / STEP_S
    x = speed * time_s - amplitude * STEP_S / (2 * np.pi) * np.cos(wave)
    y = sway * np.sin(wave / 2)
    swing, aside = gait_measures(np.column_stack([x, 0 * y]), step_s)
    assert swing == pytest.approx(100 * amplitude / speed / np.sqrt(2), rel=0.03)
    _, aside = gait_measures(np.column_stack([x, y]), step_s)
    assert aside == pytest.approx(sway / np.sqrt(2), rel=0.03)


def test_rise_time_of_a_linear_rise() -> None:
    assert rise_time(np.concatenate([np.linspace(0, 2, 101), np.full(50, 2.0)]), 0.01) == pytest.approx(0.8, abs=0.011)


def test_rise_profile_of_a_linear_rise_whatever_its_pace_and_of_a_slow_start() -> None:
    """Linear: from 0.1 to 0.9 in a line. Quadratic in time t: (sqrt 0.1 + share (sqrt 0.9 - sqrt 0.1))^2."""
    for frames, top in ((200, 1.4), (900, 0.7)):
        share = np.linspace(0, 1, frames)
        after = np.ones(50)
        linear = rise_profile(top * np.concatenate([share, after]))
        np.testing.assert_allclose(linear, 0.1 + 0.8 * PROFILE_AT, atol=0.01)
        slow = rise_profile(top * np.concatenate([share**2, after]), top)
        np.testing.assert_allclose(slow, (np.sqrt(0.1) + PROFILE_AT * (np.sqrt(0.9) - np.sqrt(0.1))) ** 2, atol=0.015)


def _samples(values: np.ndarray, group: str) -> list[Sample]:
    return [Sample(name, values, np.full(len(values), 1.0), group, group) for name in MEASURES]


def test_comparison_of_equal_and_of_disjoint_walks() -> None:
    values = np.linspace(1, 2, 21)
    same = compare(_samples(values, "synthetic") + _samples(values, "recorded"))
    apart = compare(_samples(values, "synthetic") + _samples(values + 5, "recorded"))
    assert set(same["quantity"]) == set(MEASURES)
    np.testing.assert_allclose(same["ks_distance"], 0)
    np.testing.assert_allclose(apart["ks_distance"], 1)
    assert (same["synthetic_median"] == 1.5).all()
    assert (same["n_recorded"] == 21).all()


def test_without_recordings_the_rows_say_why(tmp_path: Path) -> None:
    recorded, absent = recorded_samples(tmp_path)
    assert recorded == []
    table = compare(_samples(np.linspace(1, 2, 5), "synthetic"), absent)
    assert len(table) == len(MEASURES)
    assert table["recorded_median"].isna().all()
    assert table["remark"].str.contains("maroger_laas/human_float32.npz under WALKLAB_DATA").all()


def test_spiked_subjects_are_kept_apart(tmp_path: Path) -> None:
    write_goal_directed(tmp_path, {"E0615": (-1.5, 0.0), "O0640": (-4.0, 0.0)})
    write_feet(tmp_path)
    recorded, absent = recorded_samples(tmp_path)
    assert absent == ["no cmu_walk_amc under WALKLAB_DATA"]
    values = value_table(recorded)
    peaks = values[values["quantity"] == "peak_speed"].groupby("group")["value"]
    assert peaks.max()["recorded"] == pytest.approx(1.07, abs=1e-3)
    assert peaks.size().to_dict() == {"recorded": 14, "recorded, subjects with spikes": 6}
    shapes = values[values["quantity"] == "lateral_excursion"].groupby("group").size()
    assert shapes.to_dict() == {"recorded": 10, "recorded, facing within 10 degrees": 10}  # who faced away is no straight walk


def test_synthetic_walks_are_measured(training) -> None:
    some = training.accepted[training.accepted["participant"] == training.participants["participant"].iloc[0]]
    table = value_table(synthetic_samples(pair(some, training.samples, "samples")))
    assert set(table["quantity"]) == {*MEASURES, *PROFILES}
    assert np.isfinite(table["value"]).all()
    start = table[table["quantity"] == "start_profile"].groupby("at")["value"].median()
    assert start.iloc[0] < 0.2 < 0.8 < start.iloc[-1]
    assert start.is_monotonic_increasing
    steady = table[(table["quantity"] == "peak_speed") & (table["distance_m"] > 3.5)]["value"]
    assert 1.0 < steady.median() < 2.0


def test_real_recordings_measure_as_people_walk(data_folder: Path) -> None:
    """Spikes show in the peaks of subjects 8 to 10 alone, and people at steady speed swing by some per cent of it."""
    recorded, absent = recorded_samples(data_folder)
    if absent:
        pytest.skip("; ".join(absent))
    values = value_table(recorded)
    long = values[values["distance_m"] > 3]
    peaks = long[long["quantity"] == "peak_speed"].groupby("group")["value"].median()
    assert peaks["recorded"] < 1.7 < 2.0 < peaks["recorded, subjects with spikes"]
    medians: pd.Series = values.groupby("quantity")["value"].median()
    assert 3 < medians["speed_swing"] < 10
    assert 0.005 < medians["lateral_sway"] < 0.03
    assert len(goal_directed_samples([])) == 8
    assert (data_folder / GOAL_DIRECTED).is_file()
