"""The relaxation model against its exact solution."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from walklab.errors import InputError
from walklab.geometry.scene import State, Task
from walklab.planning.protocol import Arrival
from walklab.planning.social_force import SocialForce

STEP_S = 1 / 60


def walk(route: np.ndarray, v: float, tau: float, limit_s: float = 60.0):
    task = Task(State(tuple(route[0])), State(tuple(route[-1])))
    return SocialForce().follow(route, task, np.array([v, tau]), limit_s)


@settings(max_examples=40, deadline=None)
@given(v=st.floats(0.2, 2), tau=st.floats(0.05, 2))
def test_straight_walk_approaches_its_speed_exponentially(v: float, tau: float) -> None:
    trajectory = walk(np.array([[0.0, 0.0], [30.0, 40.0]]), v, tau, 5.0)
    t = np.arange(len(trajectory.positions_m)) * STEP_S
    travelled = v * (t - tau * (1 - np.exp(-t / tau)))
    assert np.allclose(trajectory.positions_m, travelled[:, None] * [0.6, 0.8], atol=1e-9)


def test_it_arrives_around_a_corner_and_stays_near_the_route() -> None:
    route = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    trajectory = walk(route, 1.2, 0.3)
    assert trajectory.arrival == Arrival.ARRIVED
    assert trajectory.positions_m[-1] == pytest.approx([2.0, 2.0], abs=0.1)
    off = np.minimum(np.abs(trajectory.positions_m[:, 1]), np.abs(trajectory.positions_m[:, 0] - 2.0))
    assert off.max() < 0.3
    # a longer relaxation swings out wider
    wider = walk(route, 1.2, 1.0).positions_m
    assert wider[:, 0].max() > trajectory.positions_m[:, 0].max() > 2.0


def test_time_limit_and_order_of_parameters() -> None:
    route = np.array([[0.0, 0.0], [5.0, 0.0]])
    assert walk(route, 1.0, 0.5, 1.0).arrival == Arrival.TIMEOUT
    swapped = SocialForce(("tau", "v")).follow(route, Task(State((0, 0)), State((5, 0))), np.array([0.5, 1.0]), 9.0)
    assert np.array_equal(swapped.positions_m, walk(route, 1.0, 0.5, 9.0).positions_m)


def test_a_parameter_without_sense_is_named() -> None:
    with pytest.raises(InputError, match="parameter tau is -1"):
        walk(np.array([[0.0, 0.0], [5.0, 0.0]]), 1.0, -1.0)
