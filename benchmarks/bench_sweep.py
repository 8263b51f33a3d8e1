"""Speed of the sweep: an agent-step of the lanes beside the same algorithm in a plain compiled loop and in plain Python, and
beside a step of one agent in two crowd simulators.

The simulators (pyrvo, jupedsim) live in an environment of their own, ``.venv/peers``. A step counts only if it was integrated and
scored: for the lanes, walkers that differ in omega alone count once until their first turn; a walker that has ended counts no
more. CPU times on one thread.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numba
import numpy as np
from case import Case, Work, least_s
from numba import njit

from walklab.planning.batch import pack_walks
from walklab.planning.following_kernel import AT_END, standing_at_start, step, sweep
from walklab.planning.lane_kernel import group_cells, sweep_lanes
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import WalkBatch
from walklab.planning.routes import prepare_routes

PEERS = str(Path(__file__).resolve().parents[1] / ".venv/peers/bin/python")
WALKS = 1848
STEP_S = 1 / 60
PLANNER = PathFollowing()


def cells() -> np.ndarray:
    """The parameter space of the paper, eq. 6-9."""
    values = 0.1 + 0.21 * np.arange(10)
    return np.stack(np.meshgrid(values, values, values, indexing="ij"), -1).reshape(-1, 3)


def straight_route(rng: np.random.Generator) -> np.ndarray:
    return np.array([[0.0, 0.0], [rng.uniform(0.5, 4.0), 0.0]])


def route_around_a_corner(rng: np.random.Generator) -> np.ndarray:
    """Two straight legs and between them an arc of short ones, as a planner walks around a grown obstacle."""
    count = int(rng.integers(3, 15))
    turn, radius = rng.uniform(0.7, 3.1), rng.uniform(0.25, 0.6)
    angles = np.linspace(0, turn, count)
    arc = np.column_stack([rng.uniform(0.5, 1.8) + radius * np.sin(angles), radius * (1 - np.cos(angles))])
    end = arc[-1] + rng.uniform(0.3, 1.8) * np.array([np.cos(turn), np.sin(turn)])
    return np.vstack([[0.0, 0.0], arc, end])


def walked(route: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Positions of somebody who walks the route with a minimum-jerk profile, and its length."""
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(route, axis=0).T))])
    share = np.linspace(0, 1, int(60 * (0.7 + at[-1] / rng.uniform(0.8, 1.4))))
    along = at[-1] * share**3 * (10 - 15 * share + 6 * share**2)
    sway = 0.02 * np.sin(np.linspace(0, 4 * at[-1], len(share)))
    return np.column_stack([np.interp(along, at, route[:, 0]), np.interp(along, at, route[:, 1]) + sway]), at[-1]


def walks(count: int) -> WalkBatch:
    """As in the training of the study: five in eight walks straight, the others around corners of 2 to 14 legs."""
    rng = np.random.default_rng(1)
    routes = [straight_route(rng) if index % 8 < 5 else route_around_a_corner(rng) for index in range(count)]
    captured, lengths = zip(*[walked(route, rng) for route in routes], strict=True)
    return pack_walks(captured, routes, np.zeros(count), np.zeros(count), lengths, STEP_S)


def packed(batch: WalkBatch) -> tuple:
    """What the compiled loops take before the cells."""
    routes, offsets = prepare_routes(batch.routes_m, batch.route_offsets)
    speeds = batch.start_speeds_m_s, batch.end_speeds_m_s
    return routes, offsets, batch.captured_m, batch.captured_offsets, speeds, batch.lengths_m, np.arange(len(batch))


@njit
def count_steps(routes, offsets, captured_offsets, values, groups, rule):
    """Steps of walkers under way: of all, and with the straight beginnings of a group of cells counted once."""
    every, once = 0, 0
    for walk in range(len(offsets) - 1):
        route, frames = routes[offsets[walk] : offsets[walk + 1]], captured_offsets[walk + 1] - captured_offsets[walk]
        corner = route[1, 2] if len(route) > 2 else np.inf
        for group in range(len(groups[1]) - 1):
            members = groups[0][groups[1][group] : groups[1][group + 1]]
            for index in range(len(members)):
                cell = values[members[index]]
                state = standing_at_start(route, route[0, 3], route[0, 4], 0.0)
                for _ in range(1, frames):
                    if state[8] == AT_END:
                        break
                    every += 1
                    once += index == 0 or state[7] + rule[0] > corner
                    state = step(route, state, (cell[0], cell[1], cell[2], cell[3]), 0.0, rule)
    return every, once


