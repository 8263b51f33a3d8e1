"""Traces of all cells are the walks that ``follow`` returns, one by one."""

from __future__ import annotations

import numpy as np
import pytest

from walklab.errors import InputError
from walklab.geometry.scene import State, Task
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import Arrival
from walklab.planning.tracing import trace_cells

STANDING_M_S, LIMIT_S = 0.05, 25.0
ROUTES = [
    np.array([[0.0, 0.0], [2.1, 0.3]]),
    np.array([[1.0, 1.0], [2.0, 1.0], [2.0, 2.2]]),
    np.array([[0.0, 0.0], [0.2, 0.0], [0.4, 0.1], [0.5, 0.3], [0.5, 1.9]]),
]
CELLS = np.array([[v, a, omega] for v in (0.1, 0.73, 1.36, 1.99) for a in (0.1, 0.7, 1.9) for omega in (0.1, 1.3, 2.0)])


def tasks(start_speed_m_s: float) -> list[Task]:
    return [
        Task(State(tuple(route[0]), None, start_speed_m_s), State(tuple(route[-1]), None, start_speed_m_s)) for route in ROUTES
    ]


@pytest.mark.parametrize("start_speed_m_s", [0.0, 0.9])
@pytest.mark.parametrize("turn_law", ["proportional", "constant"])
def test_traces_are_the_walks_of_follow(start_speed_m_s: float, turn_law: str) -> None:
    planner = PathFollowing(turn_law=turn_law)
    times_s = np.tile([0.0, 0.5, 1.5, 4.0, 30.0], (3, 1))
    traces = trace_cells(planner, ROUTES, tasks(start_speed_m_s), CELLS, times_s, STANDING_M_S, LIMIT_S)
    timeouts = 0
    for walk, (route, task) in enumerate(zip(ROUTES, tasks(start_speed_m_s), strict=True)):
        for cell, values in enumerate(CELLS):
            trajectory = planner.follow(route, task, values, LIMIT_S)
            timeout = trajectory.arrival == Arrival.TIMEOUT
            timeouts += timeout
            expected_s = LIMIT_S if timeout else trajectory_travel_time_s(trajectory, task, STANDING_M_S)
            # A speed that equals the threshold may round to either side: one step.
            assert abs(traces.travel_s[walk, cell] - expected_s) <= planner.step_s + 1e-4
            assert traces.arrived[walk, cell] == (trajectory.arrival == Arrival.ARRIVED)
            frames = np.minimum(np.rint(times_s[walk] / planner.step_s).astype(int), len(trajectory.positions_m) - 1)
            np.testing.assert_allclose(traces.places_m[walk, cell], trajectory.positions_m[frames], atol=1e-3)
    assert timeouts > 0  # else the limit was not tried


def test_few_cells_go_one_by_one_and_give_the_same() -> None:
    """Fewer cells than a vector holds do not go in lanes."""
    planner, times_s = PathFollowing(), np.tile([1.0, 2.0], (3, 1))
    many = trace_cells(planner, ROUTES, tasks(0.0), CELLS, times_s, STANDING_M_S, LIMIT_S)
    few = trace_cells(planner, ROUTES, tasks(0.0), CELLS[20:24], times_s, STANDING_M_S, LIMIT_S)
    np.testing.assert_allclose(few.travel_s, many.travel_s[:, 20:24], atol=planner.step_s + 1e-4)
    np.testing.assert_allclose(few.places_m, many.places_m[:, 20:24], atol=1e-3)


def test_unequal_lists_are_refused() -> None:
    with pytest.raises(InputError, match="2 rows of times"):
        trace_cells(PathFollowing(), ROUTES, tasks(0.0), CELLS, np.ones((2, 1)), STANDING_M_S, LIMIT_S)


@pytest.mark.parametrize("start_speed_m_s", [0.0, 0.9])
def test_walks_that_end_within_a_radius_are_those_of_follow(start_speed_m_s: float) -> None:
    planner = PathFollowing(ends_at="radius", arrival_radius_m=0.2)
    times_s = np.tile([0.0, 1.5, 30.0], (3, 1))
    traces = trace_cells(planner, ROUTES, tasks(start_speed_m_s), CELLS, times_s, STANDING_M_S, LIMIT_S)
    for walk, (route, task) in enumerate(zip(ROUTES, tasks(start_speed_m_s), strict=True)):
        for cell, values in enumerate(CELLS):
            trajectory = planner.follow(route, task, values, LIMIT_S)
            timeout = trajectory.arrival == Arrival.TIMEOUT
            expected_s = LIMIT_S if timeout else trajectory_travel_time_s(trajectory, task, STANDING_M_S)
            assert traces.travel_s[walk, cell] == pytest.approx(expected_s, abs=1e-4)
            assert traces.arrived[walk, cell] == (trajectory.arrival == Arrival.ARRIVED)
            frames = np.minimum(np.rint(times_s[walk] / planner.step_s).astype(int), len(trajectory.positions_m) - 1)
            np.testing.assert_allclose(traces.places_m[walk, cell], trajectory.positions_m[frames], atol=1e-6)
