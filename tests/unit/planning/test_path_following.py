"""Path following: closed forms, limits, convergence, and the sweep against its slow twins."""

from __future__ import annotations

import math

import numba
import numpy as np
import pytest
from following_reference import follow as reference
from hypothesis import given, settings
from hypothesis import strategies as st

from walklab.errors import InputError
from walklab.geometry.scene import State, Task
from walklab.planning import path_following
from walklab.planning.batch import pack_walks
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import Arrival, Planner, SweepingPlanner, WalkBatch

STEP_S = 1 / 60
CORNER = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
ZIGZAG = np.array([[0.0, 0.0], [1.5, 0.2], [2.0, 1.4], [3.6, 1.1], [4.0, 2.5]])
BACK = np.array([[0.0, 0.0], [1.5, 0.0], [0.2, 0.0]])
HAIRPIN = np.array([[0.0, 0.0], [1.5, 0.0], [0.2, 0.02]])
POLE = [[2 + 0.3 * math.sin(t), 0.3 - 0.3 * math.cos(t)] for t in np.linspace(0, 2.4, 7)]
AROUND_POLE = np.array([[0.0, 0.0], *POLE, [0.5, 1.9]])
ROUTES = [CORNER, ZIGZAG, HAIRPIN, AROUND_POLE]


def task_for(route: np.ndarray, heading: float | None = None, start_speed: float = 0.0, end_speed: float = 0.0) -> Task:
    return Task(State(tuple(route[0]), heading, start_speed), State(tuple(route[-1]), None, end_speed))


def straight(length_m: float) -> np.ndarray:
    return np.array([[0.3, -0.2], [0.3 + length_m * 0.6, -0.2 + length_m * 0.8]])


def speeds_of(positions: np.ndarray, step_s: float) -> np.ndarray:
    return np.hypot(*np.diff(positions, axis=0).T) / step_s


def test_is_a_sweeping_planner() -> None:
    assert isinstance(PathFollowing(), SweepingPlanner)
    assert isinstance(PathFollowing(), Planner)


@settings(max_examples=80, deadline=None)
@given(length=st.floats(0.3, 6), v=st.floats(0.1, 2), a=st.floats(0.1, 2), omega=st.floats(0.1, 2))
def test_straight_walk_takes_its_closed_form_time(length: float, v: float, a: float, omega: float) -> None:
    route = straight(length)
    walk = PathFollowing().follow(route, task_for(route), np.array([v, a, omega]), 200.0)
    expected = v / a + length / v if length >= v * v / a else 2 * math.sqrt(length / a)
    assert walk.arrival == Arrival.ARRIVED
    assert abs(walk.duration_s - expected) <= 2 * STEP_S
    assert np.allclose(walk.positions_m[-1], route[-1], atol=1e-9)


def test_straight_walk_with_its_own_braking_and_moving_ends() -> None:
    route, v, a, b = straight(4.0), 1.3, 0.8, 1.7
    planner = PathFollowing(("b", "v", "a"))
    standing = planner.follow(route, task_for(route), np.array([b, v, a]), 60.0)
    assert abs(standing.duration_s - (4 / v + v / (2 * a) + v / (2 * b))) <= 2 * STEP_S
    start, end = 0.9, 0.6
    moving = planner.follow(route, task_for(route, None, start, end), np.array([b, v, a]), 60.0)
    cruise = 4.0 - (v**2 - start**2) / (2 * a) - (v**2 - end**2) / (2 * b)
    assert abs(moving.duration_s - ((v - start) / a + cruise / v + (v - end) / b)) <= 2 * STEP_S
    assert speeds_of(moving.positions_m, STEP_S)[-2] == pytest.approx(end, abs=2 * b * STEP_S)
    fast = planner.follow(route, task_for(route, None, 2.0, v), np.array([b, v, a]), 60.0)
    assert np.diff(speeds_of(fast.positions_m, STEP_S)[:10]) == pytest.approx(-b * STEP_S)


