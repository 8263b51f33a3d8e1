"""How real the synthetic capture is: its walks beside recorded ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from walklab.figures.style import DOUBLE_MM, SET_COLOURS, letter, new_figure, plain_log_axis, require, spread, styled

SYNTHETIC, RECORDED = SET_COLOURS[0], SET_COLOURS[1]
PROFILES = {"start_profile": "start", "stop_profile": "stop"}
SHOWN_SPEED_M_S = 2.6  # just above the fastest gait: what lies beyond is a spike of the recording, and is counted
SPIKED = "recorded, subjects with spikes"
BY_DISTANCE = {
    "lateral_excursion": "lateral excursion (m)",
    "excess_length": "excess length (%)",
    "curvature": "mean curvature (1/m)",
    "peak_speed": "peak speed (m/s)",
}
# Panel -> (axis label, its measures in order).
BY_PERSON = {
    "speed swing": ("SD within a step (% of speed)", {"speed_swing": ""}),
    "lateral sway": ("SD within a stride (cm)", {"lateral_sway": ""}),
    "rise and fall of speed": ("10 % to 90 % of peak (s)", {"rise_time": "rise", "fall_time": "fall"}),
}


@styled
def fig_realism(values: pd.DataFrame) -> Figure:
    """Path shape and peak speed by distance; gait, and how speed rises and falls.

    Parameters
    ----------
    values : DataFrame[quantity, group, source, at (of profiles), distance_m, value]; group is synthetic, recorded or recorded
        with spikes
    """
    require(values, ["quantity", "group", "source", "at"], "fig_realism", ["distance_m", "value"])
    figure = new_figure(DOUBLE_MM, 98)
    panels = figure.subplots(2, 4).ravel()
    for index, (quantity, label) in enumerate(BY_DISTANCE.items()):
        note = _by_distance(panels[index], values[values["quantity"] == quantity])
        panels[index].set_ylabel(label)
        panels[index].set_xlabel("distance (m)")
        letter(panels[index], index, note)
        if quantity in ("excess_length", "curvature"):
            plain_log_axis(panels[index], 10.0)
    for index, (title, (label, measures)) in enumerate(BY_PERSON.items(), start=len(BY_DISTANCE)):
        _by_person(panels[index], values, measures, 100.0 if "(cm)" in label else 1.0)
        panels[index].set_ylabel(label)
        letter(panels[index], index, title)
    _profiles(panels[-1], values)
    letter(panels[-1], len(panels) - 1, "speed at start and stop")
    _legend(figure)
    return figure


def _by_distance(ax: Axes, rows: pd.DataFrame) -> str:
    """Synthetic quartiles and recorded points; returns what the axis leaves out."""
    ours = rows[rows["group"] == "synthetic"]
    # The synthetic walks were made at multiples of half a metre and end up near them.
    groups = ours.groupby((ours["distance_m"] * 2).round() / 2)["value"]
    at = groups.median().index.to_numpy()
    ax.fill_between(at, groups.quantile(0.25), groups.quantile(0.75), color=SYNTHETIC, alpha=0.45, lw=0, zorder=3)
    ax.plot(at, groups.median(), color=SYNTHETIC, lw=1.4, zorder=4)
    for group, face in ((SPIKED, "none"), ("recorded", RECORDED)):
        theirs = rows[rows["group"] == group]
        ax.plot(theirs["distance_m"], theirs["value"], "o", ms=2.2, mfc=face, mec=RECORDED, mew=0.5, alpha=0.8)
    _note_absence(ax, rows)
    ax.set_xlim(0, None)
    ax.set_ylim(0, None)
    if set(rows["quantity"]) == {"peak_speed"} and (beyond := int((rows["value"] > SHOWN_SPEED_M_S).sum())):
        ax.set_ylim(0, SHOWN_SPEED_M_S)
        return f"{beyond} beyond {SHOWN_SPEED_M_S} m/s"
    return ""


def _by_person(ax: Axes, values: pd.DataFrame, measures: dict[str, str], scale: float) -> None:
    ticks, labels = [], []
    for number, (measure, name) in enumerate(measures.items()):
        rows = values[values["quantity"] == measure]
        for side, (group, colour) in enumerate((("synthetic", SYNTHETIC), ("recorded", RECORDED))):
            shown = scale * rows.loc[rows["group"] == group, "value"].to_numpy()
            place = 2.4 * number + side
            ax.plot(place + spread(len(shown), 0.5), shown, "o", ms=2.2, color=colour, mew=0, alpha=0.6)
            if len(shown) > 1:
                ax.plot([place - 0.32, place + 0.32], [np.median(shown)] * 2, color="black", lw=1.0)
        ticks.append(2.4 * number + 0.5)
        labels.append(name)
    _note_absence(ax, values[values["quantity"].isin(list(measures))])
    if len(measures) == 1:
        ticks, labels = [0, 1], ["synthetic", "recorded"]
    ax.set_xticks(ticks, labels)
    ax.tick_params(axis="x", length=0)
    ax.set_xlim(-0.7, 2.4 * len(measures) - 0.7)
    ax.set_ylim(0, None)


def _note_absence(ax: Axes, rows: pd.DataFrame) -> None:
    if not rows["group"].str.startswith("recorded").any():
        ax.text(0.5, 0.04, "no recording there", transform=ax.transAxes, ha="center", fontsize=6.5)


def _profiles(ax: Axes, values: pd.DataFrame) -> None:
    """Speed over its top between a tenth and nine tenths of it: up at the start, down at the stop."""
    for number, name in enumerate(PROFILES):
        rows = values[values["quantity"] == name]
        # A stop was measured backwards in time.
        rows = rows.assign(at=1.3 + 1 - rows["at"] if number else rows["at"])
        ours = rows[rows["group"] == "synthetic"].groupby("at")["value"]
        at = ours.median().index.to_numpy()
        ax.fill_between(at, ours.quantile(0.25), ours.quantile(0.75), color=SYNTHETIC, alpha=0.45, lw=0)
        ax.plot(at, ours.median(), color=SYNTHETIC, lw=1.4)
        theirs = rows[rows["group"] == "recorded"].groupby("at")["value"].median()
        ax.plot(theirs.index, theirs, color=RECORDED, lw=1.2)
    _note_absence(ax, values[values["quantity"].isin(list(PROFILES))])
    ax.set(xlabel="share of rise, of fall (1)", ylabel="speed / top speed (1)", ylim=(0, 1))
    ax.set_xticks([0, 1, 1.3, 2.3], ["0", "1", "0", "1"])


def _legend(figure: Figure) -> None:
    dot: dict[str, Any] = {"marker": "o", "ls": "none", "ms": 2.6, "mew": 0.5}
    handles = [
        Line2D([], [], color=SYNTHETIC, lw=1.4, label="synthetic: median, quartiles"),
        Line2D([], [], color=SYNTHETIC, label="synthetic walk", **dot),
        Line2D([], [], color=RECORDED, label="recorded walk", **dot),
        Line2D([], [], color=RECORDED, mfc="none", label="recorded, speeds with spikes", **dot),
        Line2D([], [], color=RECORDED, lw=1.2, label="recorded (one person)"),
        Line2D([], [], color="black", lw=1.0, label="median"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), handletextpad=0.4, columnspacing=1.0)