PLAIN_PYTHON = """
import math, sys, time
from types import SimpleNamespace
sys.path.insert(0, sys.argv[1])
import bench_sweep
from walklab.planning import following_kernel as kernel

class Table(dict):
    '''Rows that are read as an array is, but at the speed of plain Python.'''
    def __init__(self, rows):
        for i, row in enumerate(rows):
            for j, value in enumerate(row):
                self[i, j] = self[i - len(rows), j] = value
        self.shape = (len(rows), len(rows[0]))

kernel.np = SimpleNamespace(sqrt=math.sqrt, sin=math.sin, cos=math.cos, inf=math.inf, pi=math.pi)
batch, values = bench_sweep.walks(8), bench_sweep.PLANNER.kernel_parameters(bench_sweep.cells()[::29]).tolist()
routes, offsets, captured, ends, *_ = bench_sweep.packed(batch)
tables = [(Table(routes[a:b].tolist()), Table(captured[c:d].tolist()))
          for a, b, c, d in zip(offsets, offsets[1:], ends, ends[1:])]
times = []
for _ in range(3):
    start = time.process_time()
    for route, frames in tables:
        for cell in values:
            kernel.score_cell(route, frames, 0.0, 0.0, tuple(cell), bench_sweep.PLANNER.rule)
    times.append(time.process_time() - start)
values = bench_sweep.np.array(values)
groups = bench_sweep.group_cells(values)
print(min(times) / bench_sweep.count_steps(routes, offsets, ends, values, groups, bench_sweep.PLANNER.rule)[0])
"""

RVO = """
import pyrvo, time
simulator = pyrvo.RVOSimulator()
simulator.set_time_step(1 / 60)
simulator.set_agent_defaults(5.0, 10, 2.0, 2.0, 0.25, 1.5, (0.0, 0.0))
agent = simulator.add_agent((0.0, 0.0))
simulator.set_agent_pref_velocity(agent, (1.3, 0.0))
times = []
for _ in range(7):
    start = time.process_time()
    for _ in range(20_000):
        simulator.do_step()
    times.append((time.process_time() - start) / 20_000)
print(min(times))
"""

JUPEDSIM = """
import jupedsim, time
times = []
for _ in range(5):
    simulation = jupedsim.Simulation(
        model=jupedsim.CollisionFreeSpeedModel(), geometry=[(0, 0), (100, 0), (100, 4), (0, 4)], dt=1 / 60
    )
    end = simulation.add_exit_stage([(99, 0), (100, 0), (100, 4), (99, 4)])
    journey = simulation.add_journey(jupedsim.JourneyDescription([end]))
    simulation.add_agent(jupedsim.CollisionFreeSpeedModelAgentParameters(journey_id=journey, stage_id=end, position=(1, 2)))
    start = time.process_time()
    simulation.iterate(2000)
    times.append((time.process_time() - start) / 2000)
print(min(times))
"""


def printed_by(python: str, program: str, *arguments: str, **environment: str) -> float:
    """The number that a program prints last.

    Raises
    ------
    RuntimeError
        If it fails: the last line of its complaint.
    """
    command = [python, "-W", "ignore", "-c", program, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **environment}, check=False)
    if done.returncode:
        raise RuntimeError((done.stderr.splitlines() or ["no reason given"])[-1])
    return float(done.stdout.split()[-1])


@cache
def sweep_work() -> tuple[Callable[[], None], float, Callable[[], float]]:
    """A sweep in lanes, its agent-steps, and what one of the plain compiled loop costs (s)."""
    # 64 walks: enough for the mix, few enough for many rounds.
    batch, values = walks(64), PLANNER.kernel_parameters(cells())
    arguments, scores = packed(batch), np.empty((len(batch), len(values)))
    singles, groups = values.astype(np.float32), group_cells(values)
    every, once = count_steps(*arguments[:2], batch.captured_offsets, values, groups, PLANNER.rule)

    def lanes() -> None:
        sweep_lanes(*arguments, singles, group_cells(values), PLANNER.rule, scores)

    return lanes, once, lambda: least_s(lambda: sweep(*arguments, values, PLANNER.rule, scores), every)


def plain_python_s() -> float:
    return printed_by(sys.executable, PLAIN_PYTHON, os.path.dirname(os.path.abspath(__file__)), NUMBA_DISABLE_JIT="1")


def beside(name: str, baseline_s: Callable[[], float]) -> Callable[[], Work]:
    """Prepares the lanes beside a baseline."""

    def prepare() -> Work:
        lanes, steps, _ = sweep_work()
        return Work(lanes, steps, "ns/agent-step", baseline_s, name, factor=1e9)

    return prepare


def all_maps() -> Work:
    """All maps of the study, with all threads."""
    batch, space = walks(WALKS), cells()
    return Work(lambda: PLANNER.sweep_euclid(batch, space), 1, f"s, {numba.get_num_threads()} threads", rounds=7)


JUPEDSIM_NAME = "JuPedSim collision-free speed model, iterate(n), one agent"
CASES = [
    Case("sweep_vs_scalar", beside("the same in a plain compiled loop, double precision", lambda: sweep_work()[2]())),
    Case("sweep_vs_python", beside("the same in plain Python", plain_python_s)),
    Case("sweep_vs_rvo", beside("pyrvo do_step, one agent", lambda: printed_by(PEERS, RVO))),
    Case("sweep_vs_jupedsim", beside(JUPEDSIM_NAME, lambda: printed_by(PEERS, JUPEDSIM))),
    Case("maps_1848", all_maps, wall=True),
]