def test_without_braking_it_keeps_its_speed_to_the_end() -> None:
    route = straight(3.0)
    walk = PathFollowing(braking=False).follow(route, task_for(route), np.array([1.2, 0.9, 1.0]), 60.0)
    assert abs(walk.duration_s - (3.0 / 1.2 + 1.2 / (2 * 0.9))) <= 2 * STEP_S
    assert speeds_of(walk.positions_m, STEP_S)[-2] == pytest.approx(1.2)


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("parameters", [(1.3, 1.1, 1.8), (1.99, 1.99, 0.31), (0.7, 0.5, 1.0)])
def test_limits_of_speed_acceleration_and_turning_hold_all_along(
    route: np.ndarray, parameters: tuple[float, float, float]
) -> None:
    v, a, omega = parameters
    walk = PathFollowing().follow(route, task_for(route), np.array(parameters), 60.0)
    steps = np.diff(walk.positions_m, axis=0)[:-1]  # the last step is cut at the end line
    travelled = np.hypot(*steps.T)
    # travelled is the mean of the speeds at a step's ends, so it obeys the same limits
    assert travelled.max() <= v * STEP_S * (1 + 1e-12)
    assert np.abs(np.diff(travelled)).max() <= a * STEP_S**2 * (1 + 1e-9)
    moving = travelled > 1e-6
    steps, travelled = steps[moving], travelled[moving]
    angles = np.arctan2(steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0], np.einsum("ij,ij->i", steps[:-1], steps[1:]))
    # a turn of omega * distance per step: no smaller radius than 1 / omega
    assert np.all(np.abs(angles) <= omega * travelled[1:] * (1 + 1e-6) + 1e-9)
    assert np.abs(angles).max() > 0.9 * omega * travelled.max()  # and the limit is used


def test_a_full_turn_has_the_radius_one_over_omega() -> None:
    # Facing away from a far end, the walker turns as sharply as it may: half a circle.
    route, omega = np.array([[0.0, 0.0], [30.0, 0.0]]), 0.8
    walk = PathFollowing(step_s=1 / 600).follow(route, task_for(route, math.pi), np.array([1.5, 1.5, omega]), 8.0)
    farthest = np.argmin(walk.positions_m[:, 0])
    assert walk.positions_m[farthest, 0] == pytest.approx(-1 / omega, rel=2e-3)
    assert abs(walk.positions_m[farthest, 1]) == pytest.approx(1 / omega, rel=2e-3)


def test_an_agent_at_rest_cannot_turn() -> None:
    route = np.array([[0.0, 0.0], [3.0, 0.0]])
    first = PathFollowing().follow(route, task_for(route, 1.0), np.array([1.0, 1.0, 2.0]), 0.1).positions_m[1]
    assert math.atan2(first[1], first[0]) == pytest.approx(1.0, abs=2.0 * STEP_S**2)
    at_once = PathFollowing(("v", "a")).follow(route, task_for(route, 1.0), np.array([1.0, 1.0]), 0.1).positions_m[1]
    assert at_once[1] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("route", [CORNER, ZIGZAG])
def test_halving_the_step_halves_the_error(route: np.ndarray) -> None:
    def at_two_seconds(steps_per_s: int) -> np.ndarray:
        walk = PathFollowing(step_s=1 / steps_per_s).follow(route, task_for(route), np.array([1.3, 1.1, 1.8]), 2.0)
        return walk.positions_m[2 * steps_per_s]

    exact = at_two_seconds(60 * 256)
    errors = [np.hypot(*(at_two_seconds(60 * 2**k) - exact)) for k in range(6)]
    assert errors[0] < 0.02
    # a least-squares order of about one, or better
    order = -np.polyfit(range(6), np.log2(errors), 1)[0]
    assert order > 0.8


@settings(max_examples=60, deadline=None)
@given(
    which=st.integers(0, len(ROUTES) - 1),
    v=st.floats(0.1, 2),
    a=st.floats(0.1, 2),
    omega=st.one_of(st.floats(0.1, 2), st.floats(5, 400), st.just(math.inf)),
    b=st.floats(0.2, 3),
    heading=st.one_of(st.none(), st.floats(-3, 3)),
    start_speed=st.sampled_from([0.0, 0.8]),
    end_speed=st.sampled_from([0.0, 0.7]),
)
def test_follow_equals_the_plain_reference(which, v, a, omega, b, heading, start_speed, end_speed) -> None:
    route = ROUTES[which]
    planner = PathFollowing(("v", "a", "omega", "b"))
    walk = planner.follow(route, task_for(route, heading, start_speed, end_speed), np.array([v, a, omega, b]), 6.0)
    slow = reference(
        route, v, a, omega, b, step_s=STEP_S, look_ahead_m=planner.look_ahead_m, frames=len(walk.positions_m),
        heading=heading, start_speed=start_speed, end_speed=end_speed,
    )  # fmt: skip
    assert np.allclose(walk.positions_m, slow, atol=1e-7)
    # rounding grows where a walker turns on the spot, so most frames are held far tighter
    assert np.median(np.abs(walk.positions_m - slow)) < 1e-9


