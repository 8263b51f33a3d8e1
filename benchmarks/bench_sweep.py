"""Speed of the sweep: an agent-step of the lanes beside the same algorithm in a plain compiled loop and in plain Python, and
beside a step of one agent in two crowd simulators.

``python benchmarks/bench_sweep.py``; the simulators (pyrvo, jupedsim) are looked for in this interpreter, then in the one that
``WALKLAB_PEERS_PYTHON`` names. A step counts only if it was integrated and scored: for the lanes, walkers that differ in omega
alone count once until their first turn; a walker that has ended counts no more. CPU times on one thread, the least of several
rounds that take turns with the baseline's.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable

import numba
import numpy as np
from numba import njit

from walklab.planning.batch import pack_walks
from walklab.planning.following_kernel import AT_END, standing_at_start, step, sweep
from walklab.planning.lane_kernel import group_cells, sweep_lanes
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import WalkBatch
from walklab.planning.routes import prepare_routes

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
            kernel.score_cell(route, frames, 0.0, 0.0, tuple(cell), bench_sweep.PLANNER._rule)
    times.append(time.process_time() - start)
values = bench_sweep.np.array(values)
groups = bench_sweep.group_cells(values)
print(min(times) / bench_sweep.count_steps(routes, offsets, ends, values, groups, bench_sweep.PLANNER._rule)[0])
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


def peer_s(name: str, program: str) -> float | None:
    """Seconds a step of a simulator, if one of the interpreters has it."""
    reasons = []
    for python in filter(None, (sys.executable, os.environ.get("WALKLAB_PEERS_PYTHON"))):
        try:
            return printed_by(python, program)
        except RuntimeError as reason:
            reasons.append(f"{python}: {reason}")
    print(f"skipped {name}:", "; ".join(reasons))
    return None


def least_s(first: Callable[[], object], second: Callable[[], object], rounds: int = 9) -> tuple[float, float]:
    """CPU seconds of two works done in turns, the least of each."""
    times: tuple[list[float], list[float]] = [], []
    for round_ in range(rounds + 1):
        for work, spent in zip((first, second), times, strict=True):
            start = time.process_time()
            work()
            if round_:  # the first compiles
                spent.append(time.process_time() - start)
    return min(times[0]), min(times[1])


def agent_steps() -> tuple[float, float]:
    """Seconds an agent-step: in lanes, and in the plain compiled loop."""
    # 64 walks: enough for the mix, few enough for many rounds.
    batch, values = walks(64), PLANNER.kernel_parameters(cells())
    arguments, scores = packed(batch), np.empty((len(batch), len(values)))
    singles, groups = values.astype(np.float32), group_cells(values)
    every, once = count_steps(*arguments[:2], batch.captured_offsets, values, groups, PLANNER._rule)
    lanes_s, plain_s = least_s(
        lambda: sweep_lanes(*arguments, singles, group_cells(values), PLANNER._rule, scores),
        lambda: sweep(*arguments, values, PLANNER._rule, scores),
    )
    return lanes_s / once, plain_s / every


def maps_s(rounds: int = 7) -> float:
    """Wall time of all maps of the study, with all threads."""
    batch, space = walks(WALKS), cells()
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        PLANNER.sweep_euclid(batch, space)
        times.append(time.perf_counter() - start)
    return min(times)


def row(ours: float, baseline: float | None, name: str, unit: str) -> dict:
    return {
        "ours": ours,
        "baseline": baseline,
        "baseline_name": name,
        "ratio": baseline / ours if baseline is not None else None,
        "unit": unit,
    }


def measure() -> dict[str, dict]:
    """``{key: {ours, baseline, baseline_name, ratio, unit}}``; keys whose baseline is not installed are left out."""
    folder = os.path.dirname(os.path.abspath(__file__))
    lanes_s, plain_s = agent_steps()
    baselines = {
        "sweep_vs_scalar": (plain_s, "the same in a plain compiled loop, double precision"),
        "sweep_vs_python": (printed_by(sys.executable, PLAIN_PYTHON, folder, NUMBA_DISABLE_JIT="1"), "the same in plain Python"),
        "sweep_vs_rvo": (peer_s("pyrvo", RVO), "pyrvo do_step, one agent"),
        "sweep_vs_jupedsim": (peer_s("jupedsim", JUPEDSIM), "JuPedSim collision-free speed model, iterate(n), one agent"),
    }
    rows = {
        key: row(1e9 * lanes_s, 1e9 * seconds, name, "ns/agent-step")
        for key, (seconds, name) in baselines.items()
        if seconds is not None
    }
    return {**rows, "maps_1848": row(maps_s(), None, "", f"s, {numba.get_num_threads()} threads")}


if __name__ == "__main__":
    for key, values in measure().items():
        print(key, values)
