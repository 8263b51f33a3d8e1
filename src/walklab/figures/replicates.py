"""Many synthetic populations at a glance: how often each claim held, and the forecasts' scores over populations."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from walklab.figures.claims import VERDICTS
from walklab.figures.forest import forest, forest_legend, forest_of_scores, name_rows
from walklab.figures.style import BLACK, DOUBLE_MM, letter, model_label, new_figure, require, styled

ROW_MM = 3.0
STATEMENT_CHARACTERS = 62
DIFFERENCE = "crps_difference_s"
# The two models whose differences from every other forecast are drawn; the table has those of the others.
COMPARED = ("P_Prob (calibrated)", "P_Prob (extended)")


@styled
def fig_counted_claims(claims: pd.DataFrame) -> Figure:
    """Share of the replicates in which each claim held, with Wilson intervals; claims that no replicate could check are left out.

    Parameters
    ----------
    claims : DataFrame[section, statement, replicates, reproduced, direction_held, each of both with _low and _high]
    """
    ends = [f"{name}_{end}" for name in ("reproduced", "direction_held") for end in ("low", "high")]
    require(claims, ["section", "statement", *ends, "direction_held"], "fig_counted_claims", ["reproduced", "replicates"])
    rows = claims[claims["replicates"] > 0].reset_index(drop=True)
    figure = new_figure(DOUBLE_MM, 20 + ROW_MM * len(rows))
    ax = figure.subplots()
    for place, row in rows.iterrows():
        if int(place) % 2:  # type: ignore[call-overload]
            ax.axhspan(place - 0.5, place + 0.5, color="#F4F4F4", lw=0, zorder=0)  # type: ignore[operator]
        for name, verdict, offset in (("direction_held", "partly", -0.17), ("reproduced", "reproduced", 0.17)):
            if np.isfinite(row[name]):
                marker, hue = VERDICTS[verdict]
                height = place + offset  # type: ignore[operator]
                ax.plot([row[f"{name}_low"], row[f"{name}_high"]], [height] * 2, color=BLACK, lw=0.7, zorder=3)
                share = row[name] / row["replicates"]
                ax.plot(share, height, marker, mfc=hue, mec=BLACK, mew=0.5, ms=3.6, zorder=4, clip_on=False)
    labels = [f"{row['section']}  {_shortened(str(row['statement']))}" for row in rows.to_dict("records")]
    ax.set_yticks(range(len(rows)), labels, fontsize=6)
    ax.tick_params(axis="y", length=0)
    ax.set(xlim=(0, 1), ylim=(len(rows) - 0.4, -0.6), xlabel="share of the populations (1), 95 % Wilson interval")
    ax.grid(axis="x")
    handles = [
        Line2D([], [], marker=VERDICTS[verdict][0], mfc=VERDICTS[verdict][1], mec=BLACK, mew=0.5, ms=4, ls="none", label=label)
        for verdict, label in (
            ("partly", "direction held"),
            ("reproduced", "reproduced: direction and figure, or all of a statement"),
        )
    ]
    figure.legend(handles=handles, loc="outside upper right", ncols=2)
    return figure


def _shortened(text: str) -> str:
    return text if len(text) <= STATEMENT_CHARACTERS else f"{text[: STATEMENT_CHARACTERS - 1].rstrip()}…"


@styled
def fig_pooled_scores(table: pd.DataFrame) -> Figure:
    """CRPS and coverage of every forecast, and the differences of CRPS, as means over replicates with intervals over replicates.

    Parameters
    ----------
    table : DataFrame[scenario, hull, measure, model, information, against, value, low, high]
    """
    require(
        table, ["scenario", "hull", "measure", "model", "information", "against", "low", "high"], "fig_pooled_scores", ["value"]
    )
    rows = table[table["hull"] == "all"]
    scenarios = list(dict.fromkeys(rows["scenario"]))
    models = list(dict.fromkeys(rows[rows["measure"] == "crps_s"]["model"]))
    figure = new_figure(DOUBLE_MM, 22 + 6.0 * len(models))
    panels = figure.subplots(1, 2 + len(COMPARED), sharey=True, width_ratios=(1.1, 1.1, 1, 1))
    for ax, measure in zip(panels[:2], ("crps_s", "coverage_90"), strict=True):
        forest_of_scores(ax, rows[rows["measure"] == measure], measure, models, scenarios)
    for ax, model in zip(panels[2:], COMPARED, strict=True):
        ax.axvline(0, color=BLACK, lw=0.7)
        compared = rows[(rows["measure"] == DIFFERENCE) & (rows["model"] == model)]
        forest(ax, compared, models, scenarios, "against")
        ax.set_xlabel(f"CRPS of {model_label(model)}\nminus that of the row (s)")
    for index, ax in enumerate(panels):
        letter(ax, index)
    name_rows(panels[0], models)
    forest_legend(figure, scenarios)
    return figure
