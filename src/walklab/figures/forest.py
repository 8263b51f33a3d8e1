"""Forest plots: a row per forecast, a marker and an interval per scenario."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from walklab.figures.style import BLACK, FAINT, colour, model_label, set_label

ORACLE = "best cell of the walk's own map"
MARKERS = "os^v"
GOAL = (0.86, 0.94)  # of the 90 % interval
LABELS = {"crps_s": "CRPS (s)", "coverage_90": "walks inside the\n90 % interval (1)"}


def forest(ax: Axes, rows: pd.DataFrame, models: list[str], scenarios: list[str], column: str = "model") -> None:
    """A line from low to high and a marker at the value, at the height of the row's model.

    Parameters
    ----------
    rows : DataFrame[scenario, information, value, low, high and ``column``]
    models, scenarios : in the order in which they are drawn
    column : names the model of a row; of ``against`` what it knows is not shown
    """
    offsets = dict(zip(scenarios, 0.32 * (np.arange(len(scenarios)) - (len(scenarios) - 1) / 2), strict=True))
    for row in rows.to_dict("records"):
        model, height = row[column], models.index(row[column]) + offsets[row["scenario"]]
        ax.plot([row["low"], row["high"]], [height] * 2, color=colour(model), lw=1.1)
        fill = colour(model) if row["information"] == "task" or column == "against" else "white"
        ax.plot(row["value"], height, MARKERS[scenarios.index(row["scenario"]) % 4], color=colour(model), mfc=fill, ms=3.8)
    ax.tick_params(axis="y", length=0)
    ax.grid(axis="x")


def forest_of_scores(ax: Axes, rows: pd.DataFrame, measure: str, models: list[str], scenarios: list[str]) -> None:
    """CRPS, or coverage of the 90 % interval with its goal, of all forecasts; a single time has no interval."""
    if measure == "coverage_90":
        ax.axvspan(*GOAL, color=FAINT, alpha=0.5, lw=0)
        ax.axvline(0.9, color=BLACK, lw=0.7, ls=(0, (3, 2)))
        rows = rows[rows["model"] != ORACLE]
    forest(ax, rows, models, scenarios)
    if measure == "crps_s":
        ax.set_xlim(left=0)
    ax.set_xlabel(LABELS[measure])


def name_rows(ax: Axes, models: list[str]) -> None:
    """The forecasts' names at the left, the first on top."""
    names = ["best cell of own map (oracle)" if model == ORACLE else model_label(model) for model in models]
    ax.set_yticks(range(len(models)), names)
    ax.set_ylim(len(models) - 0.4, -0.6)


def forest_legend(figure: Figure, scenarios: list[str]) -> None:
    """Which marker is which scenario, and what a hollow one means."""
    styles = [(MARKERS[number % 4], BLACK, set_label(scenario)) for number, scenario in enumerate(scenarios)]
    styles.append(("o", "white", "knows earlier walks, or the walk"))
    handles = [
        Line2D([], [], marker=marker, color=BLACK, mfc=fill, ls="none", ms=4, label=label) for marker, fill, label in styles
    ]
    figure.legend(handles=handles, loc="outside upper right", ncols=len(handles))
