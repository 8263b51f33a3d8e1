"""Writes examples/own_walks.csv: what a file of one's own walks looks like.

The walks are invented (smooth straight and bent paths, a comfortable pace per person, standing sway and sensor
noise) and prove nothing about people; they show the format and let a test run the whole chain.

    python examples/make_own_walks.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE_HZ = 25.0
STANDING_S = 0.8
PEOPLE = {"anna": (1.66, 1.30), "ben": (1.83, 1.42), "carla": (1.72, 1.18), "dev": (1.78, 1.36)}  # height (m), pace (m/s)
WALKS = {"near": (1.6, 0.0), "straight": (2.8, 0.0), "far": (3.8, 0.0), "left": (3.0, 0.25), "right": (3.4, -0.3)}  # length, bow


def one_walk(length_m: float, bow_m: float, pace_m_s: float, rng: np.random.Generator) -> np.ndarray:
    """Positions every 1 / RATE_HZ: stand, walk with a smooth start and stop, stand."""
    duration_s = 0.9 + length_m / pace_m_s * rng.normal(1.0, 0.04)
    moving = np.clip((np.arange(0, duration_s + 2 * STANDING_S, 1 / RATE_HZ) - STANDING_S) / duration_s, 0, 1)
    # A trapezium of speed with smoothed corners: the share of the way done at each share of the time.
    ramp = np.interp(np.linspace(0, 1, 201), [0, 0.25, 0.75, 1], [0, 1, 1, 0])
    ramp = np.convolve(np.pad(ramp, 20, mode="edge"), np.hanning(41) / np.hanning(41).sum(), mode="valid")
    ramp[[0, -1]] = 0
    done = np.interp(moving, np.linspace(0, 1, 201), np.concatenate([[0], np.cumsum(ramp[1:] + ramp[:-1])]) / (2 * ramp.sum()))
    path = np.column_stack([length_m * done, bow_m * np.sin(np.pi * done)])
    return path + rng.normal(0, 0.0003, path.shape)


def main() -> None:
    rng = np.random.default_rng(20170)
    lines = ["person,walk,time_s,x_m,y_m,height_cm"]
    for person, (height_m, pace_m_s) in PEOPLE.items():
        for walk, (length_m, bow_m) in WALKS.items():
            points = one_walk(length_m, bow_m, pace_m_s, rng)
            lines += [
                f"{person},{walk},{index / RATE_HZ:.2f},{x:.4f},{y:.4f},{100 * height_m:.0f}"
                for index, (x, y) in enumerate(points)
            ]
    Path(__file__).with_name("own_walks.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
