"""Two runs side by side: verdicts, scores and cost."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from walklab.figures.style import DOUBLE_MM, FAINT, SET_COLOURS, letter, model_label, new_figure, require, set_label, styled

LARGEST = 14  # rows a panel can hold legibly
LONGEST = 30  # letters of a run's name
BEFORE, AFTER = SET_COLOURS[:2]  # of runs: no model's colour


@styled
def draw_comparison(claims: pd.DataFrame, scores: pd.DataFrame, cost: pd.DataFrame, names: tuple[str, str]) -> Figure:
    """Verdicts of both runs crossed, CRPS of every forecast, wall time of the costliest stages.

    Parameters
    ----------
    claims, scores, cost : tables of :class:`walklab.runs.comparison.Comparison`
    names : how the two runs are called in the figure
    """
    require(cost, ["stage", "before", "after"], "comparison")
    names = shortened(names[0]), shortened(names[1])
    figure = new_figure(DOUBLE_MM, 95)
    verdicts, crps, wall = figure.subplots(1, 3, width_ratios=[0.9, 1, 1])
    _cross(verdicts, claims, names)
    letter(verdicts, 0, "claims by verdict")
    shown = scores[scores["measure"] == "crps_s"].dropna(subset=["before", "after"])
    shown = shown[shown["difference"] != 0].copy()
    shown["label"] = [
        " ".join(filter(None, (model_label(str(row.model)), set_label(str(row.scenario or row.participant)))))
        for row in shown.itertuples()
    ]
    largest = shown.reindex(shown["difference"].abs().sort_values(ascending=False, kind="stable").index)
    _dumbbells(crps, largest, "CRPS (s)", names, "no forecast moved")
    letter(crps, 1, "forecasts that moved most")
    costly = cost.dropna(subset=["before", "after"]).assign(label=cost["stage"].map(set_label))
    _dumbbells(wall, costly.sort_values("before", ascending=False, kind="stable"), "wall time (s)", names)
    letter(wall, 2, "costliest stages")
    handles, labels = wall.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure


def shortened(name: str) -> str:
    """A name that fits beside an axis: of a long one, its end, which tells runs in one folder apart."""
    return name if len(name) <= LONGEST else f"...{name[3 - LONGEST :]}"


def _cross(ax: Axes, claims: pd.DataFrame, names: tuple[str, str]) -> None:
    if claims.empty:
        ax.set_axis_off()
        ax.text(0.5, 0.5, "no claims in these runs", ha="center", va="center", transform=ax.transAxes)
        return
    kinds = sorted({*claims["verdict_before"], *claims["verdict_after"]})
    counts = pd.crosstab(claims["verdict_before"], claims["verdict_after"]).reindex(index=kinds, columns=kinds, fill_value=0)
    ax.imshow(np.eye(len(kinds)), cmap="Greys", vmin=0, vmax=6)
    for (row, column), count in np.ndenumerate(counts.to_numpy()):
        ax.text(column, row, f"{count}" if count else "-", ha="center", va="center")
    ax.set_xticks(range(len(kinds)), kinds, rotation=40, ha="right")
    ax.set_yticks(range(len(kinds)), kinds)
    ax.set_xlabel(f"after: {names[1]}")
    ax.set_ylabel(f"before: {names[0]}")


def _dumbbells(
    ax: Axes, table: pd.DataFrame, label: str, names: tuple[str, str], nothing: str = "nothing that both runs have"
) -> None:
    if table.empty:
        ax.set_axis_off()
        ax.text(0.5, 0.5, nothing, ha="center", va="center", transform=ax.transAxes)
        return
    rows = table.head(LARGEST).iloc[::-1].reset_index(drop=True)
    ax.hlines(rows.index, rows["before"], rows["after"], color=FAINT, lw=1.5)
    ax.plot(rows["before"], rows.index, "o", color=BEFORE, label=f"before: {names[0]}")
    ax.plot(rows["after"], rows.index, "o", color=AFTER, mfc="white", label=f"after: {names[1]}")
    ax.set_yticks(rows.index, rows["label"])
    ax.set_xlim(left=0)
    ax.set_xlabel(label)
