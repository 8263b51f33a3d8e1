"""What a planner is: ``A`` in Agethen et al. 2017, eq. 1.

A planner splits its work in two. The route depends on the scene alone and is found
once per task; following it depends on the steering parameters and is repeated for
every parameter vector.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from walklab.geometry.scene import Body, Scene, Task

Array = NDArray[np.float64]


class Arrival(IntEnum):
    """How a simulated walk ended."""

    ARRIVED = 0  # came to the end state
    PASSED = 1  # reached the end of the route but went by the end position, out of reach
    TIMEOUT = 2  # still under way at the time limit


@dataclass(frozen=True)
class Trajectory:
    """A simulated walk, sampled every ``step_s`` from its start; it stands at its last position from then on.

    Attributes
    ----------
    positions_m : (n, 2) array
    step_s : float
    arrival : how it ended
    """

    positions_m: Array
    step_s: float
    arrival: Arrival

    @property
    def duration_s(self) -> float:
        return (len(self.positions_m) - 1) * self.step_s


@runtime_checkable
class Planner(Protocol):
    """Any deterministic motion planner with named steering parameters.

    Attributes
    ----------
    parameters : names of the steering parameters, in the order of the vectors passed to ``follow``
    step_s : simulation step
    moving_start : whether a task may start or end at a speed above standing
    """

    parameters: tuple[str, ...]
    step_s: float
    moving_start: bool

    def route(self, scene: Scene, task: Task, body: Body) -> Array:
        """A collision-free polyline from start to end, (n, 2) array, metres; InputError if there is none."""
        ...

    def follow(self, route_m: Array, task: Task, parameters: Array, time_limit_s: float) -> Trajectory:
        """Walk along the route with one vector of steering parameters."""
        ...


@dataclass(frozen=True)
class WalkBatch:
    """Captured walks with their routes, packed for compiled loops.

    Walk ``i`` owns ``routes_m[route_offsets[i]:route_offsets[i + 1]]`` and
    ``captured_m[captured_offsets[i]:captured_offsets[i + 1]]``, the captured
    positions every ``step_s``, first frame at the start of the walk.
    """

    routes_m: Array
    route_offsets: NDArray[np.int64]
    captured_m: Array
    captured_offsets: NDArray[np.int64]
    start_speeds_m_s: Array
    end_speeds_m_s: Array
    lengths_m: Array
    step_s: float

    def __len__(self) -> int:
        return len(self.lengths_m)

    @cached_property
    def prepared_routes(self) -> tuple[Array, NDArray[np.int64]]:
        """The routes of :func:`walklab.planning.routes.prepare_routes`: a fit sweeps the same walks hundreds of times."""
        from walklab.planning.routes import prepare_routes  # late: it compiles, and not every planner asks for it

        return prepare_routes(np.ascontiguousarray(self.routes_m, dtype=float), self.route_offsets.astype(np.int64))


@runtime_checkable
class SweepingPlanner(Planner, Protocol):
    """A planner that scores many parameter vectors on many walks in compiled code."""

    def sweep_euclid(self, batch: WalkBatch, cells: Array) -> Array:
        """m_Euclid of every walk and cell: (walks, cells) array, seconds."""
        ...
