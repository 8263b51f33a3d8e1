"""How near the method comes to a known distribution of the parameters, on walks made by the planner itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from walklab.figures.style import (
    BLACK,
    DOUBLE_MM,
    FAINT,
    MODEL_COLOURS,
    OTHER_MODEL,
    SKY,
    VERMILLION,
    letter,
    model_label,
    new_figure,
    require,
    styled,
    symbol,
)

GREY = "#555555"
# Model -> colour and line, never another model's colour; what is no reading of the maps is grey.
LINES: dict[str, tuple[str, str]] = {
    "uniform": (FAINT, "-"),
    "P_Prob (literal)": (MODEL_COLOURS["P_Prob"], "-"),
    "P_Prob (one exponent by the scores)": (OTHER_MODEL, "-"),
    "P_Prob (exponent nearest to the truth)": (SKY, "--"),
    "P_Prob, sharpened before blending": (VERMILLION, "-"),
    "true parameters of the neighbours": (GREY, ":"),
    "perfect sample": (GREY, "-."),
}
DRAWN = ("P_Prob (literal)", "P_Prob (one exponent by the scores)", "P_Prob, sharpened before blending")
# Model -> title of its panel, which has no room for the whole name.
BY_TASK = {"P_Prob (one exponent by the scores)": "one exponent", "P_Prob, sharpened before blending": "sharpened first"}
MARKERS = "os^v"  # of the parameters
# Of a parameter, and of a density over it.
UNITS = {"v": ("m/s", "s/m"), "a": ("m/s²", "s²/m"), "omega": ("1/m", "m")}
UNKNOWN = ("its unit", "per its unit")


@styled
def fig_recovery(table: pd.DataFrame, densities: pd.DataFrame) -> Figure:
    """Distances from the known distribution by number of walks and by resolution, and the densities at two tasks.

    Parameters
    ----------
    table : DataFrame[walks, resolution, repetition, task, model, measure, parameter, value]
    densities : DataFrame[task, model, parameter, at, density]; ``known`` among the models; first and last but one task are drawn
    """
    require(table, ["walks", "resolution", "task", "model", "measure", "parameter"], "fig_recovery", ["value"])
    require(densities, ["task", "model", "parameter", "at"], "fig_recovery", ["density"])
    names = list(dict.fromkeys(densities["parameter"]))
    measures = [("ks", name) for name in names] + [("energy", "all")]
    grid, size = _where_most(table, "resolution", "walks"), _where_most(table, "walks", "resolution")
    by_size, by_grid = table[table["resolution"] == grid], table[table["walks"] == size]
    meeting = by_size[(by_size["walks"] == size) & (by_size["measure"] == "ks")]
    tasks = list(dict.fromkeys(densities["task"]))
    shown = [tasks[-1] if len(tasks) < 3 else tasks[2], tasks[-2] if len(tasks) > 3 else tasks[0]]
    figure = new_figure(DOUBLE_MM, 165)
    panels = figure.subplots(4, len(measures))
    for column, (measure, name) in enumerate(measures):
        for row, (rows, along) in enumerate(((by_size, "walks"), (by_grid, "resolution"))):
            ax = panels[row, column]
            _lines(ax, rows[(rows["measure"] == measure) & (rows["parameter"] == name)], along)
            title = f"{symbol(name)}" if measure == "ks" else "all parameters"
            letter(ax, row * len(measures) + column, title)
            ax.set_xlabel("walks learned from (1)" if along == "walks" else "values of each parameter (1)")
            ax.set_ylabel("KS distance (1)" if measure == "ks" else "energy distance (sd)")
            ax.set_ylim(0, 1 if measure == "ks" else None)
    for row, task in enumerate(shown, 2):
        for column, name in enumerate(names):
            ax = panels[row, column]
            _densities(ax, densities[(densities["task"] == task) & (densities["parameter"] == name)])
            letter(ax, row * len(measures) + column, _task_label(task))
            unit, per_unit = UNITS.get(name, UNKNOWN)
            ax.set(xlabel=f"{symbol(name)} ({unit})", ylabel=f"density ({per_unit})")
        model, title = list(BY_TASK.items())[row - 2]
        _by_task(panels[row, -1], meeting[meeting["model"] == model], names)
        letter(panels[row, -1], row * len(measures) + len(names), title)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4)
    panels[2, 0].legend(loc="upper left", fontsize=6)
    return figure


def _where_most(table: pd.DataFrame, column: str, varied: str) -> int:
    """The value of one column at which the other takes most values: where its series was made."""
    return int(str(table.groupby(column)[varied].nunique().idxmax()))


def _task_label(task: str) -> str:
    kind, *numbers = task.split("_")
    return f"straight, {numbers[0]} m" if kind == "straight" else f"turn of {numbers[0]}°, {numbers[-1]} m"


def _lines(ax: Axes, rows: pd.DataFrame, along: str) -> None:
    """Mean over tasks and repetitions per model."""
    means = rows.groupby(["model", along])["value"].mean()
    for model, (shade, dashes) in LINES.items():
        if model in means.index:
            values = means.loc[model].sort_index()
            ax.plot(values.index, values, color=shade, ls=dashes, marker="o", ms=2.2, lw=1.2, label=model_label(model))
    places: Sequence[int] = sorted(rows[along].unique().tolist())
    ax.set_xscale("log")
    ax.set_xticks(places, [str(place) for place in places])
    ax.xaxis.set_minor_locator(NullLocator())
    ax.grid(axis="y")


def _densities(ax: Axes, rows: pd.DataFrame) -> None:
    known = rows[rows["model"] == "known"]
    ax.fill_between(known["at"], 0, known["density"], color=FAINT, lw=0, label="known")
    for model in DRAWN:
        drawn = rows[rows["model"] == model]
        ax.step(drawn["at"], drawn["density"], where="mid", color=LINES[model][0], lw=0.9)
    ax.set(xlim=(float(np.min(rows["at"])), float(np.max(rows["at"]))), ylim=(0, None))


def _by_task(ax: Axes, rows: pd.DataFrame, names: Sequence[str]) -> None:
    """KS distance of every parameter at every task, mean over repetitions."""
    tasks = list(dict.fromkeys(rows["task"]))
    means = rows.groupby(["parameter", "task"])["value"].mean()
    for name, marker in zip(names, MARKERS, strict=False):
        ax.plot(means.loc[name].reindex(tasks), range(len(tasks)), marker, color=BLACK, mfc="white", ms=3.5, label=symbol(name))
    ax.set_yticks(range(len(tasks)), [_task_label(task) for task in tasks], fontsize=6)
    ax.set(xlim=(0, 0.6), ylim=(len(tasks) - 0.5, -0.5), xlabel="KS distance (1)")
    ax.grid(axis="x")
    ax.legend(loc="lower right", fontsize=6, handletextpad=0.1)
