"""Cost of the kernels against the size of their work, as the benchmarks measured it."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from walklab.figures.style import BLACK, DOUBLE_MM, SET_COLOURS, letter, new_figure, require, styled

# Quantity -> label of the axis, and the exponent that was aimed at.
AXES = {
    "maps": ("maps", 0.0),
    "k": ("neighbours k", 1.0),
    "cells, sampling": ("cells, one sample", 1.0),
    "cells, sweep": ("cells, sweep", 1.0),
    "walks": ("walks", 1.0),
    "threads": ("threads", -1.0),
}


@styled
def scaling(costs: pd.DataFrame) -> Figure:
    """A panel per quantity, both axes logarithmic: measured costs, the fitted power law, and the slope that was aimed at.

    Parameters
    ----------
    costs : DataFrame[quantity, value, cost_s, unit, exponent], the exponent of ``cost ~ value^exponent`` fitted per quantity
    """
    require(costs, ["quantity", "value", "cost_s", "unit", "exponent"], "scaling", ["value", "cost_s"])
    figure = new_figure(DOUBLE_MM, 100)
    panels = figure.subplots(2, 3).ravel()
    for index, (ax, (quantity, (label, goal))) in enumerate(zip(panels, AXES.items(), strict=True)):
        found = costs[costs["quantity"] == quantity].sort_values("value")
        if found.empty:
            ax.set_axis_off()
            continue
        value, cost = found["value"].to_numpy(dtype=float), found["cost_s"].to_numpy(dtype=float)
        exponent = float(found["exponent"].iloc[0])
        middle = np.exp(np.log(value).mean()), np.exp(np.log(cost).mean())
        ax.loglog(value, middle[1] * (value / middle[0]) ** goal, color=BLACK, ls=(0, (3, 2)), lw=0.8, label=f"slope {goal:g}")
        if np.isfinite(exponent):
            fitted = middle[1] * (value / middle[0]) ** exponent
            ax.loglog(value, fitted, color=SET_COLOURS[0], lw=1.2, label=f"fitted {exponent:.2f}")
        ax.loglog(value, cost, "o", color=SET_COLOURS[0], ms=4)
        # A flat or short series would otherwise fill the panel with its noise.
        low, high = cost.min(), cost.max()
        margin = max(1.6, np.sqrt(10 * low / high))
        ax.set_ylim(low / margin, high * margin)
        ax.set_xlabel(label)
        ax.set_ylabel(found["unit"].iloc[0])
        ax.legend(loc="upper left", frameon=False)
        letter(ax, index)
    return figure
