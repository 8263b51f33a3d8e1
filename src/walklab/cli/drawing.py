"""What ``walklab simulate`` draws: the variants of one walk in plan view, still and moving."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon as Patch

from walklab.figures.style import BLUE, OBSTACLE, style
from walklab.geometry.scene import Scene
from walklab.simulation import DrawnWalks
from walklab.storage import atomic_path

FRAMES_PER_S = 12
LONGEST_ANIMATION_S = 30.0
MARGIN_M = 0.5


def draw_variants(walks: DrawnWalks, scene: Scene, path: str | Path) -> None:
    """PNG: paths of all variants, and the distribution of their travel times."""
    with style():
        figure = Figure(figsize=(7.0, 3.2), layout="constrained")
        plan, times = figure.subplots(1, 2, width_ratios=(3, 2))
        _plan_view(plan, walks, scene)
        for walk in walks.trajectories:
            plan.plot(*walk.positions_m.T, color=BLUE, lw=0.5, alpha=0.25)
        ended = walks.travel_times_s[np.isfinite(walks.travel_times_s)]
        if ended.size:
            times.hist(ended, bins=min(30, max(5, ended.size // 5)), color=BLUE)
        late = len(walks.travel_times_s) - ended.size
        times.set(xlabel="travel time (s)", ylabel="variants", title=f"{late} did not end in time" if late else "")
        with atomic_path(path) as temporary:
            figure.savefig(temporary, dpi=150, format="png")


def animate_variants(walks: DrawnWalks, scene: Scene, path: str | Path) -> None:
    """GIF: all variants walking at once, in real time."""
    with style():
        figure = Figure(figsize=(4.0, 3.2), layout="constrained")
        ax = figure.subplots()
        _plan_view(ax, walks, scene)
        (dots,) = ax.plot([], [], "o", color=BLUE, ms=3, alpha=0.5, mew=0)
        clock = ax.set_title("0.0 s")
        longest_s = min(max(walk.duration_s for walk in walks.trajectories), LONGEST_ANIMATION_S)

        def show(frame: int) -> tuple:
            time_s = frame / FRAMES_PER_S
            at = [walk.positions_m[min(int(time_s / walk.step_s), len(walk.positions_m) - 1)] for walk in walks.trajectories]
            dots.set_data(*np.array(at).T)
            clock.set_text(f"{time_s:.1f} s")
            return dots, clock

        film = FuncAnimation(figure, show, frames=int(longest_s * FRAMES_PER_S) + 2)
        with atomic_path(path) as temporary:
            film.save(temporary, writer=PillowWriter(fps=FRAMES_PER_S), dpi=90)


def _plan_view(ax: Axes, walks: DrawnWalks, scene: Scene) -> None:
    for polygon in scene.obstacles.values():
        ax.add_patch(Patch(np.asarray(polygon.exterior.coords), closed=True, fc=OBSTACLE, ec="#8C8C8C", lw=0.6, zorder=0))
    points = np.concatenate([walks.route_m, *(walk.positions_m for walk in walks.trajectories)])
    (left, bottom), (right, top) = points.min(axis=0) - MARGIN_M, points.max(axis=0) + MARGIN_M
    ax.set(xlim=(left, right), ylim=(bottom, top), aspect="equal", xlabel="x (m)", ylabel="y (m)")
    ax.plot(*walks.route_m[[0, -1]].T, "k+", ms=6)
