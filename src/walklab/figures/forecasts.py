"""Proper scores of the forecasts of the held-out scenarios: scores, calibration, PIT."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from walklab.figures.forest import forest_legend, forest_of_scores, name_rows
from walklab.figures.style import (
    BLACK,
    DOUBLE_MM,
    SET_COLOURS,
    bold_letter,
    colour,
    letter,
    model_label,
    new_figure,
    require,
    set_label,
    styled,
)
from walklab.steering.dependencies import DEPENDENCIES

COLUMNS = 5  # of the small panels, one per forecast
LEVELS = (50, 80, 90, 95)  # of the intervals whose coverage has an interval in the table of scores


@styled
def fig_forecast_scores(table: pd.DataFrame) -> Figure:
    """CRPS and coverage of the 90 % interval per model and scenario, with intervals over participants.

    Parameters
    ----------
    table : DataFrame[scenario, hull, model, information, crps_s, coverage_90, each with _low and _high]
    """
    ends = [f"{name}_{end}" for name in ("crps_s", "coverage_90") for end in ("low", "high")]
    require(table, ["scenario", "hull", "model", "information", *ends], "fig_forecast_scores", ["crps_s", "coverage_90"])
    rows = table[table["hull"] == "all"]
    scenarios, models = list(dict.fromkeys(rows["scenario"])), list(dict.fromkeys(rows["model"]))
    figure = new_figure(DOUBLE_MM, 22 + 5.6 * len(models))
    panels = figure.subplots(1, 2, sharey=True)
    for index, (ax, measure) in enumerate(zip(panels, ("crps_s", "coverage_90"), strict=True)):
        columns = {measure: "value", f"{measure}_low": "low", f"{measure}_high": "high"}
        forest_of_scores(ax, rows.rename(columns=columns), measure, models, scenarios)
        letter(ax, index)
    name_rows(panels[0], models)
    forest_legend(figure, scenarios)
    return figure


@styled
def fig_calibration(table: pd.DataFrame, scores: pd.DataFrame) -> Figure:
    """Nominal against observed coverage of every forecast; and how the sharpness was chosen: scores, requirement, law.

    Parameters
    ----------
    table : DataFrame[scenario, model, quantity (coverage, and those of :func:`walklab.evaluation.sharpness_law.law_table`), at,
        value]
    scores : DataFrame[scenario, hull, model, coverage_<50, 80, 90, 95>_low and _high (1)]: intervals over participants
    """
    ends = [f"coverage_{level}_{end}" for level in LEVELS for end in ("low", "high")]
    require(table, ["scenario", "model", "quantity", "at"], "fig_calibration", ["value"])
    require(scores, ["scenario", "hull", "model", *ends], "fig_calibration")
    coverage, everyone = table[table["quantity"] == "coverage"], scores[scores["hull"] == "all"]
    models, scenarios = _present(coverage)
    rows = _rows(models)
    figure = new_figure(DOUBLE_MM, 58 + 34 * rows)
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=(34 * rows, 54))[:, 0]
    for ax, model in zip(_small_panels(above, models, scenarios, "95 %, participants resampled"), models, strict=True):
        ax.plot([0, 1], [0, 1], color=BLACK, lw=0.6)
        for number, scenario in enumerate(scenarios):
            curve, bars = (part[(part["scenario"] == scenario) & (part["model"] == model)] for part in (coverage, everyone))
            hue = _scenario_colour(number)
            ax.plot(curve["at"], curve["value"], color=hue, lw=1.2, label=set_label(scenario))
            for level in LEVELS if len(bars) else ():
                # Side by side, so that the bars of the scenarios can be told apart.
                place = level / 100 + 0.012 * (number - (len(scenarios) - 1) / 2)
                ax.plot([place] * 2, bars[[f"coverage_{level}_low", f"coverage_{level}_high"]].iloc[0], color=hue, lw=0.8)
        ax.set(xlim=(0, 1.02), ylim=(0, 1.02), xticks=[0, 0.5, 1], yticks=[0, 0.5, 1], aspect="equal")
    above.supxlabel("nominal coverage (1)", fontsize=7)
    above.supylabel("observed coverage (1)", fontsize=7)
    above.suptitle(f"{bold_letter(0)}  every forecast", x=0.005, ha="left", fontsize=7.5)
    _chosen_sharpness(below.subplots(1, 3), table, 1)
    return figure


def _present(rows: pd.DataFrame) -> tuple[list[str], list[str]]:
    """Forecasts and scenarios in the table's order."""
    return list(dict.fromkeys(rows["model"])), list(dict.fromkeys(rows["scenario"]))


