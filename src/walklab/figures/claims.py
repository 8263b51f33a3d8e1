"""Ours against published, claim by claim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from matplotlib.transforms import Transform, blended_transform_factory

from walklab.figures.style import DOUBLE_MM, PUBLISHED, SKY, VERMILLION, new_figure, require, styled

# Shape and colour, so that a verdict can be told without colour; none is a model's colour.
VERDICTS: dict[str, tuple[str, str]] = {
    "reproduced": ("o", SKY),
    "partly": ("^", "#F0E442"),
    "not reproduced": ("X", VERMILLION),
    "not checkable": ("s", "white"),
}
ROW_MM = 3.4
LABEL_CHARACTERS = 64  # of a statement on one line; a longer one takes two
TWO_LINES = 1.6  # height of such a row, in rows
# Where the columns stand, as fractions of the figure's width.
SECTION, STATEMENT, MARK, PLOT, STATED, OURS, INTERVAL = 0.006, 0.036, 0.474, (0.487, 0.225), 0.783, 0.84, 0.85
TINY = "< 0.001"
REACH = 4.0  # the ratio axis ends here on both sides; what lies beyond is an arrowhead at its end


@styled
def fig_claims(claims: pd.DataFrame) -> Figure:
    """Every claim: its verdict, and, where both are numbers of one sign, ours as a multiple of the published figure.

    Parameters
    ----------
    claims : DataFrame[id, section, statement, published, ours, ours_low, ours_high, verdict]; ``published`` may be words,
        ours NaN where the claim has no number
    """
    require(claims, ["id", "section", "statement", "published", "ours", "ours_low", "ours_high", "verdict"], "fig_claims")
    rows = claims.reset_index(drop=True)
    statements = ["\n".join(wrap(str(text), LABEL_CHARACTERS)) for text in rows["statement"]]
    heights = np.array([TWO_LINES if "\n" in text else 1.0 for text in statements])
    places = np.cumsum(heights) - heights / 2 - 0.5
    figure = new_figure(DOUBLE_MM, 20 + ROW_MM * heights.sum(), constrained=False)
    height_mm = float(figure.get_size_inches()[1]) * 25.4
    ax = figure.add_axes((PLOT[0], 11 / height_mm, PLOT[1], 1 - 20 / height_mm))
    ax.set(ylim=(heights.sum() - 0.5, -0.5), yticks=[])
    ax.axvline(1.0, color=PUBLISHED, lw=0.9, zorder=1, label="published")
    _ratio_axis(ax)
    across = blended_transform_factory(figure.transFigure, ax.transData)
    for place, height in list(zip(places, heights, strict=True))[1::2]:
        band = Rectangle((0, place - height / 2), 1, height, transform=across, color="#F4F4F4", lw=0, zorder=0, clip_on=False)
        ax.add_patch(band)
    for place, row, ratio in zip(places, rows.to_dict("records"), _ratios(rows), strict=True):
        marker, hue = VERDICTS.get(str(row["verdict"]), ("s", "white"))
        look: dict[str, Any] = {"mfc": hue, "mec": "black", "mew": 0.6, "ms": 5, "zorder": 4, "clip_on": False}
        ax.plot(MARK, place, marker, transform=across, **look)
        if np.isfinite(ratio[0]):
            ax.plot(ratio[1:], [place, place], color="black", lw=0.9, zorder=3)
            shown = float(np.clip(ratio[0], 1 / REACH, REACH))
            outside = "<" if ratio[0] < shown else ">" if ratio[0] > shown else marker
            ax.plot(shown, place, outside, label="ours", **look)
        else:
            ax.text(1.06, place, _no_ratio(row), color=PUBLISHED, va="center", fontsize=6)
    _texts(ax, across, rows, statements, places)
    counts = rows["verdict"].value_counts()
    handles = [
        Line2D([], [], marker=marker, mfc=hue, mec="black", mew=0.6, ms=5, ls="none", label=f"{name} ({counts.get(name, 0)})")
        for name, (marker, hue) in VERDICTS.items()
    ]
    handles.append(Line2D([], [], color=PUBLISHED, lw=0.9, label="published = 1"))
    figure.legend(handles=handles, loc="upper center", ncols=len(handles), handletextpad=0.3, columnspacing=1.2)
    return figure


def _no_ratio(row: Mapping[Any, Any]) -> str:
    """Why a row has no ratio."""
    published = pd.to_numeric(row["published"], errors="coerce")
    if not np.isfinite(published):
        return "no number"
    if not np.isfinite(row["ours"]):
        return "not measured"
    return "published 0" if published == 0 else "ours 0" if row["ours"] == 0 else "opposite signs"


def _ratios(rows: pd.DataFrame) -> np.ndarray:
    """(n, 3) value, low, high over the published number; NaN where a ratio says nothing (words, zero, opposite signs)."""
    published = pd.to_numeric(rows["published"], errors="coerce").to_numpy(dtype=float)
    ours = rows[["ours", "ours_low", "ours_high"]].apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    usable = np.isfinite(published) & (published != 0)
    ratios = np.full(ours.shape, np.nan)
    ratios[usable] = ours[usable] / published[usable, None]
    ratios[:, 1:] = np.sort(ratios[:, 1:], axis=1)
    ratios[~(ratios[:, 0] > 0)] = np.nan
    return ratios


def _ratio_axis(ax: Axes) -> None:
    """A logarithmic axis round 1."""
    ax.set_xscale("log")
    ax.set_xlim(1 / REACH, REACH)
    ax.xaxis.set_major_locator(FixedLocator([0.25, 0.5, 1, 2, 4]))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    ax.set_xlabel("ours / published (1), 95 % interval")
    ax.grid(axis="x")


def _texts(ax: Axes, across: Transform, rows: pd.DataFrame, statements: Sequence[str], places: np.ndarray) -> None:
    """Section and statement to the left of the axes; published and our figure to the right."""

    def write(x: float, y: float, text: str, align: str = "left", size: float = 6.0) -> None:
        ax.text(x, y, text, transform=across, ha=align, va="center", fontsize=size, linespacing=1.05)

    for x, title, align in ((SECTION, "section and claim", "left"), (STATED, "published", "right"), (OURS, "ours", "right")):
        write(x, -1.1, title, align, 6.5)
    write(INTERVAL, -1.1, "95 % interval", size=6.5)
    numeric = pd.to_numeric(rows["published"], errors="coerce").notna()
    for place, statement, number, row in zip(places, statements, numeric, rows.to_dict("records"), strict=True):
        write(SECTION, place, f"{row['section']:g}" if isinstance(row["section"], float) else str(row["section"]))
        write(STATEMENT, place, statement)
        write(STATED, place, str(row["published"]) if number else "in words", "right")
        if np.isfinite(row["ours"]):
            write(OURS, place, _short(row["ours"]), "right")
        if np.isfinite(row["ours_low"]):
            low, high = _short(row["ours_low"]), _short(row["ours_high"])
            tiny = row["ours_low"] >= 0 and 0 < row["ours"] < 0.001 and row["ours_high"] < 0.001
            write(INTERVAL, place, TINY if tiny else f"{low} … {high}")


def _short(value: float) -> str:
    """Three significant digits; of what is smaller than anything that is told apart here, such as a p, only that."""
    return TINY if 0 < value < 0.001 else f"{value:.3g}"
