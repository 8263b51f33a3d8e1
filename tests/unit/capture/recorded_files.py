"""Miniature files in the formats of the recordings of real people, made up."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from walklab.capture.recording_files import FEET, GOAL_DIRECTED

ARC_M = 0.1  # lateral excursion of every made-up goal-directed walk, at its middle


def write_goal_directed(root: Path, starts: dict[str, tuple[float, float]], samples: int = 200) -> None:
    """Walks on shallow parabolas to the origin; subject s reaches a peak speed of 1 + s / 100 m/s, subject 9 a spike of 5."""
    share = np.linspace(0, 1, samples)
    stacks = {}
    for name, start in starts.items():
        towards = -np.array(start)
        left = np.array([-towards[1], towards[0]]) / np.hypot(*towards)
        path = np.array(start) + share[:, None] * towards + (4 * ARC_M * share * (1 - share))[:, None] * left
        stack = np.zeros((11, 6, samples), dtype=np.float32)
        stack[:, 0], stack[:, 1] = path.T
        for subject in range(11):
            stack[subject, 2] = (5.0 if subject == 9 else 1 + subject / 100) * np.sin(np.pi * share)
        stacks[name] = stack
    target = root / GOAL_DIRECTED
    target.parent.mkdir(parents=True, exist_ok=True)
    np.savez(target, StartAndEnd=np.zeros((1, 4), dtype=np.float32), **stacks)


def write_feet(root: Path, speed_m_s: float = 1.25, ramp_s: float = 1.5, cruise_s: float = 15.0, rate_hz: float = 100.0) -> None:
    """Both feet moved as one: standing, linear ramp, cruise there, turn, back, linear ramp, standing; millimetres."""
    still = np.zeros(round(2 * rate_hz))
    up = np.linspace(0, speed_m_s, round(ramp_s * rate_hz))
    flat = np.full(round(cruise_s / 2 * rate_hz), speed_m_s)
    speed = np.concatenate([still, up, flat, -flat, -up[::-1], still])
    x = 1000 * np.cumsum(speed) / rate_hz
    markers = ("L_TOE", "R_TOE")
    columns = [(marker, axis) for marker in markers for axis in "xyz"]
    lines = ["," + ",".join(marker for marker, _ in columns), "," + ",".join(axis for _, axis in columns)]
    side = {"L_TOE": 100.0, "R_TOE": -100.0}
    lines += [
        ",".join([str(row), *(repr(float({"x": value, "y": side[marker], "z": 40.0}[axis])) for marker, axis in columns)])
        for row, value in enumerate(x)
    ]
    target = root / FEET
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text("\n".join(lines) + "\n")