def _rows(models: list[str]) -> int:
    """Rows of small panels; one place more than there are forecasts, for the legend."""
    return -(-(len(models) + 1) // COLUMNS)


def _scenario_colour(number: int) -> str:
    return SET_COLOURS[number % len(SET_COLOURS)]


def _small_panels(figure: FigureBase, models: list[str], scenarios: list[str], bars: str = "") -> list[Axes]:
    """A panel per forecast, all with the same axes, titled by its name; the colours' legend in the place after the last."""
    grid = figure.subplots(_rows(models), COLUMNS, sharex=True, sharey=True, squeeze=False).ravel()
    for number, ax in enumerate(grid):
        if number < len(models):
            title = model_label(models[number]).replace(" with", "\nwith").replace(", earlier", ",\nearlier")
            ax.set_title(title, loc="center", fontsize=6.5, linespacing=1.0)
            ax.xaxis.set_tick_params(labelbottom=number + COLUMNS >= len(models))
        else:
            ax.set_axis_off()
    keys = [Line2D([], [], color=_scenario_colour(n), lw=1.6, label=set_label(name)) for n, name in enumerate(scenarios)]
    if bars:
        keys.append(Line2D([], [], color=BLACK, lw=0.8, marker="|", ms=6, mew=0.8, ls="none", label=bars))
    legend = grid[len(models)].legend(handles=keys, loc="center left")
    legend.set_in_layout(False)  # it may reach over the empty places beside it
    return list(grid[: len(models)])


def _chosen_sharpness(panels: Sequence[Axes], table: pd.DataFrame, first: int) -> None:
    """CRPS and coverage of every exponent, what is required, and the law that was chosen."""
    parts = dict(iter(table.groupby("quantity", sort=False)))
    (name,) = (quantity for quantity in parts if str(quantity).startswith("exponent_by_"))
    law, wine = parts[name], colour("P_Prob (calibrated)")
    span = [law["value"].min(), law["value"].max()]
    for number, (scenario, rows) in enumerate(parts["crps_by_exponent"].groupby("scenario", sort=False)):
        shade = BLACK if scenario == "training" else _scenario_colour(number - 1)
        panels[0].plot(rows["at"], rows["value"], "o-", color=shade, ms=2.5, label=set_label(str(scenario)))
    held = parts["coverage_by_exponent"]
    panels[1].plot(held["at"], held["value"], "o-", color=BLACK, ms=2.5, label="training")
    required = float(parts["required_coverage"]["value"].iloc[0])
    panels[1].axhline(required, color=BLACK, lw=0.8, ls=(0, (3, 2)), label="required in training")
    for ax, measure in zip(panels, ("crps_of_law", "coverage_of_law"), strict=False):
        # A law is no single exponent: it spans those that it gives to training walks.
        value = float(parts[measure]["value"].iloc[0])
        ax.plot(span, [value] * 2, color=wine, lw=1.8, marker="|", ms=7, label="law, nested")
        ax.set(xscale="log", xlabel="exponent of the suitability (1)")
        ax.set_xticks([1, 3, 10, 30, 80], ["1", "3", "10", "30", "80"], minor=False)
        ax.xaxis.set_minor_locator(NullLocator())
        ax.legend()
    panels[0].set(ylabel="CRPS (s)", ylim=(0, None))
    panels[1].set(ylabel="inside the 90 % interval (1)", ylim=(min(0.4, float(held["value"].min())), 1.0))
    dependency = DEPENDENCIES[str(name).removeprefix("exponent_by_")]
    panels[2].plot(law["at"], law["value"], color=wine, drawstyle="steps-mid", lw=1.4)
    panels[2].set(xlabel=f"{dependency.name.replace('_', ' ')} ({dependency.unit})", ylabel="exponent (1)", ylim=(0, None))
    for index, (ax, title) in enumerate(zip(panels, ("by the scores", "by coverage", "the law"), strict=True)):
        letter(ax, first + index, title)


@styled
def fig_pit(table: pd.DataFrame) -> Figure:
    """Histograms of the probability integral transform: level where the forecast is calibrated.

    Parameters
    ----------
    table : DataFrame[scenario, model, quantity (pit), at (middle of the bin), value (share of the walks)]
    """
    require(table, ["scenario", "model", "quantity", "at"], "fig_pit", ["value"])
    pit = table[table["quantity"] == "pit"]
    models, scenarios = _present(pit)
    figure = new_figure(DOUBLE_MM, 10 + 28 * _rows(models))
    for ax, model in zip(_small_panels(figure, models, scenarios), models, strict=True):
        ax.axhline(1, color=BLACK, lw=0.7, ls=(0, (3, 2)))
        for number, scenario in enumerate(scenarios):
            shares = pit[(pit["scenario"] == scenario) & (pit["model"] == model)]
            count = len(shares)
            edges = [i / count for i in range(count + 1)]
            ax.stairs(shares["value"] * count, edges, baseline=None, color=_scenario_colour(number), lw=1.2)
        ax.set(xlim=(0, 1), xticks=[0, 0.5, 1])
    figure.axes[0].set_ylim(bottom=0)
    figure.supxlabel("probability integral transform of the captured travel time (1)", fontsize=7)
    figure.supylabel("density (1)", fontsize=7)
    return figure
