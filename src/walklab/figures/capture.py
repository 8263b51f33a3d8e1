"""What was walked where: figures 3, 4 and 10."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon as Patch

from walklab.errors import InputError
from walklab.figures.style import (
    BLACK,
    DOUBLE_MM,
    OBSTACLE,
    PUBLISHED,
    PUBLISHED_MARK,
    SET_COLOURS,
    SINGLE_MM,
    colour,
    letter,
    model_label,
    new_figure,
    ordered_models,
    require,
    set_label,
    styled,
)
from walklab.geometry.plans import Plan

TRACK: dict[str, Any] = {"linewidths": 0.5, "alpha": 0.15, "colors": BLACK, "rasterized": True}
# Lighter where other walks are drawn over them; darker than an obstacle.
NAME_M = 0.6  # about the width of a short name in a plan view
UNDER = {**TRACK, "alpha": 0.12, "colors": "#8A8A8A"}
ARROW: dict[str, Any] = {"arrowstyle": "-|>,head_width=0.14,head_length=0.28", "color": PUBLISHED, "lw": 0.8}
DASHES: dict[str, Any] = {"Ref": "-", "P_Stat": (0, (4, 1.5)), "P_Adapt": (0, (1, 1)), "P_Prob": "-"}


@styled
def fig03(classes: pd.DataFrame, published_count: int | None = None) -> Figure:
    """Planned distances in classes: shares of each class, and cumulative shares beside the published ones.

    Parameters
    ----------
    classes : DataFrame[dataset, low_m, high_m, share, cumulative_share, published_cumulative_share], shares in
        [0, 1]; ``high_m`` may be infinite in the last class; published shares are NaN where none was stated
    published_count : number of planned walk paths behind the published shares
    """
    require(classes, ["dataset", "low_m", "high_m", "published_cumulative_share"], "fig03", ["share", "cumulative_share"])
    names = list(dict.fromkeys(classes["dataset"]))
    figure = new_figure(SINGLE_MM, 92)
    top, bottom = figure.subplots(2, 1)
    bounds = classes[classes["dataset"] == names[0]].sort_values("low_m")
    labels = [_class_label(low, high) for low, high in zip(bounds["low_m"], bounds["high_m"], strict=True)]
    width = 0.8 / len(names)
    for index, name in enumerate(names):
        rows = classes[classes["dataset"] == name].sort_values("low_m")
        hue = SET_COLOURS[index % len(SET_COLOURS)]
        places = np.arange(len(rows)) + (index - (len(names) - 1) / 2) * width
        top.bar(places, 100 * rows["share"], width=width, color=hue, label=set_label(name))
        closed = rows[np.isfinite(rows["high_m"])]
        upper, share = np.append(0, closed["high_m"]), np.append(0, 100 * closed["cumulative_share"])
        bottom.plot(upper, share, marker="o", ms=3, color=hue, label=set_label(name), zorder=2 - 0.1 * index)
    top.set_xticks(np.arange(len(labels)), labels)
    top.set(xlabel="planned distance (m), upper end included", ylabel="walks (%)")
    stated = bounds[np.isfinite(bounds["published_cumulative_share"])]
    count = "" if published_count is None else f" (n = {published_count})"
    bottom.plot(
        stated["high_m"],
        100 * stated["published_cumulative_share"],
        label=f"published, of a whole plant{count}",
        zorder=5,
        **PUBLISHED_MARK,
    )
    bottom.set(xlabel="planned distance at most (m)", ylabel="walks, cumulative (%)", ylim=(0, 104))
    bottom.grid(axis="y")
    bottom.legend(loc="lower right")
    letter(top, 0)
    letter(bottom, 1)
    return figure


def _class_label(low_m: float, high_m: float) -> str:
    return f"{low_m:g}–{high_m:g}" if np.isfinite(high_m) else f"> {low_m:g}"


@styled
def fig04(walks: pd.DataFrame, samples: pd.DataFrame, plans: Mapping[str, Plan]) -> Figure:
    """Experiment 1: set-ups above, captured trajectories below.

    Parameters
    ----------
    walks : accepted walks, DataFrame[walk, scene, configuration, start_x_m, start_y_m, end_x_m, end_y_m]
    samples : DataFrame[walk, x_m, y_m], rows of a walk in the order of time
    plans : scene -> its plan view, one column of panels each; walks of other scenes are the straight ones,
        drawn side by side, each turned into its own direction of walking
    """
    ends = ["start_x_m", "start_y_m", "end_x_m", "end_y_m"]
    require(walks, ["walk", "scene", "configuration"], "fig04", ends)
    require(samples, ["walk"], "fig04", ["x_m", "y_m"])
    tracks = {name: rows[["x_m", "y_m"]].to_numpy() for name, rows in samples.groupby("walk", sort=False)}
    turns = [scene for scene in plans if (walks["scene"] == scene).any()]
    straight = walks[~walks["scene"].isin(turns)]
    columns = len(turns) + bool(len(straight))
    figure = new_figure(DOUBLE_MM if columns > 2 else SINGLE_MM, 88)
    axes = figure.subplots(2, columns, squeeze=False, sharex="col", sharey="col")
    for column, (scene, limits) in enumerate(zip(turns, _equal_windows(tracks, walks, plans, turns), strict=True)):
        rows = walks[walks["scene"] == scene]
        for ax in axes[:, column]:
            _draw_obstacles(ax, plans[scene])
            ax.set(xlim=limits[0], ylim=limits[1])
            ax.set_aspect("equal", adjustable="box")
        _draw_stations(axes[0, column], plans[scene])
        axes[1, column].add_collection(LineCollection(_known(tracks, list(rows["walk"])), **TRACK))
        letter(axes[0, column], column, set_label(scene) + "°" * scene[-1].isdigit())
    if len(straight):
        _draw_straight(axes[0, -1], axes[1, -1], straight, tracks)
        letter(axes[0, -1], columns - 1, "straight")
    for column in range(len(turns)):
        axes[1, column].set_xlabel("x (m)")
    axes[0, 0].set_ylabel("set-up: y (m)")
    axes[1, 0].set_ylabel("captured: y (m)")
    return figure


def _equal_windows(
    tracks: Mapping[Any, np.ndarray], walks: pd.DataFrame, plans: Mapping[str, Plan], scenes: Sequence[str]
) -> list[np.ndarray]:
    """Limits of each scene's panel, (2, 2) arrays, all of one width so that the panels have one scale."""
    boxes = []
    for scene in scenes:
        stations = [np.array([station.position_m]) for station in plans[scene].stations.values()]
        places = np.concatenate([*_known(tracks, list(walks.loc[walks["scene"] == scene, "walk"])), *stations])
        boxes.append((np.nanmin(places, axis=0), np.nanmax(places, axis=0)))
    half = max((float(np.max(high - low)) for low, high in boxes), default=1.0) / 2 + 0.25
    return [np.stack([(low + high) / 2 - half, (low + high) / 2 + half], axis=1) for low, high in boxes]


