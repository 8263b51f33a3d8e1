"""A slow, plain path follower: the same definition as the compiled one, written with angles and searched projections."""

from __future__ import annotations

import math

import numpy as np


def follow(route, v, a, omega, b, *, step_s, look_ahead_m, frames, heading=None, start_speed=0.0, end_speed=0.0, braking=True):
    """Positions of ``frames`` frames; the walker stands once it is at the end."""
    route = np.asarray(route, dtype=float)
    legs = np.diff(route, axis=0)
    lengths = np.hypot(*legs.T)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    total = starts[-1]

    def at(s):
        k = min(np.searchsorted(starts, s, side="right") - 1, len(legs) - 1)
        return route[k] + legs[k] * (s - starts[k]) / lengths[k]

    def nearest(p, low, high):
        best, best_distance = None, math.inf
        for k in range(len(legs)):
            near, far = max(starts[k], low), min(starts[k + 1], high)
            if near > far:
                continue
            s = starts[k] + float(np.dot(p - route[k], legs[k])) / lengths[k]
            s = min(max(s, near), far)
            distance = float(np.sum((at(s) - p) ** 2))
            if distance <= best_distance + 1e-12:
                best, best_distance = s, distance
        return best

    p = route[0].copy()
    angle = math.atan2(legs[0][1], legs[0][0]) if heading is None else heading
    speed, progress, done = start_speed, 0.0, False
    out = [p.copy()]
    while len(out) < frames:
        if done:
            out.append(p.copy())
            continue
        new = min(speed + a * step_s, v) if speed <= v else max(v, speed - b * step_s)
        if braking:
            left = total - progress

            def needs(w, speed=speed):
                return (speed + w) / 2 * step_s + (w * w - end_speed**2) / (2 * b)

            if needs(new) > left:
                low, high = 0.0, new
                for _ in range(60):
                    middle = (low + high) / 2
                    low, high = (middle, high) if needs(middle) <= left else (low, middle)
                new = max(low, speed - b * step_s, 0.0)
        travelled = (speed + new) / 2 * step_s
        tx, ty = at(min(progress + look_ahead_m, total)) - p
        if math.hypot(tx, ty) > 0:
            wanted = (math.atan2(ty, tx) - angle + math.pi) % (2 * math.pi) - math.pi
            most = math.inf if math.isinf(omega) else omega * travelled
            angle += max(-most, min(most, wanted))
        direction = np.array([math.cos(angle), math.sin(angle)])
        before, p = p, p + travelled * direction
        progress = nearest(p, progress, min(progress + look_ahead_m, total))
        if progress >= total - 1e-9:
            done = True
            last = legs[-1] / lengths[-1]
            beyond, forward = float(np.dot(p - route[-1], last)), float(np.dot(direction, last))
            if 0 < beyond < forward * travelled:
                p = before + direction * (travelled - beyond / forward)
        speed = new
        out.append(p.copy())
    return np.array(out)
