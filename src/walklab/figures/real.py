"""Leave-one-subject-out scores on real or own walks."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from walklab.figures.style import (
    BLACK,
    DOUBLE_MM,
    colour,
    letter,
    model_label,
    new_figure,
    ordered_models,
    require,
    spread,
    styled,
)

PANELS = {
    "crps_s": "CRPS (s)",
    "median_abs_dt_s": "median |Δt| of one draw (s)",
    "coverage_90": "walks inside the 90 % interval (1)",
}


@styled
def fig_scores(scores: pd.DataFrame, summary: pd.DataFrame) -> Figure:
    """Scores per model: one dot per participant, the mean over participants with its interval on top.

    Parameters
    ----------
    scores : DataFrame[participant, model, walks, crps_s, median_abs_dt_s, coverage_90]
    summary : DataFrame[model, and each measure with <measure>_low and <measure>_high]
    """
    require(scores, ["participant", "model", "walks", "coverage_90"], "fig_scores", ["crps_s", "median_abs_dt_s"])
    bounds = [f"{measure}_{end}" for measure in PANELS for end in ("low", "high")]
    require(summary, ["model", *PANELS, *bounds], "fig_scores", ["crps_s"])
    models = ordered_models(list(summary["model"]))
    table = summary.set_index("model")
    figure = new_figure(DOUBLE_MM, 24 + 8.5 * len(models))
    panels = figure.subplots(1, len(PANELS), sharey=True)
    for index, (ax, (measure, label)) in enumerate(zip(panels, PANELS.items(), strict=True)):
        if measure == "coverage_90":
            ax.axvline(0.9, color="black", lw=0.7, ls=(0, (3, 2)), zorder=0)
        for place, model in enumerate(models):
            rows = scores[scores["model"] == model].sort_values("participant")
            heights = place + 0.12 + spread(len(rows), 0.34)
            ax.scatter(rows[measure], heights, s=4 + 2.0 * rows["walks"], color=colour(model), alpha=0.45, linewidths=0, zorder=2)
            value, low, high = (float(table[f"{measure}{end}"][model]) for end in ("", "_low", "_high"))
            ax.plot([low, high], [place - 0.22] * 2, color=BLACK, lw=1.2, zorder=3)
            ax.plot(value, place - 0.22, "D", color=colour(model), mec=BLACK, mew=0.7, ms=4.5, zorder=4, label="ours")
        ax.set(xlabel=label, ylim=(len(models) - 0.5, -0.6))
        ax.set_xlim(left=0) if measure != "coverage_90" else ax.set_xlim(-0.03, 1.03)
        ax.tick_params(axis="y", length=0)
        ax.grid(axis="x")
        letter(ax, index)
    panels[0].set_yticks(range(len(models)), [model_label(model).replace(", ", ",\n") for model in models])
    handles = [
        Line2D([], [], marker="o", color="#888888", ls="none", ms=4, alpha=0.6, label="one participant (area: number of walks)"),
        Line2D([], [], marker="D", color=BLACK, mfc="white", lw=1.2, ms=4.5, label="mean over participants, 95 % interval"),
    ]
    figure.legend(handles=handles, loc="outside upper right", ncols=2)
    return figure
