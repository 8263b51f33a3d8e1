"""Ours against published, claim by claim."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from walklab.figures.style import DOUBLE_MM, PUBLISHED, SKY, VERMILLION, new_figure, require, styled

# Shape and colour, so that a verdict can be told without colour; none is a model's colour.
VERDICTS: dict[str, tuple[str, str]] = {
    "reproduced": ("o", SKY),
    "partly": ("^", "#F0E442"),
    "not reproduced": ("X", VERMILLION),
    "not checkable": ("s", "white"),
}
ROW_MM = 3.4
LABEL_CHARACTERS = 56
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
    ratios = _ratios(rows)
    figure = new_figure(DOUBLE_MM, 20 + ROW_MM * len(rows), constrained=False)
    height = float(figure.get_size_inches()[1]) * 25.4
    ax = figure.add_axes((0.435, 11 / height, 0.26, 1 - 20 / height))
    ax.set(ylim=(len(rows) - 0.5, -0.5))
    ax.axvline(1.0, color=PUBLISHED, lw=0.9, zorder=1, label="published")
    for place, (verdict, (value, low, high)) in enumerate(zip(rows["verdict"], ratios, strict=True)):
        if place % 2:
            ax.axhspan(place - 0.5, place + 0.5, xmin=-1.66, xmax=2.16, color="#F4F4F4", lw=0, zorder=0, clip_on=False)
        marker, hue = VERDICTS.get(str(verdict), ("s", "white"))
        if np.isfinite(value):
            ax.plot([low, high], [place, place], color="black", lw=0.9, zorder=3)
            shown = float(np.clip(value, 1 / REACH, REACH))
            outside = "<" if value < shown else ">" if value > shown else marker
            ax.plot(shown, place, outside, mfc=hue, mec="black", mew=0.6, ms=5, zorder=4, clip_on=False, label="ours")
        ax.plot(-0.06, place, marker, mfc=hue, mec="black", mew=0.6, ms=5, transform=ax.get_yaxis_transform(), clip_on=False)
    _ratio_axis(ax)
    _texts(ax, rows)
    counts = rows["verdict"].value_counts()
    look: dict[str, Any] = {"ls": "none", "mec": "black", "mew": 0.6, "ms": 5}
    handles = [
        Line2D([], [], marker=marker, mfc=hue, label=f"{name} ({counts.get(name, 0)})", **look)
        for name, (marker, hue) in VERDICTS.items()
    ]
    handles.append(Line2D([], [], color=PUBLISHED, lw=0.9, label="published = 1"))
    figure.legend(handles=handles, loc="upper center", ncols=len(handles), handletextpad=0.3, columnspacing=1.2)
    return figure


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
    ax.xaxis.set_major_locator(FixedLocator([0.25, 0.5, 0.8, 1, 1.25, 2, 4]))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    ax.set_xlabel("ours / published (1), 95 % interval")
    ax.grid(axis="x")


def _texts(ax: Axes, rows: pd.DataFrame) -> None:
    """Section and statement to the left of the axes; published and our figure to the right."""
    across = ax.get_yaxis_transform()
    ax.set_yticks([])

    def write(x: float, y: float, text: str, align: str = "left", size: float = 6.0) -> None:
        ax.text(x, y, text, transform=across, ha=align, va="center", fontsize=size)

    for x, title, align in ((-1.63, "section and claim", "left"), (1.32, "published", "right"), (1.56, "ours", "right")):
        write(x, -1.1, title, align, 6.5)
    write(1.64, -1.1, "95 % interval", size=6.5)
    numeric = pd.to_numeric(rows["published"], errors="coerce").notna()
    for place, row in enumerate(rows.to_dict("records")):
        write(-1.63, place, f"{row['section']:g}" if isinstance(row["section"], float) else str(row["section"]))
        write(-1.51, place, _shortened(str(row["statement"])))
        published = str(row["published"])
        write(1.32, place, published if numeric.iloc[place] else "in words", "right")
        if np.isfinite(row["ours"]):
            write(1.56, place, _short(row["ours"]), "right")
        if np.isfinite(row["ours_low"]):
            low, high = _short(row["ours_low"]), _short(row["ours_high"])
            tiny = row["ours_low"] >= 0 and 0 < row["ours"] < 0.001 and row["ours_high"] < 0.001
            write(1.64, place, TINY if tiny else f"{low} … {high}")


def _shortened(text: str) -> str:
    return text if len(text) <= LABEL_CHARACTERS else f"{text[: LABEL_CHARACTERS - 1].rstrip()}…"


def _short(value: float) -> str:
    """Three significant digits; of what is smaller than anything that is told apart here, such as a p, only that."""
    return TINY if 0 < value < 0.001 else f"{value:.3g}"