def _known(tracks: Mapping[Any, np.ndarray], names: Sequence[Any]) -> list[np.ndarray]:
    found = [tracks[name] for name in names if name in tracks]
    if not found:
        raise InputError("fig04: no samples belong to these walks; pass the two tables of one capture")
    return found


def _draw_obstacles(ax: Axes, plan: Plan, names: bool = False) -> None:
    for name, polygon in plan.scene.obstacles.items():
        ax.add_patch(Patch(np.asarray(polygon.exterior.coords), closed=True, fc=OBSTACLE, ec="#8C8C8C", lw=0.6, zorder=1))
        if names:
            # A name fits along the longer side.
            left, bottom, right, top = polygon.bounds
            turned = 90 if right - left < NAME_M < top - bottom else 0
            at = polygon.representative_point().coords[0]
            ax.annotate(set_label(name), at, ha="center", va="center", fontsize=6, rotation=turned)


def _draw_stations(ax: Axes, plan: Plan) -> None:
    """Where walks start (hollow) and end (filled), each with the direction that is faced."""
    ends = {walk[1] for walk in plan.walks} or {name for name in plan.stations if name.startswith("end")}
    for name, station in plan.stations.items():
        place, angle = np.asarray(station.position_m), np.radians(station.facing_deg)
        ahead = 0.3 * np.array([np.cos(angle), np.sin(angle)])
        tail = place - ahead if name in ends else place
        ax.annotate("", tuple(tail + ahead), tuple(tail), arrowprops=ARROW, annotation_clip=True)
        ax.plot(*place, "o", mfc=BLACK if name in ends else "white", mec=BLACK, ms=3.5, mew=0.8, zorder=5)


