"""Reynolds path following with limited acceleration and a turning rate limited by speed.

The planner of Agethen et al. 2017, section 4.3: a Lazy Theta* route followed by the path following of Reynolds 1999;
"the rate of velocity change is constrained. Same applies for angular velocity", by a linear
relationship between speed and the largest turning rate (Cirio et al. 2013): ``|d heading / dt| <= omega * speed``.
An agent at rest cannot turn, and its smallest radius is 1 / omega.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numba
import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.scene import Body, Scene, Task
from walklab.planning.following_kernel import AT_END, CONSTANT, PROPORTIONAL, Rule, follow_route, sweep
from walklab.planning.lane_kernel import group_cells, sweep_lanes
from walklab.planning.protocol import Arrival, Trajectory, WalkBatch
from walklab.planning.routes import RouteFinder, prepare_route

Array = NDArray[np.float64]

NAMES = ("v", "a", "omega", "b")

LANE_CELLS = 16  # fewer do not fill a vector
LANE_ROUTE_M = 100.0  # single precision resolves 8 micrometres there
LANE_ACCELERATION_M_S2 = 100.0
TURNS_AT_ONCE = 1e6  # stands for an infinite omega in lanes: half a turn within 3 micrometres
THREADED_STEPS = 100_000  # of one walker after the other, some 2 ms; threads cost a tenth of that
TURN_LAWS = {"proportional": PROPORTIONAL, "constant": CONSTANT}
LINE, RADIUS = "line", "radius"  # what ends a walk

# ASSUME: the look-ahead distance is 0.30 m, because the paper gives none; it is about half a step, so that a corner is cut by a
# few centimetres as people do, and the shortest walks (0.5 m) are still longer than it.
LOOK_AHEAD_M = 0.30

# ASSUME: a walk has arrived if it comes to its end within 0.10 m, because the paper defines no arrival; captured standing
# positions scatter by about as much around the same mark. It ends at the line through the route's end (``ends_at``), because
# people walk up to their mark; ending it within the radius is the other reading.
ARRIVAL_RADIUS_M = 0.10

# ASSUME: an agent turns by any angle at once when omega is not a parameter, and brakes as hard as it accelerates when b is not,
# because the paper's three parameters name neither another turning limit nor a braking limit.
DEFAULTS = {"omega": math.inf}

# ASSUME: where a task gives no start heading, the agent faces along the first leg of its route, in fitting and in evaluation
# alike, because the paper gives no heading and an agent that is limited by omega * v cannot turn at rest.


@dataclass(frozen=True)
class PathFollowing:
    """Walks along a Lazy Theta* route; implements :class:`walklab.planning.protocol.SweepingPlanner`.

    In each step the agent takes the route point nearest to it (never behind an earlier one, at most ``look_ahead_m``
    ahead), seeks the point ``look_ahead_m`` further along, turns towards it by at most ``omega`` times the distance of the
    step, speeds up by at most ``a`` towards ``v``, and brakes by at most ``b`` so as to reach the task's end speed at the
    route's end.

    The walk ends when the nearest route point is the route's end; the last step is cut there, and the agent stands
    from then on (with whatever speed a cut corner or ``braking=False`` left it). It has *arrived* if it then is within
    ``arrival_radius_m`` of the end, else it has *passed*: its turning circle was too large for the route.
    *Timeout*: still under way at the time limit. With ``ends_at="radius"`` a walk ends as soon as it is within
    ``arrival_radius_m`` of the end (at the latest as above); such walks are not walked in lanes, but one by one, which is
    slower.

    Attributes
    ----------
    parameters : any of v (m/s), a (m/s2), omega (1/m; rad/s with the constant turn law), b (m/s2), in any order
    step_s : simulation step
    look_ahead_m, arrival_radius_m : see above
    fixed : values of parameters that are not in ``parameters``; v and a must be in one of the two
    braking : False: keep going at full speed up to the end
    turn_law : "proportional" (omega * speed) or "constant" (omega)
    ends_at : "line" through the end, or within the "radius" of arrival
    finder : finds the routes
    """

    parameters: tuple[str, ...] = ("v", "a", "omega")
    step_s: float = 1 / 60
    look_ahead_m: float = LOOK_AHEAD_M
    arrival_radius_m: float = ARRIVAL_RADIUS_M
    fixed: Mapping[str, float] = field(default_factory=dict)
    braking: bool = True
    turn_law: str = "proportional"
    ends_at: str = LINE
    finder: RouteFinder = field(default_factory=RouteFinder)
    moving_start: bool = True

    def __post_init__(self) -> None:
        check_names("path_following", self.parameters, self.fixed, NAMES, required=("v", "a"))
        for name in ("step_s", "look_ahead_m", "arrival_radius_m"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise InputError(f"planner path_following: {name} is {getattr(self, name)}; it must be above 0")
        if self.turn_law not in TURN_LAWS:
            raise InputError(f"planner path_following: unknown turn_law {self.turn_law!r}; known are {sorted(TURN_LAWS)}")
        if self.ends_at not in (LINE, RADIUS):
            raise InputError(f"planner path_following: unknown ends_at {self.ends_at!r}; known are {LINE}, {RADIUS}")

    def route(self, scene: Scene, task: Task, body: Body) -> Array:
        """See :meth:`RouteFinder.route`."""
        return self.finder.route(scene, task, body)

    def kernel_parameters(self, cells: Array) -> Array:
        """Columns v, a, omega, b for the compiled loops, from vectors in the order of ``parameters``; (cells, 4) array.

        Raises
        ------
        InputError
            If a value is not above zero (omega: not below) or, but for omega, not finite.
        """
        cells = np.atleast_2d(np.asarray(cells, dtype=float))
        if cells.shape[1] != len(self.parameters):
            raise InputError(f"planner path_following: {cells.shape[1]} values for the parameters {', '.join(self.parameters)}")
        values: dict[str, Array] = {name: cells[:, i] for i, name in enumerate(self.parameters)}
        for name, value in {**DEFAULTS, **self.fixed}.items():
            values.setdefault(name, np.full(len(cells), float(value)))
        values.setdefault("b", values["a"])
        for name in NAMES:
            good = values[name] >= 0 if name == "omega" else np.isfinite(values[name]) & (values[name] > 0)
            if not good.all():
                bad = values[name][np.flatnonzero(~good)[0]]
                raise InputError(f"planner path_following: parameter {name} is {bad}; it must be a number above 0")
        return np.ascontiguousarray(np.column_stack([values[name] for name in NAMES]))

    def follow(self, route_m: Array, task: Task, parameters: Array, time_limit_s: float) -> Trajectory:
        """Walk along the route with one vector of steering parameters.

        Parameters
        ----------
        route_m : (n, 2) array; the walk starts at its first point
        task : gives start heading (None: along the first leg), start and end speed
        parameters : values in the order of ``parameters``
        time_limit_s : longest simulated time

        Raises
        ------
        InputError
            If a parameter has no sensible value.
        """
        route = prepare_route(np.asarray(route_m, dtype=float))
        values = self.kernel_parameters(parameters)[0]
        if len(route) < 2:
            return Trajectory(route[:, :2].copy(), self.step_s, Arrival.ARRIVED)
        heading = route[0, 3:]
        if task.start.heading_rad is not None:
            heading = np.array([math.cos(task.start.heading_rad), math.sin(task.start.heading_rad)])
        steps = max(math.ceil(time_limit_s / self.step_s - 1e-9), 0)
        speeds = task.start.speed_m_s, task.end.speed_m_s
        positions, status = follow_route(route, heading, *speeds, values, self.rule, steps)
        return Trajectory(positions, self.step_s, arrival_of(positions, route, status == AT_END, self.arrival_radius_m))

    def sweep_euclid(self, batch: WalkBatch, cells: Array, beyond_s: float = 0.0) -> Array:
        """m_Euclid of every walk and cell: ``sum_t |T_t - A_t| * step_s / length`` (Agethen et al. 2017, eq. 5), seconds.

        The sum runs over the captured frames; an agent that has ended stands where it ended. Initial headings are along
        the first leg.

        ``LANE_CELLS`` cells and more are walked side by side in single precision (:mod:`walklab.planning.lane_kernel`), fewer
        one by one in double precision, as are the walks for which :meth:`in_lanes` says no. The two differ by rounding alone.
        Neither the number of threads nor the other walks of the batch change a score.

        Parameters
        ----------
        batch : captured walks and routes, at this planner's step
        cells : (cells, parameters) array
        beyond_s : above 0: each sum goes on until both walks have ended, the simulated one after so long at the latest (never in
            lanes)

        Returns
        -------
        (walks, cells) array

        Raises
        ------
        InputError
            If the batch has another step or a parameter has no sensible value.
        """
        if not math.isclose(batch.step_s, self.step_s):
            raise InputError(f"walks sampled every {batch.step_s:.6f} s, planner steps {self.step_s:.6f} s; resample the walks")
        values = self.kernel_parameters(cells)
        scores = np.empty((len(batch), len(values)))
        if not scores.size:
            return scores
        routes, offsets = batch.prepared_routes
        frame_offsets = batch.captured_offsets.astype(np.int64)
        speeds = _floats(batch.start_speeds_m_s), _floats(batch.end_speeds_m_s)
        packed = routes, offsets, _floats(batch.captured_m), frame_offsets, speeds, _floats(batch.lengths_m)
        in_lanes = self.in_lanes(values, speeds, routes[offsets[1:] - 1, 2]) & (beyond_s <= 0)
        steps = np.diff(frame_offsets) * len(values)
        if in_lanes.any():
            singles, groups = np.minimum(values, TURNS_AT_ONCE).astype(np.float32), group_cells(values)
            # A straight walk costs little: cells that differ in omega alone are one.
            work = steps * np.where(np.diff(offsets) > 2, 0.1, 0.01)
            share_out(lambda own: sweep_lanes(*packed, own, singles, groups, self.rule, scores), np.flatnonzero(in_lanes), work)
        if not in_lanes.all():
            beyond = max(math.ceil(beyond_s / self.step_s - 1e-9), 0)
            share_out(lambda own: sweep(*packed, own, values, self.rule, scores, beyond), np.flatnonzero(~in_lanes), steps)
        return scores

    def in_lanes(self, values: Array, speeds_m_s: tuple[Array, Array], route_lengths_m: Array) -> NDArray[np.bool_]:
        """Which walks the single-precision lanes can walk: (walks,) array.

        Not if a step may reach beyond the look-ahead point, or if a route is so long or a braking so hard that single precision
        is too coarse for it; none for a few cells, for which double precision is no slower; and none that ends within a radius.
        """
        v, a, b = values[:, 0].max(), values[:, 1].max(), values[:, 3].max()
        if len(values) < LANE_CELLS or max(a, b) > LANE_ACCELERATION_M_S2 or self.ends_at == RADIUS:
            return np.zeros(len(route_lengths_m), dtype=bool)
        fastest = np.maximum(v, np.maximum(*speeds_m_s))
        return (fastest * self.step_s < self.look_ahead_m) & (route_lengths_m <= LANE_ROUTE_M)

    @property
    def rule(self) -> Rule:
        """What compiled code needs beside the parameters: look-ahead, braking, turn law, step, radius that ends a walk."""
        radius_m = float(self.arrival_radius_m) if self.ends_at == RADIUS else 0.0
        return float(self.look_ahead_m), bool(self.braking), TURN_LAWS[self.turn_law], float(self.step_s), radius_m


def _floats(values: Array) -> Array:
    return np.ascontiguousarray(values, dtype=float)


def check_names(
    planner: str, parameters: Sequence[str], fixed: Mapping[str, float], known: Sequence[str], required: Sequence[str]
) -> None:
    """Hold the names of a planner's parameters to those it knows.

    Raises
    ------
    InputError
        If a name is unknown, stands twice, or is missing.
    """
    for name in (*parameters, *fixed):
        if name not in known:
            raise InputError(f"planner {planner}: unknown parameter {name!r}; known are {', '.join(known)}")
    names = [*parameters, *fixed]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise InputError(
            f"planner {planner}: {', '.join(twice)} given twice; a parameter is either an axis of the space or fixed"
        )
    if missing := [name for name in required if name not in names]:
        raise InputError(f"planner {planner}: no value for {', '.join(missing)}; add it to the space or under the option 'fixed'")


def arrival_of(positions_m: Array, route: Array, at_end: bool, arrival_radius_m: float) -> Arrival:
    """How a walk ended, from its last position."""
    if not at_end:
        return Arrival.TIMEOUT
    distance = math.hypot(*(positions_m[-1] - route[-1, :2]))
    return Arrival.ARRIVED if distance <= arrival_radius_m else Arrival.PASSED


def share_out(sweep_walks: Callable[[NDArray[np.int64]], None], walks: NDArray[np.int64], steps: Array) -> None:
    """Sweep walks on as many threads as numba may use, or on this one if that is little work.

    Parameters
    ----------
    sweep_walks : compiled code that sweeps the walks it is given, without the interpreter's lock
    walks : indices of the walks
    steps : how many steps of a single walker take as long as each walk of the batch
    """
    longest_first = walks[np.argsort(-steps[walks], kind="stable")]
    threads = numba.get_num_threads() if steps[walks].sum() > THREADED_STEPS else 1
    if threads == 1:
        sweep_walks(longest_first)
        return
    with ThreadPoolExecutor(threads) as pool:
        # list() waits for all and raises what they raised
        list(pool.map(sweep_walks, [longest_first[first::threads].copy() for first in range(threads)]))
