"""Proper scores of the forecasts of the held-out scenarios: scores, calibration, PIT."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from walklab.figures.forest import forecast_name, forest_legend, forest_of_scores, name_rows
from walklab.figures.style import (
    BLACK,
    DOUBLE_MM,
    SET_COLOURS,
    colour,
    letter,
    model_label,
    new_figure,
    require,
    set_label,
    styled,
)
from walklab.steering.dependencies import DEPENDENCIES

# What a calibration plot can hold: the models in question and the baselines that come nearest.
SHOWN = (
    "P_Stat",
    "P_Prob (literal)",
    "P_Prob (calibrated)",
    "P_Prob (extended)",
    "P_Prob (extended), earlier walks",
    "regression",
    "Gaussian process",
    "log regression, earlier walks",
)
DASHES = {"regression": (0, (4, 1.5)), "Gaussian process": (0, (1, 1.2)), "log regression, earlier walks": (0, (5, 1, 1, 1))}


def line_of(model: str) -> dict[str, object]:
    """Colour and dashes of a model's line."""
    earlier = (0, (2, 1)) if model.startswith("P_") and "earlier" in model else "-"
    return {"color": colour(model), "ls": DASHES.get(model, earlier), "lw": 1.4 if model.startswith("P_Prob") else 1.0}


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
def fig_calibration(table: pd.DataFrame) -> Figure:
    """Nominal against observed coverage per scenario; and how the sharpness was chosen: scores, requirement, law.

    Parameters
    ----------
    table : DataFrame[scenario, model, quantity (coverage, and those of :func:`walklab.evaluation.sharpness_law.law_table`), at,
        value]
    """
    require(table, ["scenario", "model", "quantity", "at"], "fig_calibration", ["value"])
    coverage = table[table["quantity"] == "coverage"]
    scenarios = list(dict.fromkeys(coverage["scenario"]))
    figure = new_figure(DOUBLE_MM, 122)
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.25, 1))[:, 0]
    panels = above.subplots(1, len(scenarios), squeeze=False)[0]
    for index, scenario in enumerate(scenarios):
        ax = panels[index]
        ax.plot([0, 1], [0, 1], color=BLACK, lw=0.6)
        for model in SHOWN:
            rows = coverage[(coverage["scenario"] == scenario) & (coverage["model"] == model)]
            if len(rows):
                ax.plot(rows["at"], rows["value"], label=model_label(model), **line_of(model))
        ax.set(xlim=(0, 1), ylim=(0, 1), xlabel="nominal coverage (1)", ylabel="observed coverage (1)", aspect="equal")
        letter(ax, index, set_label(scenario))
    above.legend(handles=panels[0].get_lines()[1:], loc="outside right center")
    _chosen_sharpness(below.subplots(1, 3), table, len(scenarios))
    return figure


def _chosen_sharpness(panels: Sequence[Axes], table: pd.DataFrame, first: int) -> None:
    """CRPS and coverage of every exponent, what is required, and the law that was chosen."""
    parts = dict(iter(table.groupby("quantity", sort=False)))
    (name,) = (quantity for quantity in parts if str(quantity).startswith("exponent_by_"))
    law, wine = parts[name], colour("P_Prob (calibrated)")
    span = [law["value"].min(), law["value"].max()]
    for number, (scenario, rows) in enumerate(parts["crps_by_exponent"].groupby("scenario", sort=False)):
        shade = BLACK if scenario == "training" else SET_COLOURS[(number - 1) % len(SET_COLOURS)]
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
    scenarios = list(dict.fromkeys(pit["scenario"]))
    models = [model for model in SHOWN if model in set(pit["model"])]
    figure = new_figure(DOUBLE_MM, 22 + 26 * len(scenarios))
    panels = figure.subplots(len(scenarios), len(models), sharex=True, sharey=True, squeeze=False)
    for row, scenario in enumerate(scenarios):
        for column, model in enumerate(models):
            ax = panels[row, column]
            shares = pit[(pit["scenario"] == scenario) & (pit["model"] == model)]
            count = len(shares)
            ax.bar(shares["at"], shares["value"] * count, width=0.95 / count, color=colour(model), lw=0)
            ax.axhline(1, color=BLACK, lw=0.7, ls=(0, (3, 2)))
            ax.set(xlim=(0, 1), xticks=[0, 1])
            if row == 0:
                title = model_label(forecast_name(model)).replace(" with", "\nwith")
                ax.set_title(title.replace(" (", "\n(").replace(", earlier", ",\nearlier"), loc="center", fontsize=6)
            if column == 0:
                ax.set_ylabel(f"{set_label(scenario)}\ndensity (1)")
    figure.supxlabel("probability integral transform of the captured travel time (1)", fontsize=7)
    return figure
