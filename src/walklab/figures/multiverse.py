"""The specification curve: how the main claims depend on what the paper leaves open and on uncertain constants."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from numpy.typing import NDArray

from walklab.figures.style import (
    BLACK,
    DOUBLE_MM,
    FAINT,
    SET_COLOURS,
    letter,
    model_label,
    new_figure,
    require,
    set_label,
    styled,
)
from walklab.multiverse.choices import READINGS

# Claim (with {} for the scenario) -> title of its column.
EFFECTS = {
    "median_reduction_{}_p_stat_to_p_adapt": f"median |dt|\n{model_label('P_Stat')} to\n{model_label('P_Adapt')}",
    "median_reduction_{}_p_adapt_to_p_prob": f"median |dt|\n{model_label('P_Adapt')} to\n{model_label('P_Prob')}",
    "median_reduction_{}_p_stat_to_p_prob": f"median |dt|\n{model_label('P_Stat')} to\n{model_label('P_Prob')}",
    "crps_reduction_{}_p_stat_to_p_prob_calibrated": (
        f"CRPS\n{model_label('P_Stat')} + residuals to\n{model_label('P_Prob (calibrated)')}"
    ),
}
PLACE = "place_"
LOW, HIGH = "#01665E", "#A6611A"  # ends of a constant's range (ColorBrewer BrBG): no model's and no scenario's colour
FAR_BELOW = -1.5
TICKS = (-32, -16, -8, -4, -2, -1, -0.5, 0, 0.5)
Places = NDArray[np.int64]
DOTS_MM, CURVE_MM = 2.35, 44.0


@styled
def fig_specification_curve(claims: pd.DataFrame, specifications: pd.DataFrame, scenarios: Sequence[str]) -> Figure:
    """Sorted effects above, what each specification chose below.

    One column per effect: the relative reduction of an error from one model to the next, above zero where the second is better.
    Specifications are sorted by the effect in the first scenario; the second scenario's effects stand at the same places.

    Parameters
    ----------
    claims : DataFrame[specification, claim, ours, ours_low, ours_high, held]
    specifications : DataFrame[specification, kind, outcome, a column per ambiguity, ``place_<uncertainty>``]
    scenarios : names; the first one sorts
    """
    require(claims, ["specification", "claim", "ours_low", "ours_high", "held"], "fig_specification_curve", ["ours"])
    require(specifications, ["specification", "kind", "outcome"], "fig_specification_curve")
    table = specifications[specifications["outcome"] == "ran"].set_index("specification")
    lost = len(specifications) - len(table)
    labels = _row_labels(specifications)
    figure = new_figure(DOUBLE_MM, CURVE_MM + DOTS_MM * len(labels) + 16)
    panels = figure.subplots(2, len(EFFECTS), sharex="col", height_ratios=[CURVE_MM, DOTS_MM * len(labels)], squeeze=False)
    for column, (pattern, title) in enumerate(EFFECTS.items()):
        effects = [_effect(claims, pattern.format(scenario), table.index) for scenario in scenarios]
        order = effects[0]["ours"].sort_values(kind="stable").index
        top, dots = panels[:, column]
        default = np.flatnonzero(table.loc[order, "kind"] == "default")
        _curve(top, [effect.loc[order] for effect in effects], scenarios, default)
        _dots(dots, table.loc[order], labels)
        letter(top, column, title)
        top.set_ylabel("relative reduction (1)")
        if column == 0:
            dots.set_yticks(range(len(labels)), [text for _, _, text in labels], fontsize=6)
        else:
            dots.set_yticks([])
    figure.supxlabel(
        f"{len(table)} specifications, sorted by the effect in {set_label(scenarios[0])}"
        + (f"; {lost} more could not be run" if lost else ""),
        fontsize=7,
    )
    figure.legend(handles=_legend(scenarios), loc="outside upper right", ncols=6)
    return figure


def _effect(claims: pd.DataFrame, claim: str, names: pd.Index) -> pd.DataFrame:
    """(specifications,) rows of a claim; NaN where a specification could not decide it."""
    rows = claims[claims["claim"] == claim].set_index("specification")
    return rows.reindex(names)


def _curve(ax: Axes, effects: list[pd.DataFrame], scenarios: Sequence[str], default: Places) -> None:
    at = np.arange(len(effects[0]))
    first = effects[0]
    ax.vlines(at, first["ours_low"], first["ours_high"], color=FAINT, lw=0.5, zorder=1)
    ax.axhline(0, color=BLACK, lw=0.7, zorder=2)
    for number, (effect, scenario) in enumerate(zip(effects, scenarios, strict=True)):
        shade = SET_COLOURS[number % len(SET_COLOURS)]
        ax.plot(at, effect["ours"], ".", color=shade, ms=3.2, mew=0, zorder=3)
        ax.plot(at[default], effect["ours"].iloc[default], "D", mfc="white", mec=shade, ms=3.5, zorder=4)
        known = effect["held"].dropna()
        ax.text(
            0.02, 0.97 - 0.085 * number, f"{set_label(scenario)}: {int(known.sum())} of {len(known)} above 0",
            transform=ax.transAxes, va="top", fontsize=6, zorder=6, bbox={"fc": "white", "ec": "none", "pad": 0.6},
        )  # fmt: skip
    # The limits are set by the effects, not by their intervals.
    values = np.concatenate([[0.0], *(effect["ours"].dropna().to_numpy(dtype=float) for effect in effects)])
    low, high = values.min(), values.max()
    room = max(high - low, 0.01)
    if low < FAR_BELOW:
        # A reduction cannot exceed 1, but has no end below: there the scale is logarithmic.
        ax.set_yscale("symlog", linthresh=0.5)
        ax.yaxis.set_major_locator(FixedLocator(TICKS))
        ax.yaxis.set_minor_locator(NullLocator())
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        ax.set_ylim(1.1 * low, max(6.0, 8 * high))  # room for the counts
    else:
        ax.set_ylim(low - 0.05 * room, high + 0.3 * room)
    ax.grid(axis="y")


def _row_labels(specifications: pd.DataFrame) -> list[tuple[str, str, str]]:
    """(column, reading, text) of each row of dots: all readings of each ambiguity that varies, then the uncertain constants."""
    default = specifications[specifications["kind"] == "default"].iloc[0]
    rows = []
    for name in (name for name in READINGS if name in specifications):
        readings = list(dict.fromkeys(specifications[name].astype(str)))
        if len(readings) > 1:
            rows += [(str(name), value, _text(str(name), value, value == str(default[name]))) for value in readings]
    varied = [str(name) for name in specifications if str(name).startswith(PLACE) and specifications[name].notna().any()]
    return rows + [(name, "", name.removeprefix(PLACE).replace("_", " ")) for name in varied]


def _text(name: str, value: str, default: bool) -> str:
    words = {"True": "yes", "False": "no"}.get(value, value).replace("_", " ")
    return f"{name.replace('_', ' ')}: {words}{' *' if default else ''}"


def _dots(ax: Axes, table: pd.DataFrame, labels: list[tuple[str, str, str]]) -> None:
    defaults = table[table["kind"] == "default"]
    at = np.arange(len(table))
    for row, (column, reading, _) in enumerate(labels):
        if column.startswith(PLACE):
            place = table[column].to_numpy(dtype=float)
            for side, shade in ((place < 1 / 3, LOW), (place > 2 / 3, HIGH), ((place >= 1 / 3) & (place <= 2 / 3), FAINT)):
                ax.plot(at[side], np.full(side.sum(), row), ".", color=shade, ms=2.4, mew=0)
            continue
        chosen = (table[column].astype(str) == reading).to_numpy()
        own = len(defaults) > 0 and str(defaults[column].iloc[0]) == reading
        ax.plot(at[chosen], np.full(chosen.sum(), row), ".", color=FAINT if own else BLACK, ms=2.0 if own else 3.0, mew=0)
    for row in range(1, len(labels)):
        if labels[row][0].startswith(PLACE) != labels[row - 1][0].startswith(PLACE) or (
            labels[row][0] != labels[row - 1][0] and not labels[row][0].startswith(PLACE)
        ):
            ax.axhline(row - 0.5, color=FAINT, lw=0.4)
    ax.set(ylim=(len(labels) - 0.4, -0.6), xlim=(-1, len(table)), xticks=[])
    ax.tick_params(axis="y", length=0)


def _legend(scenarios: Sequence[str]) -> list[Line2D]:
    marks = [
        Line2D([], [], marker=".", ls="none", color=SET_COLOURS[number % len(SET_COLOURS)], label=set_label(scenario))
        for number, scenario in enumerate(scenarios)
    ]
    marks.append(Line2D([], [], color=FAINT, lw=1, label=f"95 % interval, {set_label(scenarios[0])}"))
    marks.append(Line2D([], [], marker="D", ls="none", mfc="white", mec=BLACK, ms=3.5, label="default (*)"))
    marks.append(Line2D([], [], marker=".", ls="none", color=LOW, label="low third of a range"))
    marks.append(Line2D([], [], marker=".", ls="none", color=HIGH, label="high third"))
    return marks
