"""Boxes from stored percentiles and tables drawn as text: what figures 11, 12 and 15 are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from walklab.figures.style import PUBLISHED

PERCENTILES = ("p05", "p25", "median", "p75", "p95")
PUBLISHED_LABEL, OURS_LABEL = "published", "ours"


def draw_box(
    ax: Axes, place: float, percentiles: Mapping[Any, float], width: float, hue: str | None, vertical: bool = False
) -> None:
    """A box from p25 to p75 with whiskers from p05 to p95 and the median as a line.

    Parameters
    ----------
    percentiles : any of p05, p25, median, p75, p95; what is missing or NaN is not drawn
    hue : fill colour of ours; None draws the hollow outline of a published box
    """
    low, q1, med, q3, high = (float(percentiles.get(key, np.nan)) for key in PERCENTILES)
    edge = {"color": PUBLISHED if hue is None else "black", "linewidth": 0.9 if hue is None else 0.7}
    flat = hue if hue is not None and q1 == q3 else edge["color"]  # a box without height shows its colour in the median
    parts = ax.bxp(
        [{"whislo": low, "q1": q1, "med": med, "q3": q3, "whishi": high, "fliers": []}],
        positions=[place],
        widths=width,
        orientation="vertical" if vertical else "horizontal",
        patch_artist=True,
        showfliers=False,
        manage_ticks=False,
        boxprops={"facecolor": hue or "white", "edgecolor": edge["color"], "linewidth": edge["linewidth"]},
        whiskerprops=edge,
        capprops=edge,
        medianprops={"color": flat, "linewidth": 1.6, "solid_capstyle": "butt"},
    )
    parts["medians"][0].set_label(PUBLISHED_LABEL if hue is None else OURS_LABEL)


def number(value: Any, digits: int = 3) -> str:
    """A number for a table: fixed digits, whole numbers as they are, a dash for nothing, tiny ones as a bound."""
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return "–"
    if isinstance(value, str):
        return value
    if isinstance(value, int | np.integer):
        return str(int(value))
    smallest = 10.0**-digits
    return f"< {smallest:g}" if 0 < value < smallest else f"{value:.{digits}f}"


def draw_table(
    ax: Axes,
    header: Sequence[str],
    rows: Sequence[tuple[str | None, Sequence[str]]],
    widths: Sequence[float],
    fontsize: float = 6.5,
) -> None:
    """A plain table filling the axes: first column to the left, the others to the right; thin rules, no boxes.

    Parameters
    ----------
    rows : (text colour or None for black, one text per column)
    """
    ax.set_axis_off()
    ax.set(xlim=(0, 1), ylim=(0, len(rows) + 1.25))
    right = np.cumsum(widths) / np.sum(widths)
    top = len(rows) + 1.25
    for index, text in enumerate(header):
        _cell(ax, index, right, top - 0.55, text, "black")
    for row, (hue, texts) in enumerate(rows):
        for index, text in enumerate(texts):
            _cell(ax, index, right, len(rows) - row - 0.5, text, hue or "black")
    for height in (top, len(rows) + 0.1, 0.02):
        ax.plot([0, 1], [height, height], color="black", lw=0.6, clip_on=False)


def _cell(ax: Axes, index: int, right: np.ndarray, height: float, text: str, hue: str, fontsize: float = 6.5) -> None:
    x, align = (0.005, "left") if index == 0 else (float(right[index]) - 0.008, "right")
    ax.text(x, height, text, ha=align, va="center", color=hue, fontsize=fontsize)
