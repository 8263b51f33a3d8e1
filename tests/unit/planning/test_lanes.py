"""The single-precision lanes against the plain double-precision walkers, on random routes, walks, parameters and options."""

from __future__ import annotations

import math

import llvmlite.binding
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from walklab.planning import lane_kernel
from walklab.planning.batch import pack_walks
from walklab.planning.path_following import LANE_CELLS, PathFollowing
from walklab.planning.protocol import WalkBatch

STEP_S = 1 / 60
NAMES = ("v", "a", "omega", "b")

# Mean over time of the distance between a walker in single and in double precision. Of random cells half are within 2e-7 m, 999
# in 1000 within 7e-6 m; walkers that miss the end by far and come round again enlarge a rounding to 1e-4 m.
BOUND_M = 2e-4
TYPICAL_M = 5e-6
# The planner itself jumps at some parameters: a walker inside a corner, equally near to two legs, or with its target right
# behind, goes one way or the other on a rounding. That is one cell in some ten thousand.
JUMPS = 1


def one_by_one(planner: PathFollowing, batch: WalkBatch, cells: np.ndarray) -> np.ndarray:
    """Scores in double precision: so few cells at a time that no lanes are used."""
    few = LANE_CELLS - 1
    return np.concatenate([planner.sweep_euclid(batch, cells[k : k + few]) for k in range(0, len(cells), few)], axis=1)


def random_walk(rng: np.random.Generator, legs: int, shortest_m: float, start_m: float, speeds: tuple[float, float]) -> WalkBatch:
    """A route of random legs with turns of up to 150 degrees and somebody who walked along it."""
    lengths = rng.uniform(shortest_m, shortest_m + 1.5, legs)
    headings = rng.uniform(-math.pi, math.pi) + np.concatenate([[0.0], np.cumsum(rng.uniform(-2.6, 2.6, legs - 1))])
    steps = lengths[:, None] * np.column_stack([np.cos(headings), np.sin(headings)])
    route = start_m + np.concatenate([[[0.0, 0.0]], np.cumsum(steps, axis=0)])
    frames = int(rng.integers(2, 400))
    along = lengths.sum() * (1 - np.cos(np.linspace(0, math.pi, frames))) / 2
    at = np.concatenate([[0.0], np.cumsum(lengths)])
    walked = np.column_stack([np.interp(along, at, route[:, k]) for k in (0, 1)]) + rng.normal(0, 0.02, (frames, 2))
    return pack_walks([walked], [route], [speeds[0]], [speeds[1]], [lengths.sum()], STEP_S)


def random_cells(rng: np.random.Generator, count: int, omega: str, repeated: bool) -> np.ndarray:
    turning = {"paper": rng.uniform(0.1, 2, count), "sharp": rng.uniform(5, 400, count), "endless": np.full(count, math.inf)}
    cells = np.column_stack([rng.uniform(0.1, 2, count), rng.uniform(0.1, 2, count), turning[omega], rng.uniform(0.2, 3, count)])
    if repeated:  # equal but for omega, as in a grid
        cells[:, [0, 1, 3]] = cells[rng.integers(0, 5, count)][:, [0, 1, 3]]
    return cells


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    legs=st.integers(1, 9),
    shortest=st.sampled_from([0.02, 0.3]),
    start=st.sampled_from([0.0, -80.0]),
    speeds=st.tuples(st.sampled_from([0.0, 0.8, 2.5]), st.sampled_from([0.0, 0.7])),
    omega=st.sampled_from(["paper", "sharp", "endless"]),
    repeated=st.booleans(),
    count=st.sampled_from([17, 64, 300]),
    braking=st.booleans(),
    turn_law=st.sampled_from(["proportional", "constant"]),
)
def test_lanes_equal_double_precision(seed, legs, shortest, start, speeds, omega, repeated, count, braking, turn_law) -> None:
    rng = np.random.default_rng(seed)
    planner = PathFollowing(NAMES, braking=braking, turn_law=turn_law)
    batch = random_walk(rng, legs, shortest, start, speeds)
    cells = random_cells(rng, count, omega, repeated)
    lanes, plain = planner.sweep_euclid(batch, cells), one_by_one(planner, batch, cells)
    duration_s = len(batch.captured_m) * STEP_S
    apart_m = np.abs(lanes - plain)[0] * batch.lengths_m[0] / duration_s
    assert np.sum(apart_m > BOUND_M) <= JUMPS
    assert np.median(apart_m) <= TYPICAL_M
    # the best cell is the best, or within the bound of it
    bound_s = BOUND_M * duration_s / batch.lengths_m[0]
    assert plain[0, lanes[0].argmin()] <= plain.min() + 2 * bound_s


def test_the_best_cell_of_the_papers_grid_is_the_same() -> None:
    """Unless the runner-up in double precision is as good as the best within what single precision rounds."""
    values = 0.1 + 0.21 * np.arange(10)
    cells = np.stack(np.meshgrid(values, values, values, indexing="ij"), axis=-1).reshape(-1, 3)
    planner, same = PathFollowing(), 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        batch = random_walk(rng, int(rng.integers(1, 7)), 0.3, 0.0, (0.0, 0.0))
        lanes, plain = planner.sweep_euclid(batch, cells)[0], one_by_one(planner, batch, cells)[0]
        best = int(lanes.argmin())
        same += best == plain.argmin()
        tied_m = (plain[best] - plain.min()) * batch.lengths_m[0] / (len(batch.captured_m) * STEP_S)
        assert tied_m <= TYPICAL_M
    assert same >= 57


