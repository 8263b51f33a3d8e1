"""How real the synthetic capture is: its walks beside recorded ones."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from walklab.figures.style import DOUBLE_MM, SET_COLOURS, letter, new_figure, plain_log_axis, require, spread, styled

SYNTHETIC, RECORDED = SET_COLOURS[0], SET_COLOURS[1]
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
    """Path shape and peak speed by distance; gait and start-up.

    Parameters
    ----------
    values : DataFrame[quantity, group, source, distance_m, value]; group is synthetic, recorded or recorded with spikes
    """
    require(values, ["quantity", "group", "source"], "fig_realism", ["distance_m", "value"])
    figure = new_figure(DOUBLE_MM, 92)
    panels = figure.subplots(2, 4).ravel()
    for index, (quantity, label) in enumerate(BY_DISTANCE.items()):
        _by_distance(panels[index], values[values["quantity"] == quantity])
        panels[index].set_ylabel(label)
        panels[index].set_xlabel("distance (m)")
        letter(panels[index], index)
        if quantity in ("excess_length", "curvature"):
            plain_log_axis(panels[index], 10.0)
    for index, (title, (label, measures)) in enumerate(BY_PERSON.items(), start=len(BY_DISTANCE)):
        _by_person(panels[index], values, measures, 100.0 if "(cm)" in label else 1.0)
        panels[index].set_ylabel(label)
        letter(panels[index], index, title)
    _legend(panels[-1])
    return figure


def _by_distance(ax: Axes, rows: pd.DataFrame) -> None:
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
    ax.set_xticks(ticks, labels)
    ax.tick_params(axis="x", length=0)
    ax.set_xlim(-0.7, ticks[-1] + 1.2)
    ax.set_ylim(0, None)


def _note_absence(ax: Axes, rows: pd.DataFrame) -> None:
    if not rows["group"].str.startswith("recorded").any():
        ax.text(0.5, 0.04, "no recording there", transform=ax.transAxes, ha="center", fontsize=6.5)


def _legend(ax: Axes) -> None:
    ax.set_axis_off()
    ax.plot([], [], color=SYNTHETIC, lw=1.4, label="synthetic: median, quartiles")
    ax.plot([], [], "o", ms=2.6, color=RECORDED, mew=0, label="recorded")
    ax.plot([], [], "o", ms=2.6, mfc="none", mec=RECORDED, mew=0.5, label="recorded, speeds with spikes")
    ax.plot([], [], color="black", lw=1.0, label="median")
    ax.legend(loc="center left", bbox_to_anchor=(-0.15, 0.5))
