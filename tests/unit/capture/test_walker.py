from dataclasses import replace

import numpy as np
import pytest

from walklab.capture.constants import WalkerConstants, without_dependency_effects
from walklab.capture.paths import Habit
from walklab.capture.walker import (
    Bell,
    Person,
    draw_walk,
    norm_speed_m_s,
    peak_speed_m_s,
    person_from_row,
    sample_walk,
    speed_profile,
    turn_slowing,
)
from walklab.geometry.curves import length
from walklab.randomness import generator

PERSON = Person(
    comfortable_speed_m_s=1.5,
    norm_speed_m_s=1.5,
    distance_constant_m=2.2,
    start_time_s=1.4,
    stop_time_s=1.5,
    turn_exponent=1 / 3,
    walk_ratio_m_min=0.0064,
    sway_lateral_m=0.02,
    sway_fore_aft_m=0.007,
    wander_ratio=0.0,
    belt_gap_error_m=0.0,
    torso_depth_m=0.24,
    height_m=1.8,
    habit=Habit(0.4, 0.25, 0.6, 0.16),
)
CONSTANTS = WalkerConstants()


def _with(row, height_m: float):
    changed = row.copy()
    changed["height_m"] = height_m
    return changed


def circle(radius_m: float) -> np.ndarray:
    at = np.linspace(0, 8 * np.pi, int(8 * np.pi * radius_m / 0.01))
    return radius_m * np.column_stack([np.cos(at), np.sin(at)])


def test_distance_is_the_integral_of_the_speed():
    bell = Bell(1.3, 1.2, 0.7, 1.5)
    time_s = np.linspace(-0.2, bell.duration_s + 0.2, 20001)
    steps = 0.5 * (bell.speed(time_s)[1:] + bell.speed(time_s)[:-1]) * np.diff(time_s)
    np.testing.assert_allclose(bell.travelled(time_s)[1:], np.cumsum(steps), atol=1e-7)


@pytest.mark.parametrize("constants", [CONSTANTS, without_dependency_effects(CONSTANTS)])
@pytest.mark.parametrize("distance_m", [0.5, 1.0, 2.0, 4.0, 50.0])
def test_profile_covers_the_length(constants, distance_m):
    bell = speed_profile(PERSON, distance_m, 1.1 * distance_m, constants, np.array([0.5, -1.0, 1.0]))
    assert bell.travelled(np.array([bell.duration_s]))[0] == pytest.approx(1.1 * distance_m, rel=1e-12)
    assert bell.plateau_s >= 0


def test_a_walk_begins_and_ends_where_its_path_does():
    path = np.column_stack([np.linspace(0, 3, 301), np.zeros(301)])
    walk = draw_walk(PERSON, path, CONSTANTS, generator(1))
    motion = sample_walk(walk, np.arange(-0.5, walk.duration_s + 0.5, 1 / 120), PERSON, CONSTANTS)
    np.testing.assert_allclose(motion.position_m[[0, -1]], path[[0, -1]], atol=1e-9)
    assert length(motion.position_m) == pytest.approx(3.0, rel=0.02)


def test_sway_goes_with_stride_and_step():
    """Spectral peaks over the plateau of a long walk: lateral at half the step rate, fore-aft at the step rate."""
    path = np.column_stack([np.linspace(0, 60, 6001), np.zeros(6001)])
    walk = draw_walk(PERSON, path, CONSTANTS, generator(2))
    time_s = np.arange(5, 35, 0.01)
    moved = sample_walk(walk, time_s, PERSON, CONSTANTS).position_m
    steps_per_s = np.sqrt(60 * walk.bell.peak_m_s / PERSON.walk_ratio_m_min) / 60
    trend = np.polynomial.Polynomial.fit(time_s, moved[:, 0], 1)(time_s)
    for values, expected in ((moved[:, 1], steps_per_s / 2), (moved[:, 0] - trend, steps_per_s)):
        spectrum = np.abs(np.fft.rfft(values * np.hanning(len(values))))
        assert np.fft.rfftfreq(len(values), 0.01)[np.argmax(spectrum)] == pytest.approx(expected, abs=0.06)
    assert 1.6 < steps_per_s < 2.3


def test_slowing_follows_the_power_law_in_tight_turns():
    speeds = [float(np.median(turn_slowing(circle(radius), 1 / 3, CONSTANTS))) for radius in (0.1, 0.2)]
    assert np.log(speeds[1] / speeds[0]) / np.log(2) == pytest.approx(1 / 3, abs=0.03)
    straight = np.column_stack([np.linspace(0, 2, 201), np.zeros(201)])
    np.testing.assert_allclose(turn_slowing(straight, 1 / 3, CONSTANTS), 1.0)


def test_speed_norms_are_the_published_ones_at_reference_stature():
    """Bohannon 1997: 1.393 m/s for men in their twenties, 1.415 m/s for women in their thirties."""
    for sex, age, height_m, speed in (("male", 25, 1.77, 1.393), ("female", 35, 1.64, 1.415)):
        assert norm_speed_m_s(sex, age, height_m, CONSTANTS) / CONSTANTS.peak_over_norm == pytest.approx(speed)
    ratio = norm_speed_m_s("male", 30, 1.98, CONSTANTS) / norm_speed_m_s("male", 30, 1.62, CONSTANTS)
    assert ratio == pytest.approx(np.sqrt(1.98 / 1.62))


def test_switching_dependencies_off_removes_them(training):
    off = without_dependency_effects(CONSTANTS)
    row = training.participants.iloc[0]
    tall, small = (person_from_row(_with(row, height_m), off) for height_m in (1.9, 1.6))
    assert tall.comfortable_speed_m_s == small.comfortable_speed_m_s
    assert (
        person_from_row(_with(row, 1.9), CONSTANTS).comfortable_speed_m_s
        > person_from_row(_with(row, 1.6), CONSTANTS).comfortable_speed_m_s
    )
    assert tall.turn_exponent == 0.0
    assert peak_speed_m_s(PERSON, 0.5, CONSTANTS) < 0.8 * peak_speed_m_s(PERSON, 4.0, CONSTANTS)
    assert peak_speed_m_s(PERSON, 0.5, off) == peak_speed_m_s(PERSON, 4.0, off)
    still = replace(PERSON, turn_exponent=0.0)
    np.testing.assert_array_equal(turn_slowing(circle(0.5), still.turn_exponent, off), 1.0)
    # The start-up of a short walk is that of a long one, merely broken off: the same mean acceleration.
    bells = [speed_profile(still, distance, distance, off, np.zeros(3)) for distance in (0.5, 1.0, 4.0)]
    np.testing.assert_allclose([bell.peak_m_s / bell.start_s for bell in bells], bells[0].peak_m_s / bells[0].start_s)