def _draw_straight(above: Axes, below: Axes, walks: pd.DataFrame, tracks: Mapping[Any, np.ndarray]) -> None:
    """Straight walks by configuration, one row each, turned so that they run to the right."""
    ends = walks[["start_x_m", "start_y_m", "end_x_m", "end_y_m"]].to_numpy()
    lengths = pd.Series(np.hypot(*(ends[:, 2:] - ends[:, :2]).T))
    order = lengths.groupby(walks["configuration"].to_numpy()).median().sort_values(kind="stable")
    segments = []
    for place, (name, distance) in enumerate(order.items()):
        above.plot([0, distance], [place, place], color=PUBLISHED, lw=0.8, ls=(0, (3, 2)))
        above.plot(0, place, "o", mfc="white", mec=BLACK, ms=4, mew=0.9)
        above.plot(distance, place, "o", color=BLACK, ms=4)
        for _, row in walks[walks["configuration"] == name].iterrows():
            if row["walk"] not in tracks:
                continue
            start = np.array([row["start_x_m"], row["start_y_m"]])
            along = np.array([row["end_x_m"], row["end_y_m"]]) - start
            along = along / max(float(np.linalg.norm(along)), 1e-9)
            moved = tracks[row["walk"]] - start
            # One row is half a metre of sideways movement, so that sway can be seen.
            segments.append(np.column_stack([moved @ along, place + 2 * (moved @ np.array([-along[1], along[0]]))]))
    thin = float(np.clip(10 * len(order) / len(walks), 0.04, TRACK["alpha"]))
    below.add_collection(LineCollection(segments, **{**TRACK, "alpha": thin}))
    below.autoscale_view()
    above.set_yticks(range(len(order)), [f"{distance:.1f} m" for distance in order])
    above.set_ylim(-0.8, len(order) - 0.2)
    below.set(xlabel="along the walk (m)")
    above.tick_params(labelleft=True)


@styled
def fig10(plans: Mapping[str, Plan], captured: Mapping[str, pd.DataFrame], simulated: Mapping[str, pd.DataFrame]) -> Figure:
    """Plan views of the evaluated scenarios with captured trajectories and one simulated walk per model.

    Parameters
    ----------
    plans : scenario -> plan view
    captured : scenario -> DataFrame[walk, x_m, y_m], rows of a walk in the order of time
    simulated : scenario -> DataFrame[model, time_s, x_m, y_m]; model ``Ref`` is the captured walk that was simulated
    """
    if not plans:
        raise InputError("fig10: no plan views; pass one per scenario")
    figure = new_figure(DOUBLE_MM, 92)
    panels = figure.subplots(1, len(plans), squeeze=False)[0]
    shown: list[str] = []
    for index, (ax, (name, plan)) in enumerate(zip(panels, plans.items(), strict=True)):
        if name not in captured or name not in simulated:
            raise InputError(f"fig10: no captured or no simulated walks of {name}; pass both for every plan view")
        require(captured[name], ["walk"], "fig10", ["x_m", "y_m"])
        require(simulated[name], ["model"], "fig10", ["time_s", "x_m", "y_m"])
        _draw_obstacles(ax, plan, names=True)
        tracks = [rows[["x_m", "y_m"]].to_numpy() for _, rows in captured[name].groupby("walk", sort=False)]
        ax.add_collection(LineCollection(tracks, **UNDER))
        shown += _draw_simulated(ax, simulated[name])
        for station, at in plan.stations.items():
            ax.plot(*at.position_m, "s", mfc="white", mec=BLACK, ms=3.5, mew=0.8, zorder=6)
            if station not in plan.scene.obstacles:
                ax.annotate(
                    set_label(station), at.position_m, (0, -12), textcoords="offset points", ha="center", va="top", fontsize=6,
                    zorder=7, bbox={"fc": "white", "ec": "none", "alpha": 0.75, "pad": 0.5},
                )  # fmt: skip
                # Room for the name, below the walks that turn here.
                ax.update_datalim([np.asarray(at.position_m) - [0.0, 0.65]])
        ax.autoscale_view()
        ax.set_aspect("equal", adjustable="datalim")
        ax.set(xlabel="x (m)", ylabel="y (m)")
        letter(ax, index, set_label(name))
    handles = [Line2D([], [], color=UNDER["colors"], lw=0.8, label="captured walks")]
    for model in ordered_models(shown):
        text = "captured walk, re-simulated" if model == "Ref" else model_label(model)
        handles.append(Line2D([], [], color=colour(model), ls=DASHES.get(model, "-"), lw=1.4, marker="o", ms=2.6, label=text))
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), handlelength=2.4)
    return figure


def _draw_simulated(ax: Axes, simulated: pd.DataFrame) -> list[str]:
    """Each model's path, with a dot every half second."""
    models = ordered_models(list(simulated["model"]))
    for depth, model in enumerate(models):
        rows = simulated[simulated["model"] == model]
        # Paths may coincide: what lies below is wider, so that its edges show.
        width = 1.2 if model == "Ref" else 1.0 + 0.9 * (len(models) - 1 - depth)
        ax.plot(rows["x_m"], rows["y_m"], color=colour(model), ls=DASHES.get(model, "-"), lw=width, zorder=3 + 0.1 * depth)
        half_seconds = np.floor(rows["time_s"].to_numpy() / 0.5 + 1e-6)
        dots = rows[np.append(True, np.diff(half_seconds) > 0)]
        ax.plot(dots["x_m"], dots["y_m"], "o", color=colour(model), ms=2.4, zorder=4 + 0.1 * depth)
    return models
