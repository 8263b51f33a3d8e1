"""Durations of simulated walks by the thresholds of captured ones."""

from __future__ import annotations

import math

import numpy as np
import pytest

from walklab.geometry.scene import State, Task
from walklab.geometry.standing import travel_time_s
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import Arrival, Trajectory

STEP_S = 1 / 60
THRESHOLD = 0.05
ROUTE = np.array([[0.0, 0.0], [3.0, 0.0]])


def task(start_speed: float = 0.0, end_speed: float = 0.0) -> Task:
    return Task(State((0, 0), None, start_speed), State((3, 0), None, end_speed))


@pytest.mark.parametrize(("v", "a"), [(1.3, 0.8), (0.9, 1.9), (1.9, 0.3)])
def test_standing_to_standing_leaves_out_the_time_below_the_threshold(v: float, a: float) -> None:
    walk = PathFollowing().follow(ROUTE, task(), np.array([v, a, 1.0]), 60.0)
    whole = v / a + 3 / v if v * v / a <= 3 else 2 * math.sqrt(3 / a)
    expected = whole - 2 * THRESHOLD / a
    assert abs(trajectory_travel_time_s(walk, task(), THRESHOLD) - expected) <= 3 * STEP_S


def test_it_is_the_captured_measure_of_the_same_motion_with_standing_around_it() -> None:
    walk = PathFollowing().follow(ROUTE, task(), np.array([1.3, 0.8, 1.0]), 60.0)
    stand = np.concatenate([np.repeat(ROUTE[:1], 30, axis=0), walk.positions_m, np.repeat(walk.positions_m[-1:], 30, axis=0)])
    assert trajectory_travel_time_s(walk, task(), THRESHOLD) == pytest.approx(travel_time_s(stand, STEP_S, THRESHOLD))


def test_moving_ends_count_from_the_first_and_to_the_last_frame() -> None:
    moving = task(1.2, 1.2)
    walk = PathFollowing().follow(ROUTE, moving, np.array([1.2, 0.8, 1.0]), 60.0)
    assert trajectory_travel_time_s(walk, moving, THRESHOLD) == pytest.approx(walk.duration_s)
    assert abs(walk.duration_s - 3 / 1.2) <= STEP_S


def test_a_timeout_counts_to_the_time_limit() -> None:
    walk = PathFollowing().follow(ROUTE, task(), np.array([1.0, 1.0, 1.0]), 1.5)
    assert walk.arrival == Arrival.TIMEOUT
    assert abs(trajectory_travel_time_s(walk, task(), THRESHOLD) - (1.5 - THRESHOLD / 1.0)) <= 2 * STEP_S


def test_who_does_not_move_takes_no_time() -> None:
    still = Trajectory(np.zeros((1, 2)), STEP_S, Arrival.ARRIVED)
    assert trajectory_travel_time_s(still, task(), THRESHOLD) == 0.0
