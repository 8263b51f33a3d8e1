"""A planner that can be computed by hand, walks made with it, and a small model learned from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest

from walklab.geometry.curves import arc_length
from walklab.geometry.scene import State, Task
from walklab.planning.protocol import Arrival, Trajectory, WalkBatch
from walklab.steering.space import ParameterSpace, space_from_config
from walklab.steering.suitability import score_walks
from walklab.steering.training import TrainingSettings, train

STEP_S = 1 / 60


def trapezoid(time_s: np.ndarray, length_m: float, v: float, a: float) -> np.ndarray:
    """Distance travelled when speeding up by a to v at most, and braking by a to stand at the end."""
    ramp = min(v / a, np.sqrt(length_m / a))
    top = a * ramp
    cruise = max((length_m - a * ramp**2) / top, 0.0)
    total = 2 * ramp + cruise
    t = np.clip(time_s, 0, total)
    up, down = 0.5 * a * np.minimum(t, ramp) ** 2, 0.5 * a * np.clip(t - ramp - cruise, 0, None) ** 2
    return up + top * np.clip(t - ramp, 0, None) - down


@dataclass(frozen=True)
class PointMass:
    """Follows the polyline exactly, with a trapezoid of speed; not a sweeping planner."""

    parameters: tuple[str, ...] = ("v", "a")
    step_s: float = STEP_S
    moving_start: bool = False

    def route(self, scene, task, body):
        return np.array([task.start.position_m, task.end.position_m])

    def follow(self, route_m, task, parameters, time_limit_s):
        v, a = parameters[:2]
        travelled = arc_length(route_m)
        duration_s = min(max(2 * travelled[-1] / v + 2 * v / a, 1.0), time_limit_s)
        at = trapezoid(np.arange(int(duration_s / self.step_s + 1e-6) + 1) * self.step_s, travelled[-1], v, a)
        positions = np.column_stack([np.interp(at, travelled, route_m[:, axis]) for axis in (0, 1)])
        return Trajectory(positions, self.step_s, Arrival.ARRIVED)


def task_along(route_m) -> Task:
    return Task(State(tuple(route_m[0])), State(tuple(route_m[-1])))


def pack(planner, routes, parameters, start_speeds=None) -> WalkBatch:
    """Walks captured from the planner itself, each with its own parameters."""
    captured = [
        planner.follow(route, task_along(route), np.asarray(p), 60.0).positions_m
        for route, p in zip(routes, parameters, strict=True)
    ]
    zeros = np.zeros(len(routes))
    return WalkBatch(
        np.concatenate(routes),
        np.concatenate([[0], np.cumsum([len(route) for route in routes])]),
        np.concatenate(captured),
        np.concatenate([[0], np.cumsum([len(walk) for walk in captured])]),
        zeros if start_speeds is None else start_speeds,
        zeros,
        np.array([arc_length(route)[-1] for route in routes]),
        planner.step_s,
    )


def speed_of(length_m: np.ndarray) -> np.ndarray:
    """How fast people walk in these tests: the longer the faster."""
    return 0.5 + 0.3 * length_m


@dataclass(frozen=True)
class World:
    """Walks of ten people whose speed depends on the length alone."""

    planner: PointMass
    space: ParameterSpace
    batch: WalkBatch
    vectors: pd.DataFrame
    participants: list[str]
    scores: np.ndarray


@pytest.fixture(scope="session")
def point_mass() -> PointMass:
    return PointMass()


@pytest.fixture(scope="session")
def packer():
    return pack


@pytest.fixture(scope="session")
def world() -> World:
    rng = np.random.default_rng(5)
    lengths = np.repeat(np.arange(0.5, 4.01, 0.5), 10) + rng.uniform(-0.05, 0.05, 80)
    planner = PointMass()
    space = space_from_config(
        [
            {"name": "v", "unit": "m/s", "start": 0.1, "step": 0.3, "count": 7},
            {"name": "a", "unit": "m/s2", "values": [0.25, 0.5, 1.0, 2.0, 4.0]},
        ]
    )
    routes = [np.array([[0.0, 0.0], [length, 0.0]]) for length in lengths]
    parameters = np.column_stack([speed_of(lengths), np.full(80, 1.5)])
    batch = pack(planner, routes, parameters)
    vectors = pd.DataFrame({"length": lengths, "height": np.tile(np.linspace(1.6, 1.9, 10), 8)})
    participants = [f"P{i:02d}" for i in range(10)] * 8
    return World(planner, space, batch, vectors, participants, score_walks(planner, batch, space.cells))


@pytest.fixture(scope="session")
def model(world):
    settings = TrainingSettings(normalisation="min_max", count=200, neighbours=20, subset=3, k=20, exponent=4.0)
    rng = np.random.default_rng(0)
    return train(world.scores, world.vectors, world.participants, world.space, settings, rng, provenance={"run": "test"})