def test_where_a_lane_jumps_the_planner_itself_jumps() -> None:
    """The one cell in 120 walks of the paper's grid that is off by more than the bound: in double precision, too, parameters
    that differ by less than single precision can tell go either way."""
    rng = np.random.default_rng(13)
    planner, batch = PathFollowing(), random_walk(rng, int(rng.integers(1, 7)), 0.3, 0.0, (0.0, 0.0))
    cell = np.array([1.78, 1.36, 1.57])
    metres = batch.lengths_m[0] / (len(batch.captured_m) * STEP_S)
    lane = planner.sweep_euclid(batch, np.tile(cell, (LANE_CELLS, 1)))[0, 0] * metres
    near = one_by_one(planner, batch, cell * (1 + rng.normal(0, 3e-7, (400, 3))))[0] * metres
    assert np.ptp(near) > BOUND_M
    assert np.abs(near - lane).min() <= TYPICAL_M


@pytest.mark.parametrize(("names", "fixed"), [(("omega", "v"), {"a": 0.9}), (("a", "v"), {}), (("v",), {"a": 1.1, "omega": 0.8})])
def test_any_parameters_may_be_swept(names: tuple[str, ...], fixed: dict[str, float]) -> None:
    rng = np.random.default_rng(7)
    planner, batch = PathFollowing(names, fixed=fixed), random_walk(rng, 4, 0.3, 0.0, (0.0, 0.0))
    cells = rng.uniform(0.2, 1.8, (200, len(names)))
    assert np.allclose(planner.sweep_euclid(batch, cells), one_by_one(planner, batch, cells), rtol=0, atol=1e-4)


def test_a_score_does_not_depend_on_its_place_or_company() -> None:
    rng = np.random.default_rng(8)
    planner, batch = PathFollowing(), random_walk(rng, 5, 0.1, 0.0, (0.0, 0.0))
    cells = random_cells(rng, 700, "paper", True)[:, :3]
    whole = planner.sweep_euclid(batch, cells)[0]
    order = rng.permutation(700)
    assert np.array_equal(planner.sweep_euclid(batch, cells[order])[0], whole[order])
    assert np.array_equal(planner.sweep_euclid(batch, cells[:40])[0], whole[:40])


def test_what_single_precision_cannot_do_is_done_in_double() -> None:
    rng, cells = np.random.default_rng(9), np.full((20, 3), 1.0)
    near, far = random_walk(rng, 3, 0.3, 0.0, (0.0, 0.0)), random_walk(rng, 3, 60.0, 0.0, (0.0, 0.0))
    planner = PathFollowing()
    values = planner.kernel_parameters(cells)
    speeds = np.array([0.0, 0.0, 20.0]), np.zeros(3)
    assert list(planner.in_lanes(values, speeds, np.array([5.0, 200.0, 5.0]))) == [True, False, False]
    assert not planner.in_lanes(values[:5], speeds, np.full(3, 5.0)).any()
    assert not planner.in_lanes(values * [1, 1, 1, 500], speeds, np.full(3, 5.0)).any()
    both = pack_walks(
        [near.captured_m, far.captured_m],
        [near.routes_m, far.routes_m],
        [0, 0],
        [0, 0],
        [near.lengths_m[0], far.lengths_m[0]],
        STEP_S,
    )
    scores = planner.sweep_euclid(both, cells)
    assert np.array_equal(scores[0], planner.sweep_euclid(near, cells)[0])
    assert np.array_equal(scores[1, :5], planner.sweep_euclid(far, cells[:5])[0])


def test_the_loops_over_walkers_are_packed_single_precision() -> None:
    lanes = lane_kernel.aligned(lane_kernel.ROWS * lane_kernel.LANES)
    legs = np.ones((2, 6), np.float32)
    single = np.float32
    walk = (single(1), single(1), single(0), single(0.3), single(STEP_S), True)
    loops = {
        "walk_straight": (lanes, 16, legs[0], legs[0], single(1), walk),
        "score_and_speed": (lanes, 16, single(0), single(0), legs, 0, walk),
        "look_along": (lanes, 16, legs, 1, walk),
        "turn_and_move": (lanes, 16, walk),
        "project": (lanes, 16, legs, 0, walk),
    }
    # Sixteen bytes wide where the processor knows nothing wider.
    wide = llvmlite.binding.get_host_cpu_features().get("avx", False)
    vectors = [("mulps", "ymm"), ("mulps", "zmm")] if wide else [("mulps", "xmm"), ("fmul", ".4s")]
    for name, arguments in loops.items():
        compiled = lane_kernel.njit(fastmath=lane_kernel.FLAGS, error_model="numpy")(getattr(lane_kernel, name).py_func)
        compiled(*arguments)
        assembly = next(iter(compiled.inspect_asm().values()))
        packed = [line for line in assembly.splitlines() if any(a in line and b in line for a, b in vectors)]
        assert packed, name
        assert "vfmadd" not in assembly, name
