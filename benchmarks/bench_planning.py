"""Speed of the planner, each part beside a plain baseline: ``pytest benchmarks/bench_planning.py`` (needs pytest-benchmark)
or ``python benchmarks/bench_planning.py``.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numba
import numpy as np
from shapely import box

from walklab.geometry.scene import Scene, State, Task
from walklab.planning.batch import pack_walks
from walklab.planning.grid import build_grid
from walklab.planning.lazy_theta_star import lazy_theta_star
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import WalkBatch

HALL = Scene("hall", {"left": box(3, 1, 4, 8), "right": box(6, -1, 7, 6.2)})
START, GOAL = (0.5, 4.0), (9.5, 4.0)
FRAMES = 180


def walks(count: int) -> WalkBatch:
    """Walks of 3 s with one corner each."""
    angles = np.linspace(0, np.pi * 0.75, count)
    routes = [np.array([[0, 0], [1.5, 0], [1.5 + 1.5 * np.cos(t), 1.5 * np.sin(t)]]) for t in angles]
    captured = [np.linspace(route[0], route[-1], FRAMES) for route in routes]
    return pack_walks(captured, routes, np.zeros(count), np.zeros(count), np.full(count, 3.0), 1 / 60)


def cells() -> np.ndarray:
    """The parameter space of the paper, eq. 6-9."""
    values = 0.1 + 0.21 * np.arange(10)
    return np.stack(np.meshgrid(values, values, values, indexing="ij"), -1).reshape(-1, 3)


def sweep(batch: WalkBatch) -> np.ndarray:
    return PathFollowing().sweep_euclid(batch, cells())


def follow_each(batch: WalkBatch, every: int) -> None:
    """The baseline of the sweep: whole trajectories, one call each."""
    planner, route = PathFollowing(), batch.routes_m[: batch.route_offsets[1]]
    task = Task(State(tuple(route[0])), State(tuple(route[-1])))
    for cell in cells()[::every]:
        planner.follow(route, task, cell, FRAMES / 60)


def test_route_around_two_boxes(benchmark) -> None:
    grid = build_grid(HALL, 0.25, [START, GOAL])
    assert len(benchmark(lazy_theta_star, grid, START, GOAL)) > 2


def test_route_in_sight(benchmark) -> None:
    grid = build_grid(HALL, 0.25, [START, GOAL])
    assert len(benchmark(lazy_theta_star, grid, START, (2.0, 5.0))) == 2


def test_build_grid(benchmark) -> None:
    assert benchmark(build_grid, HALL, 0.25, [START, GOAL]).clearance_cells.size > 800_000


def test_sweep_of_ten_walks(benchmark) -> None:
    assert benchmark(sweep, walks(10)).shape == (10, 1000)


def test_following_one_walk_in_a_tenth_of_the_cells(benchmark) -> None:
    benchmark(follow_each, walks(1), 10)


def least_s(work: Callable[[], object], rounds: int = 10) -> float:
    work()
    times = []
    for _ in range(rounds):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def main() -> None:
    """Print CPU times; the least of ten rounds."""
    numba.set_num_threads(1)
    grid = build_grid(HALL, 0.25, [START, GOAL])
    print(
        f"build grid, {grid.clearance_cells.size} vertices: {1e3 * least_s(lambda: build_grid(HALL, 0.25, [START, GOAL])):.1f} ms"
    )
    print(f"route around two boxes: {1e3 * least_s(lambda: lazy_theta_star(grid, START, GOAL)):.1f} ms")
    print(f"route in sight: {1e3 * least_s(lambda: [lazy_theta_star(grid, START, (2.0, 5.0)) for _ in range(100)]) / 100:.3f} ms")
    batch = walks(40)
    print(f"sweep: {1e9 * least_s(lambda: sweep(batch)) / (40 * 1000 * (FRAMES - 1)):.1f} ns per agent-step")
    print(f"follow: {1e9 * least_s(lambda: follow_each(batch, 10)) / (100 * (FRAMES - 1)):.1f} ns per agent-step")


if __name__ == "__main__":
    main()