def test_ends_are_told_apart() -> None:
    planner = PathFollowing()
    good = planner.follow(CORNER, task_for(CORNER), np.array([1.0, 1.0, 1.99]), 60.0)
    assert good.arrival == Arrival.ARRIVED
    assert np.hypot(*(good.positions_m[-1] - CORNER[-1])) <= planner.arrival_radius_m
    wide = planner.follow(CORNER, task_for(CORNER), np.array([1.0, 1.0, 0.31]), 60.0)
    assert wide.arrival == Arrival.PASSED
    assert wide.positions_m[-1, 1] == pytest.approx(2.0)  # abreast of the end ...
    assert wide.positions_m[-1, 0] > 2.1  # ... but out of reach
    short = planner.follow(CORNER, task_for(CORNER), np.array([1.0, 1.0, 1.99]), 1.5)
    assert short.arrival == Arrival.TIMEOUT
    assert short.duration_s == pytest.approx(1.5)


@pytest.mark.parametrize("route", [*ROUTES, BACK])
def test_no_agent_loops_for_ever(route: np.ndarray) -> None:
    planner = PathFollowing()
    for omega in (0.1, 0.31, 0.73, 1.36, 50.0, math.inf):
        for v in (0.31, 1.15, 1.99):
            circle_s = 2 * math.pi / omega / v
            walk = planner.follow(route, task_for(route), np.array([v, 1.0, omega]), 20 * circle_s + 200)
            assert walk.arrival != Arrival.TIMEOUT
            assert walk.duration_s < 2 * circle_s + 40 / v


def captured_batch() -> WalkBatch:
    rng = np.random.default_rng(1)
    routes = [*ROUTES, straight(1.1), straight(3.0)]
    positions = []
    for route in routes:
        frames = int(rng.integers(60, 300))
        leg = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(route, axis=0).T))])
        at = leg[-1] * (1 - np.cos(np.linspace(0, np.pi, frames))) / 2
        positions.append(np.column_stack([np.interp(at, leg, route[:, k]) for k in (0, 1)]) + rng.normal(0, 0.02, (frames, 2)))
    starts, ends = [0, 0, 0.5, 0, 0, 1.2], [0, 0.7, 0, 0, 0, 0.9]
    return pack_walks(positions, routes, starts, ends, rng.uniform(1, 5, len(routes)), STEP_S)


def brute_force(planner: PathFollowing, batch: WalkBatch, cells: np.ndarray) -> np.ndarray:
    """m_Euclid from whole simulated walks."""
    scores = np.empty((len(batch), len(cells)))
    for i in range(len(batch)):
        route = batch.routes_m[batch.route_offsets[i] : batch.route_offsets[i + 1]]
        captured = batch.captured_m[batch.captured_offsets[i] : batch.captured_offsets[i + 1]]
        task = task_for(route, None, batch.start_speeds_m_s[i], batch.end_speeds_m_s[i])
        for j, cell in enumerate(cells):
            simulated = planner.follow(route, task, cell, 30.0).positions_m
            simulated = simulated[np.minimum(np.arange(len(captured)), len(simulated) - 1)]
            scores[i, j] = np.hypot(*(captured - simulated).T).sum() * batch.step_s / batch.lengths_m[i]
    return scores


@pytest.mark.parametrize(
    ("names", "options"),
    [
        (("v", "a", "omega"), {}),
        (("v", "a"), {}),
        (("a", "v"), {"fixed": {"omega": 1.2}}),
        (("b", "omega", "a", "v"), {"braking": True}),
        (("v", "a", "omega"), {"braking": False, "turn_law": "constant"}),
    ],
)
def test_sweep_equals_following_every_walk(names: tuple[str, ...], options: dict) -> None:
    planner, batch = PathFollowing(names, **options), captured_batch()
    cells = np.random.default_rng(2).uniform(0.1, 2.0, (40, len(names)))
    slow = brute_force(planner, batch, cells)
    one_by_one = np.concatenate([planner.sweep_euclid(batch, few) for few in np.split(cells, 4)], axis=1)
    assert np.allclose(one_by_one, slow, rtol=0, atol=1e-9)
    in_lanes = planner.sweep_euclid(batch, cells)
    assert in_lanes.shape == (len(batch), 40)
    assert np.allclose(in_lanes, slow, rtol=2e-5, atol=2e-5)


