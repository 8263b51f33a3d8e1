"""The loops over the walkers of a tile, each a run of vector instructions; see :mod:`walklab.planning.lane_kernel`."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Lanes = NDArray[np.float32]
Single = np.float32
Groups = tuple[NDArray[np.int64], NDArray[np.int64]]  # cells sorted by (v, a, b), where each group of equals begins
Walk = tuple[Single, Single, Single, Single, Single, bool]  # total, total for braking, end speed, look-ahead, step, proportional

WIDTH = 16  # walkers in a vector
LANES = 128  # walkers in a tile
ROWS = 16
X, Y, HX, HY, SPEED, PROGRESS, NEXT, SCORE, V, GAIN, B, HALF_OMEGA, TRAVELLED, TX, TY, NEAREST = range(0, ROWS * LANES, LANES)
FRAME = TRAVELLED  # on the first leg: frames scored so far

ZERO, HALF, ONE, TWO, QUARTER_TURN = Single(0), Single(0.5), Single(1), Single(2), Single(np.pi / 2)
FAR_M = Single(1e9)
END_TOLERANCE_M = Single(1e-5)
TIE_M2 = Single(1e-12)

# tan(t) = t (945 - 105 t^2 + t^4) / (945 - 420 t^2 + 15 t^4), Pade; a turn by 2 t is wrong by 4e-13 at 0.6 rad, by 2e-7 at
# 2 rad and by 2e-5 at half a turn.
P0, P1, P2, Q1, Q2 = Single(1), Single(-105 / 945), Single(1 / 945), Single(-420 / 945), Single(15 / 945)

# Only what changes no result: there are no NaNs, and the sign of a zero does not matter.
FLAGS = {"nnan", "nsz"}


@njit(fastmath=FLAGS, inline="always")
def next_speed(speed: Single, v: Single, gain: Single, b: Single, end_speed: Single, remaining: Single, step_s: Single) -> Single:
    """As in ``following_kernel``, without branches; who does not brake has an endless way remaining.

    The condition for braking there says the same as that the braking limit is the smaller speed.
    """
    loss = b * step_s
    slower = speed - loss
    free = min(speed + gain, v) if speed <= v else max(v, slower)
    half = HALF * loss
    root = half * half + TWO * b * remaining - loss * speed + end_speed * end_speed
    limit = np.sqrt(max(root, ZERO)) - half
    return max(min(free, limit), max(slower, ZERO))


@njit(cache=True, fastmath=FLAGS, error_model="numpy")
def walk_straight(lanes: Lanes, size: int, along: Lanes, aside: Lanes, corner: Single, walk: Walk) -> None:
    """Straight on, frame by frame, until the look-ahead point is beyond ``corner``.

    ``along`` is where the captured frames are along the leg, ``aside`` their squared distance from it.
    """
    total, brake_total, end_speed, look_ahead, step_s, _ = walk
    for n in range(along.size):
        here, away = along[n], aside[n]
        for i in range(size):
            progress, speed, score = lanes[PROGRESS + i], lanes[SPEED + i], lanes[SCORE + i]
            straight = progress + look_ahead <= corner
            gap = progress - here
            scored = score + np.sqrt(gap * gap + away)
            new = next_speed(speed, lanes[V + i], lanes[GAIN + i], lanes[B + i], end_speed, brake_total - progress, step_s)
            further = min(progress + (speed + new) * (HALF * step_s), total)
            lanes[SCORE + i] = scored if straight else score
            lanes[PROGRESS + i] = further if straight else progress
            lanes[SPEED + i] = new if straight else speed
            lanes[FRAME + i] += ONE if straight else ZERO
        if n % 8 == 7 and corner < FAR_M:
            waiting = 0
            for i in range(size):
                waiting += lanes[PROGRESS + i] + look_ahead <= corner
            if waiting == 0:
                return


@njit(cache=True, fastmath=FLAGS, error_model="numpy")
def score_and_speed(lanes: Lanes, size: int, cx: Single, cy: Single, legs: Lanes, leg: int, walk: Walk) -> None:
    """Score the walkers against the captured frame; find their speeds and, on the given leg, the points they look at."""
    total, brake_total, end_speed, look_ahead, step_s, _ = walk
    px, py, dx, dy = legs[leg, 2], legs[leg, 3], legs[leg, 4], legs[leg, 5]
    for i in range(size):
        gx, gy = lanes[X + i] - cx, lanes[Y + i] - cy
        lanes[SCORE + i] += np.sqrt(gx * gx + gy * gy)
        speed, progress = lanes[SPEED + i], lanes[NEXT + i]
        new = next_speed(speed, lanes[V + i], lanes[GAIN + i], lanes[B + i], end_speed, brake_total - progress, step_s)
        lanes[TRAVELLED + i] = (speed + new) * (HALF * step_s)
        lanes[SPEED + i] = new
        lanes[PROGRESS + i] = progress
        target = min(progress + look_ahead, total)
        lanes[TX + i] = px + target * dx
        lanes[TY + i] = py + target * dy


@njit(cache=True, fastmath=FLAGS, error_model="numpy")
def look_along(lanes: Lanes, size: int, legs: Lanes, leg: int, walk: Walk) -> None:
    """Move the points looked at to this leg where they lie beyond its start."""
    total, _, _, look_ahead, _, _ = walk
    start, px, py, dx, dy = legs[leg, 0], legs[leg, 2], legs[leg, 3], legs[leg, 4], legs[leg, 5]
    for i in range(size):
        target = min(lanes[PROGRESS + i] + look_ahead, total)
        before_x, before_y, here_x, here_y = lanes[TX + i], lanes[TY + i], px + target * dx, py + target * dy
        lanes[TX + i] = here_x if target > start else before_x
        lanes[TY + i] = here_y if target > start else before_y


@njit(cache=True, fastmath=FLAGS, error_model="numpy")
def turn_and_move(lanes: Lanes, size: int, walk: Walk) -> None:
    """Turn towards the point looked at by at most the limit, and take the step.

    With t = angle / 2 and tan t = s / c, the direction (c^2 - s^2, 2 s c) is the angle's; its length is no matter, since the
    new heading, turned or straight at the point, is brought to unit length in the end.
    """
    _, _, _, _, step_s, proportional = walk
    for i in range(size):
        x, y, hx, hy, travelled = lanes[X + i], lanes[Y + i], lanes[HX + i], lanes[HY + i], lanes[TRAVELLED + i]
        tx, ty = lanes[TX + i] - x, lanes[TY + i] - y
        cross, dot = hx * ty - hy * tx, hx * tx + hy * ty
        t = min(lanes[HALF_OMEGA + i] * (travelled if proportional else step_s), QUARTER_TURN)
        square = t * t
        s, c = t * (P0 + square * (P1 + square * P2)), P0 + square * (Q1 + square * Q2)
        sine, cosine = TWO * s * c, c * c - s * s
        within = abs(cross) * cosine < dot * sine  # sin(angle of the target - angle of the turn) < 0
        sine = -sine if cross < ZERO else sine
        turned_x, turned_y = hx * cosine - hy * sine, hy * cosine + hx * sine
        hx, hy = tx if within else turned_x, ty if within else turned_y
        scale = ONE / np.sqrt(hx * hx + hy * hy)
        hx, hy = hx * scale, hy * scale
        lanes[HX + i], lanes[HY + i] = hx, hy
        lanes[X + i], lanes[Y + i] = x + travelled * hx, y + travelled * hy
        lanes[NEAREST + i] = FAR_M


@njit(cache=True, fastmath=FLAGS, error_model="numpy")
def project(lanes: Lanes, size: int, legs: Lanes, leg: int, walk: Walk) -> None:
    """Progress to the nearest point on this leg, between the progress so far and the look-ahead point, where no leg before has
    a nearer one."""
    _, _, _, look_ahead, _, _ = walk
    start, end, px, py, dx, dy = legs[leg, 0], legs[leg, 1], legs[leg, 2], legs[leg, 3], legs[leg, 4], legs[leg, 5]
    for i in range(size):
        progress, nearest, before = lanes[PROGRESS + i], lanes[NEAREST + i], lanes[NEXT + i]
        rx, ry = lanes[X + i] - px, lanes[Y + i] - py
        along, aside = rx * dx + ry * dy, rx * dy - ry * dx
        first, last = max(progress, start), min(progress + look_ahead, end)
        at = min(max(along, first), last)
        gap = along - at
        squared = gap * gap + aside * aside
        nearer = (squared <= nearest + TIE_M2) & (first <= last)
        lanes[NEAREST + i] = squared if nearer else nearest
        lanes[NEXT + i] = at if nearer else before
