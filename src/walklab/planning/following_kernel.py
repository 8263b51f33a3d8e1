"""The compiled walkers: the step of path following, its two loops (one walk; many walks times many parameters), and relaxation.

Both loops call the same scalar step, so that a swept score is the score of the walk that ``follow`` returns. It is one
file because numba's cache of compiled code notices a change in the file of a function, but not in another file whose
functions it calls.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

State = tuple[float, float, float, float, float, int, int, float, int]  # x, y, heading, speed, leg, leg ahead, progress, status
Limits = tuple[float, float, float, float]  # v, a, omega, b
Rule = tuple[float, bool, int, float, float]  # look-ahead distance, braking, turn law, step, radius that ends a walk (0: none)

PROPORTIONAL, CONSTANT = 0, 1  # turn laws: largest turning rate omega * speed, or omega itself
WALKING, AT_END = 0, 1
END_TOLERANCE_M = 1e-9


@njit(cache=True, inline="always")
def advance(
    route: Array, leg: int, ahead_leg: int, progress_m: float, look_ahead_m: float, x: float, y: float
) -> tuple[int, float]:
    """Progress of a walker: arc length of the nearest route point between the progress so far and the look-ahead point.

    The window makes progress monotone and keeps it from skipping a loop of the route. Of two equally near points the later
    counts: at the earlier one, a walker would wait for ever at the turn of a route that runs back along itself.

    Returns
    -------
    (leg, progress_m); leg is the index of the route point before the progress
    """
    along = route[leg, 2] + (x - route[leg, 0]) * route[leg, 3] + (y - route[leg, 1]) * route[leg, 4]
    if leg == ahead_leg:
        limit = min(progress_m + look_ahead_m, route[leg + 1, 2])
        return leg, min(max(along, progress_m), limit)
    best_leg, best = leg, min(max(along, progress_m), route[leg + 1, 2])
    nearest = _squared_distance(route, leg, best, x, y)
    for other in range(leg + 1, ahead_leg + 1):
        along = route[other, 2] + (x - route[other, 0]) * route[other, 3] + (y - route[other, 1]) * route[other, 4]
        along = min(max(along, route[other, 2]), min(route[other + 1, 2], progress_m + look_ahead_m))
        distance = _squared_distance(route, other, along, x, y)
        if distance <= nearest + 1e-12:
            best_leg, best, nearest = other, along, distance
    return best_leg, best


@njit(cache=True, inline="always")
def _squared_distance(route: Array, leg: int, at_m: float, x: float, y: float) -> float:
    along = at_m - route[leg, 2]
    return (route[leg, 0] + along * route[leg, 3] - x) ** 2 + (route[leg, 1] + along * route[leg, 4] - y) ** 2


@njit(cache=True, inline="always")
def leg_at(route: Array, leg: int, at_m: float) -> int:
    """Index of the leg that holds an arc length, searched forward from ``leg``; the last leg for all beyond."""
    while leg + 2 < route.shape[0] and route[leg + 1, 2] < at_m:
        leg += 1
    return leg


@njit(cache=True, inline="always")
def next_speed(
    speed: float, v: float, a: float, b: float, end_speed: float, remaining_m: float, braking: bool, step_s: float
) -> float:
    """Speed after one step: towards v by at most a, and slow enough to brake to the end speed in what remains.

    Within a step the speed changes linearly. Braking at b from the new speed w on must do:
    ``(speed + w) / 2 * step + (w^2 - end_speed^2) / (2 b) <= remaining``; on the braking
    parabola this gives ``w = speed - b * step`` exactly. The speed never falls faster than b.
    """
    faster = speed + a * step_s
    new = min(faster, v) if speed <= v else max(v, speed - b * step_s)
    if braking and (speed + new) * step_s * b + new * new - end_speed * end_speed > 2.0 * b * remaining_m:
        half = 0.5 * b * step_s
        root = half * half + 2.0 * b * remaining_m - b * speed * step_s + end_speed * end_speed
        limit = np.sqrt(max(root, 0.0)) - half
        new = max(min(new, limit), speed - b * step_s, 0.0)
    return new


@njit(cache=True, inline="always")
def turned(hx: float, hy: float, tx: float, ty: float, angle: float) -> tuple[float, float]:
    """The unit heading (hx, hy) turned towards the vector (tx, ty) by at most ``angle`` radians."""
    cross = hx * ty - hy * tx
    dot = hx * tx + hy * ty
    if dot > 0.0 and cross * cross <= 1e-28 * dot * dot:
        return hx, hy
    distance = np.sqrt(tx * tx + ty * ty)
    if distance == 0.0:
        return hx, hy
    if angle < 0.3:
        # Taylor series, exact to 1e-13 below 0.3 rad: no trigonometry where it is called most.
        q = angle * angle
        sine = angle * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0))))
        cosine = 1.0 - q / 2.0 * (1.0 - q / 12.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0 * (1.0 - q / 90.0))))
        within = dot > 0.0 and abs(cross) <= sine * distance
    elif angle < np.pi:
        sine, cosine = np.sin(angle), np.cos(angle)
        within = dot >= cosine * distance
    else:
        return tx / distance, ty / distance
    if within:
        return tx / distance, ty / distance
    if cross < 0.0:
        sine = -sine
    x, y = hx * cosine - hy * sine, hx * sine + hy * cosine
    # One Newton step keeps the heading at unit length over any number of turns.
    scale = 1.5 - 0.5 * (x * x + y * y)
    return x * scale, y * scale


@njit(cache=True, inline="always")
def standing_at_start(route: Array, hx: float, hy: float, speed: float) -> State:
    """The state before the first step."""
    return route[0, 0], route[0, 1], hx, hy, speed, 0, 0, 0.0, WALKING if route.shape[0] > 1 else AT_END


@njit(cache=True, inline="always")
def step(route: Array, state: State, limits: Limits, end_speed: float, rule: Rule) -> State:
    """One step of a walker: speed, heading, position, progress.

    The status is AT_END once the progress has reached the end of the route; the last step is cut where it
    crosses the line through the end at right angles to the last leg. With a radius that ends a walk, the status is AT_END as
    well once the walker is that near to the end, and its step is not cut.
    """
    x, y, hx, hy, speed, leg, ahead_leg, progress, _ = state
    v, a, omega, b = limits
    look_ahead_m, braking, turn_law, step_s, radius_m = rule
    total = route[-1, 2]
    new_speed = next_speed(speed, v, a, b, end_speed, total - progress, braking, step_s)
    travelled = 0.5 * (speed + new_speed) * step_s
    target = min(progress + look_ahead_m, total)
    ahead_leg = leg_at(route, ahead_leg, target)
    along = target - route[ahead_leg, 2]
    tx = route[ahead_leg, 0] + along * route[ahead_leg, 3] - x
    ty = route[ahead_leg, 1] + along * route[ahead_leg, 4] - y
    angle = np.inf
    if omega < np.inf:
        angle = omega * (travelled if turn_law == PROPORTIONAL else step_s)
    hx, hy = turned(hx, hy, tx, ty, angle)
    new_x, new_y = x + travelled * hx, y + travelled * hy
    leg, progress = advance(route, leg, ahead_leg, progress, look_ahead_m, new_x, new_y)
    # Twice the radius along the route: who merely passes by the end on the way there has not arrived.
    near = radius_m > 0.0 and total - progress <= 2.0 * radius_m
    if near and (new_x - route[-1, 0]) ** 2 + (new_y - route[-1, 1]) ** 2 <= radius_m * radius_m:
        return new_x, new_y, hx, hy, new_speed, leg, ahead_leg, total, AT_END
    if progress < total - END_TOLERANCE_M:
        return new_x, new_y, hx, hy, new_speed, leg, ahead_leg, progress, WALKING
    last = route.shape[0] - 2
    forward = hx * route[last, 3] + hy * route[last, 4]
    beyond = (new_x - route[-1, 0]) * route[last, 3] + (new_y - route[-1, 1]) * route[last, 4]
    if 0.0 < beyond < forward * travelled:
        new_x, new_y = new_x - beyond / forward * hx, new_y - beyond / forward * hy
    return new_x, new_y, hx, hy, new_speed, leg, ahead_leg, total, AT_END


@njit(cache=True)
def follow_route(
    route: Array, heading: Array, start_speed: float, end_speed: float, parameters: Array, rule: Rule, steps: int
) -> tuple[Array, int]:
    """Positions of one walk.

    Parameters
    ----------
    route : from :func:`walklab.planning.routes.prepare_route`, at least two rows
    heading : (2,) unit vector
    parameters : (4,) array of v, a, omega, b
    steps : most steps to simulate

    Returns
    -------
    (positions (n, 2), status)
    """
    limits = (parameters[0], parameters[1], parameters[2], parameters[3])
    positions = np.empty((steps + 1, 2))
    state = standing_at_start(route, heading[0], heading[1], start_speed)
    positions[0, 0], positions[0, 1] = route[0, 0], route[0, 1]
    for n in range(1, steps + 1):
        state = step(route, state, limits, end_speed, rule)
        positions[n, 0], positions[n, 1] = state[0], state[1]
        if state[8] == AT_END:
            return positions[: n + 1].copy(), AT_END
    return positions, WALKING


@njit(cache=True)
def score_cell(
    route: Array, captured: Array, start_speed: float, end_speed: float, limits: Limits, rule: Rule, beyond: int = 0
) -> float:
    """Sum of the distances between a captured and a simulated walk over the captured frames, metres.

    With ``beyond`` steps above 0 it goes on, the captured person standing, until the simulated walk has ended too or so many
    steps are taken in all.
    """
    state = standing_at_start(route, route[0, 3], route[0, 4], start_speed)
    total = 0.0
    last = captured.shape[0] - 1
    for n in range(max(last, beyond) + 1):
        if n > last and state[8] == AT_END:
            break
        if n > 0 and state[8] == WALKING:
            state = step(route, state, limits, end_speed, rule)
        at = min(n, last)
        total += np.sqrt((captured[at, 0] - state[0]) ** 2 + (captured[at, 1] - state[1]) ** 2)
    return total


@njit(cache=True, nogil=True)
def sweep(
    routes: Array,
    route_offsets: NDArray[np.int64],
    captured: Array,
    captured_offsets: NDArray[np.int64],
    end_speeds: tuple[Array, Array],
    lengths: Array,
    order: NDArray[np.int64],
    cells: Array,
    rule: Rule,
    scores: Array,
    beyond: int = 0,
) -> None:
    """m_Euclid of the walks in ``order`` and all parameter vectors, seconds: fills their rows of ``scores``, (walks, cells).

    ``routes`` holds prepared routes back to back, ``end_speeds`` the speeds at the starts and at the ends. Several threads may
    each fill the rows of their own walks. ``beyond`` is as in :func:`score_cell`.
    """
    for walk in order:
        route = routes[route_offsets[walk] : route_offsets[walk + 1]]
        frames = captured[captured_offsets[walk] : captured_offsets[walk + 1]]
        start_speed, end_speed = end_speeds[0][walk], end_speeds[1][walk]
        for cell in range(cells.shape[0]):
            limits = (cells[cell, 0], cells[cell, 1], cells[cell, 2], cells[cell, 3])
            distances = score_cell(route, frames, start_speed, end_speed, limits, rule, beyond)
            scores[walk, cell] = distances * rule[3] / lengths[walk]


@njit(cache=True)
def relax_along(route: Array, v: float, tau: float, look_ahead_m: float, step_s: float, steps: int) -> tuple[Array, bool]:
    """Positions from rest at the route's start, and whether the route's end was reached.

    Within a step the direction to walk is held and the relaxation solved exactly.
    """
    positions = np.empty((steps + 1, 2))
    x, y, wx, wy = route[0, 0], route[0, 1], 0.0, 0.0
    positions[0, 0], positions[0, 1] = x, y
    leg, ahead_leg, progress, total = 0, 0, 0.0, route[-1, 2]
    kept = np.exp(-step_s / tau)
    for n in range(1, steps + 1):
        target = min(progress + look_ahead_m, total)
        ahead_leg = leg_at(route, ahead_leg, target)
        along = target - route[ahead_leg, 2]
        tx = route[ahead_leg, 0] + along * route[ahead_leg, 3] - x
        ty = route[ahead_leg, 1] + along * route[ahead_leg, 4] - y
        distance = np.sqrt(tx * tx + ty * ty)
        ex, ey = (v * tx / distance, v * ty / distance) if distance > 0.0 else (wx, wy)
        x += ex * step_s + (wx - ex) * tau * (1.0 - kept)
        y += ey * step_s + (wy - ey) * tau * (1.0 - kept)
        wx, wy = ex + (wx - ex) * kept, ey + (wy - ey) * kept
        leg, progress = advance(route, leg, ahead_leg, progress, look_ahead_m, x, y)
        positions[n, 0], positions[n, 1] = x, y
        if progress >= total - 1e-9:
            return positions[: n + 1].copy(), True
    return positions, False