@pytest.mark.parametrize("count", [5, 50])  # in double precision and in lanes
def test_sweep_does_not_depend_on_threads_or_shards(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    planner, batch = PathFollowing(), captured_batch()
    cells = np.random.default_rng(3).uniform(0.1, 2.0, (count, 3))
    alone = planner.sweep_euclid(batch, cells)
    monkeypatch.setattr(path_following, "THREADED_STEPS", 0)
    for threads in range(1, numba.config.NUMBA_NUM_THREADS + 1):
        before = numba.get_num_threads()
        numba.set_num_threads(threads)
        try:
            assert np.array_equal(planner.sweep_euclid(batch, cells), alone)
        finally:
            numba.set_num_threads(before)
    routes = np.split(batch.routes_m, batch.route_offsets[1:-1])
    walks = np.split(batch.captured_m, batch.captured_offsets[1:-1])
    args = (batch.start_speeds_m_s, batch.end_speeds_m_s, batch.lengths_m)
    shards = [pack_walks(walks[k : k + 2], routes[k : k + 2], *(x[k : k + 2] for x in args), STEP_S) for k in range(0, 6, 2)]
    assert np.array_equal(np.concatenate([planner.sweep_euclid(shard, cells) for shard in shards]), alone)


def test_fixed_equals_the_same_value_as_parameter() -> None:
    three = PathFollowing(("v", "a", "omega")).follow(ZIGZAG, task_for(ZIGZAG), np.array([1.1, 0.9, 1.4]), 20)
    two = PathFollowing(("a", "v"), fixed={"omega": 1.4}).follow(ZIGZAG, task_for(ZIGZAG), np.array([0.9, 1.1]), 20)
    four = PathFollowing(("omega", "b", "a", "v")).follow(ZIGZAG, task_for(ZIGZAG), np.array([1.4, 0.9, 0.9, 1.1]), 20)
    assert np.array_equal(three.positions_m, two.positions_m)
    assert np.array_equal(three.positions_m, four.positions_m)


def test_a_route_without_extent_has_arrived() -> None:
    route = np.array([[1.0, 2.0], [1.0, 2.0]])
    walk = PathFollowing().follow(route, task_for(route), np.array([1.0, 1.0, 1.0]), 5.0)
    assert walk.arrival == Arrival.ARRIVED
    assert np.array_equal(walk.positions_m, [[1.0, 2.0]])
    batch = pack_walks([np.array([[1.0, 2.0], [1.0, 2.5]])], [route], [0], [0], [0.5], STEP_S)
    assert PathFollowing().sweep_euclid(batch, np.ones((1, 3)))[0, 0] == pytest.approx(0.5 * STEP_S / 0.5)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: PathFollowing(("v", "a", "w")), "unknown parameter 'w'"),
        (lambda: PathFollowing(("v",)), "no value for a"),
        (lambda: PathFollowing(("v", "a"), fixed={"a": 1.0}), "a given twice"),
        (lambda: PathFollowing(turn_law="linear"), "unknown turn_law 'linear'"),
        (lambda: PathFollowing(look_ahead_m=0.0), "look_ahead_m is 0.0"),
        (lambda: PathFollowing().follow(CORNER, task_for(CORNER), np.array([1.0, 0.0, 1.0]), 1.0), "parameter a is 0.0"),
        (
            lambda: PathFollowing().follow(CORNER, task_for(CORNER), np.array([1.0, 1.0]), 1.0),
            "2 values for the parameters v, a, omega",
        ),
        (lambda: PathFollowing(step_s=0.01).sweep_euclid(captured_batch(), np.ones((1, 3))), "resample"),
    ],
)
def test_bad_input_is_named(build, message: str) -> None:
    with pytest.raises(InputError, match=message):
        build()


@pytest.mark.parametrize("route", ROUTES)
def test_a_walk_that_ends_within_a_radius_is_the_same_walk_cut_there(route: np.ndarray) -> None:
    """Up to its end it goes as before, and it ends with its first step into the radius."""
    values, radius_m = np.array([1.1, 0.9, 1.8]), 0.25
    whole = PathFollowing().follow(route, task_for(route), values, 60.0).positions_m
    cut = PathFollowing(ends_at="radius", arrival_radius_m=radius_m).follow(route, task_for(route), values, 60.0)
    away = np.hypot(*(cut.positions_m - route[-1]).T)
    assert np.array_equal(cut.positions_m, whole[: len(cut.positions_m)])
    assert cut.arrival == Arrival.ARRIVED
    assert away[-1] <= radius_m < away[-2]
    assert len(cut.positions_m) < len(whole)


def test_passing_by_the_end_on_the_way_there_is_no_arrival() -> None:
    """A route that runs past its own end: 0.1 m from it after half a metre, with 3 m still to go."""
    route = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.1], [0.5, 0.1]])
    walk = PathFollowing(ends_at="radius", arrival_radius_m=0.15).follow(route, task_for(route), np.array([1.0, 1.0, 20.0]), 60.0)
    assert walk.duration_s > 2.5
    assert walk.arrival == Arrival.ARRIVED


def test_unknown_end_of_a_walk_is_refused() -> None:
    with pytest.raises(InputError, match="unknown ends_at 'wall'; known are line, radius"):
        PathFollowing(ends_at="wall")
