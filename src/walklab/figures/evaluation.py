"""How well the models predict: figures 11 to 15."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from walklab.errors import InputError
from walklab.figures.style import (
    DOUBLE_MM,
    PUBLISHED,
    PUBLISHED_MARK,
    SINGLE_MM,
    colour,
    letter,
    model_label,
    new_figure,
    ordered_models,
    plain_log_axis,
    require,
    styled,
    symbol,
)
from walklab.figures.tables import PERCENTILES, draw_box, draw_table, number

ERROR = "|Δt| (s)"
MODEL = colour("P_Prob")
ASTRAY = {"passed": "missed the end", "timeout": "timed out"}  # how a simulated walk can fail to arrive


def fig11(
    trials: pd.DataFrame,
    description: pd.DataFrame,
    pairs: pd.DataFrame,
    published: Mapping[str, Mapping[str, float]],
    published_pairs: Mapping[str, Mapping[str, float]] | None = None,
) -> Figure:
    """Scenario 1: see :func:`travel_time_errors`."""
    return travel_time_errors(trials, description, pairs, published, published_pairs or {}, "fig11")


def fig12(
    trials: pd.DataFrame,
    description: pd.DataFrame,
    pairs: pd.DataFrame,
    published: Mapping[str, Mapping[str, float]],
    published_pairs: Mapping[str, Mapping[str, float]] | None = None,
) -> Figure:
    """Scenario 2: see :func:`travel_time_errors`."""
    return travel_time_errors(trials, description, pairs, published, published_pairs or {}, "fig12")


@styled
def travel_time_errors(
    trials: pd.DataFrame,
    description: pd.DataFrame,
    pairs: pd.DataFrame,
    published: Mapping[str, Mapping[str, float]],
    published_pairs: Mapping[str, Mapping[str, float]],
    name: str = "fig11",
) -> Figure:
    """Absolute travel-time errors: histograms and boxes above, descriptive statistics and tests below.

    Parameters
    ----------
    trials : DataFrame[model, abs_dt_s, arrival (``arrived``, ``passed``, ``timeout``)]
    description : DataFrame[model, n, mean, p05, p25, median, p75, p95, iqr, skew, shapiro_w, shapiro_p]
    pairs : DataFrame[first, second, n, zeros, w, p, rank_biserial, cles, median_difference_s, power]
    published : model -> any of p05, p25, median, p75, p95 in seconds
    published_pairs : ``<first>_vs_<second>`` -> any of ``p``, ``p_max`` and ``power``
    """
    require(trials, ["model", "arrival"], name, ["abs_dt_s"])
    require(description, ["model", "n", "skew", "shapiro_w", "shapiro_p"], name, ["mean", "iqr", *PERCENTILES])
    require(pairs, ["first", "second", "n", "zeros", "w", "rank_biserial", "cles", "median_difference_s", "power"], name, ["p"])
    models = ordered_models(list(description["model"]))
    stated = {model: {key: row[key] for key in PERCENTILES if key in row} for model, row in published.items()}
    described = description.set_index("model")
    limit = 1.12 * max(
        [float(described["p95"].max()), *(value for row in stated.values() for value in row.values() if np.isfinite(value))]
    )
    # Columns for what occurs: a walk whose turning circle is too wide for its route misses the end; few ever time out.
    astray = {words: kind for kind, words in ASTRAY.items() if kind == "passed" or (trials["arrival"] == kind).any()}
    counts = {words: trials.loc[trials["arrival"] == kind, "model"].value_counts() for words, kind in astray.items()}
    statistics, tests = _statistics_rows(described, counts, models, stated), _test_rows(pairs, published_pairs)
    heights = [48.0, 4.6 * (len(statistics) + 1.25), 4.6 * (len(tests) + 1.25)]
    figure = new_figure(DOUBLE_MM, sum(heights) + 22)
    grid = figure.add_gridspec(3, 1, height_ratios=heights)
    top = grid[0].subgridspec(len(models), 2, wspace=0.08, hspace=0.1)
    _histograms(figure, top, trials, models, limit)
    _boxes(figure.add_subplot(top[:, 1]), described, models, stated, limit)
    columns = ["", "n", *counts, "mean", "5 %", "25 %", "median", "75 %", "95 %", "IQR", "skew", "Shapiro W", "p"]
    below = figure.add_subplot(grid[1])
    draw_table(below, columns, statistics, [2.4, 0.9, *[1.9] * len(counts), *[1.0] * 8, 1.4, 1.0])
    letter(below, 2, "descriptive statistics of |Δt| (s)")
    columns = ["", "n", "zeros", "Wilcoxon W", "p", "median diff. (s)", "rank-biserial r", "CLES", "power"]
    last = figure.add_subplot(grid[2])
    draw_table(last, columns, tests, [2.9, 0.8, 0.8, 1.6, 1.1, 1.8, 1.7, 1.0, 1.0])
    letter(last, 3, "Wilcoxon signed-rank tests of |Δt|, paired by walk")
    return figure


def _histograms(figure: Figure, grid: Any, trials: pd.DataFrame, models: list[str], limit: float) -> None:
    import seaborn as sns  # late: a second of imports, which the other figures of this module need not pay

    bins = np.linspace(0, limit, 41)
    panels: list[Axes] = []
    for row, model in enumerate(models):
        ax = figure.add_subplot(grid[row, 0], sharex=panels[0] if panels else None, sharey=panels[0] if panels else None)
        values = trials.loc[trials["model"] == model, "abs_dt_s"].to_numpy(dtype=float)
        sns.histplot(x=values, bins=bins, stat="percent", color=colour(model), edgecolor="white", linewidth=0.3, alpha=1.0, ax=ax)
        beyond = int((values > limit).sum())
        # In one line: a second one would lie on the axis of so low a panel.
        note = f"{model_label(model)}, {beyond} beyond the axis" if beyond else model_label(model)
        ax.annotate(note, (0.98, 0.92), xycoords="axes fraction", ha="right", va="top")
        ax.set(ylabel="walks (%)" if row == len(models) // 2 else "", xlabel=ERROR if row == len(models) - 1 else "")
        ax.tick_params(labelbottom=row == len(models) - 1)
        panels.append(ax)
    panels[0].set_xlim(0, limit)
    letter(panels[0], 0)


def _boxes(
    ax: Axes, described: pd.DataFrame, models: list[str], published: Mapping[str, Mapping[str, float]], limit: float
) -> None:
    for place, model in enumerate(models):
        has_published = bool(published.get(model))
        ours = {key: float(described[key][model]) for key in PERCENTILES}
        draw_box(ax, place - 0.17 * has_published, ours, 0.3, colour(model))
        if has_published:
            draw_box(ax, place + 0.19, published[model], 0.22, None)
    ax.set(xlim=(0, limit), ylim=(len(models) - 0.5, -0.6), xlabel=ERROR)
    ax.set_yticks(range(len(models)), [model_label(model) for model in models])
    ax.tick_params(axis="y", length=0)
    ax.grid(axis="x")
    letter(ax, 1)
    handles = [Patch(fc="#BBBBBB", ec="black", lw=0.7, label="ours"), Patch(fc="white", ec=PUBLISHED, lw=0.9, label="published")]
    ax.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)


def _statistics_rows(
    described: pd.DataFrame,
    counts: Mapping[str, Any],
    models: list[str],
    published: Mapping[str, Mapping[str, float]],
) -> list[tuple[str | None, list[str]]]:
    rows: list[tuple[str | None, list[str]]] = []
    for model in models:
        row: Any = described.loc[model]
        astray = [str(int(count.get(model, 0))) for count in counts.values()]
        texts = [model_label(model), str(int(row["n"])), *astray, number(row["mean"])]
        texts += [number(row[key]) for key in (*PERCENTILES, "iqr")]
        rows.append((None, [*texts, number(row["skew"], 2), number(row["shapiro_w"]), number(row["shapiro_p"])]))
        if figures := published.get(model):
            spread = figures.get("p75", np.nan) - figures.get("p25", np.nan)
            texts = ["   published", "", "", *[""] * len(counts)]
            texts += [*(number(figures.get(key, np.nan)) for key in PERCENTILES), number(spread)]
            rows.append((PUBLISHED, [*texts, "", "", ""]))
    return rows


def _test_rows(pairs: pd.DataFrame, published: Mapping[str, Mapping[str, float]]) -> list[tuple[str | None, list[str]]]:
    rows: list[tuple[str | None, list[str]]] = []
    for _, row in pairs.iterrows():
        texts = [f"{model_label(row['first'])} ↔ {model_label(row['second'])}", str(int(row["n"])), str(int(row["zeros"]))]
        texts += [number(row["w"], 0), number(row["p"]), number(row["median_difference_s"]), number(row["rank_biserial"])]
        rows.append((None, [*texts, number(row["cles"]), number(row["power"])]))
        if figures := published.get(f"{row['first']}_vs_{row['second']}"):
            p = f"≤ {figures['p_max']:.3f}" if "p_max" in figures else number(figures.get("p", np.nan))
            rows.append((PUBLISHED, ["   published", "", "", "", p, "", "", "", number(figures.get("power", np.nan))]))
    return rows


@styled
def fig13(ablations: pd.DataFrame, published: Mapping[str, float], calibrated: pd.DataFrame | None = None) -> Figure:
    """Median error of the full model and of each model without one parameter, published medians beside.

    Parameters
    ----------
    calibrated : the same table with P_Prob (calibrated)
    ablations : DataFrame[variant, value, low, high, held_at]; ``value`` is the median |dt| in seconds, variants are
        ``full`` and ``without_<parameter>`` in the order they are drawn; ``held_at`` NaN for dependencies
    published : variant -> published median |dt| in seconds
    """
    require(ablations, ["variant", "low", "high", "held_at"], "fig13", ["value"])
    figure = new_figure(SINGLE_MM, 14 + 8.0 * len(ablations))
    ax = figure.add_subplot()
    both = {"P_Prob": (ablations, -0.22), "P_Prob (calibrated)": (calibrated, 0.0)}
    drawn = {model: (table, offset) for model, (table, offset) in both.items() if table is not None}
    for model, (table, offset) in drawn.items():
        full = table.loc[table["variant"] == "full", "value"]
        if len(full):
            ax.axvline(float(full.iloc[0]), color=colour(model), lw=0.6, ls=(0, (3, 2)), zorder=0)
        for place, (value, low, high) in enumerate(table[["value", "low", "high"]].to_numpy(dtype=float)):
            ax.plot([low, high], [place + offset] * 2, color=colour(model), lw=1.2)
            ax.plot(value, place + offset, "o", color=colour(model), ms=4.5, label=model)
    stated = [(published[name], place + 0.22) for place, name in enumerate(ablations["variant"]) if name in published]
    if stated:
        ax.plot(*np.array(stated).T, label="published", **PUBLISHED_MARK)
    ax.set_yticks(range(len(ablations)), map(_variant_label, ablations["variant"], ablations["held_at"]))
    ax.set(ylim=(len(ablations) - 0.5, -0.6), xlabel=f"median {ERROR}")
    ax.tick_params(axis="y", length=0)
    ax.grid(axis="x")
    handles = [Line2D([], [], color=colour(model), marker="o", ms=4.5, lw=1.2, label=model_label(model)) for model in drawn]
    handles.append(Line2D([], [], label="published", **PUBLISHED_MARK))
    figure.legend(handles=handles, loc="outside upper right", ncols=3, handletextpad=0.5, columnspacing=1.0)
    return figure


def _variant_label(variant: str, held_at: float) -> str:
    if variant == "full":
        return "full model"
    held = f" (held at {held_at:.2f})" if np.isfinite(held_at) else ""
    return f"without {symbol(variant.removeprefix('without_'))}{held}"


@styled
def fig14(
    errors: pd.DataFrame,
    timings: pd.DataFrame,
    published_error: Mapping[int, float],
    published_ms: Mapping[int, float],
    calibrated: pd.DataFrame | None = None,
) -> Figure:
    """Error and interpolation time over the number of neighbours k, published figures beside.

    Parameters
    ----------
    errors : DataFrame[k, statistic, value], statistics p05, p25, median, p75, p95 of |dt| in seconds
    timings : DataFrame[k, interpolation_ms], one row per k
    published_error, published_ms : k -> median |dt| in seconds, k -> time in milliseconds
    calibrated : the errors of P_Prob (calibrated)
    """
    require(errors, ["statistic"], "fig14", ["k", "value"])
    require(timings, [], "fig14", ["k", "interpolation_ms"])
    counts = sorted({int(k) for k in errors["k"]} | {int(k) for k in timings["k"]})
    place = {k: i for i, k in enumerate(counts)}
    figure = new_figure(SINGLE_MM, 96)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=[1.25, 1])
    both = [("P_Prob", errors, -0.15), ("P_Prob (calibrated)", calibrated, 0.15)]
    drawn = [(model, table, offset) for model, table, offset in both if table is not None]
    for model, table, offset in drawn:
        for k in sorted(set(table["k"])):
            rows = table[table["k"] == k]
            box = dict(zip(rows["statistic"], rows["value"], strict=True))
            draw_box(top, place[int(k)] + offset, box, 0.26, colour(model), vertical=True)
    bottom.plot([place[int(k)] for k in timings["k"]], timings["interpolation_ms"], "o", color=MODEL, ms=4.5, label="ours")
    for ax, published in ((top, published_error), (bottom, published_ms)):
        stated = [(place[k] + 0.36, value) for k, value in published.items() if k in place]
        if stated:
            ax.plot(*np.array(stated).T, label="published", **PUBLISHED_MARK)
        ax.grid(axis="y")
    plain_log_axis(bottom, 2.5)
    top.set(ylabel=ERROR, ylim=(0, None), xlim=(-0.5, len(counts) - 0.35))
    bottom.set(xlabel=f"number of neighbours {symbol('k')} (1)", ylabel="interpolation time (ms)")
    bottom.set_xticks(range(len(counts)), [str(k) for k in counts])
    handles = [Line2D([], [], marker="s", color=colour(model), ls="none", ms=5, label=model_label(model)) for model, *_ in drawn]
    handles.append(Line2D([], [], label="published", **PUBLISHED_MARK))
    figure.legend(handles=handles, loc="outside upper right", ncols=3, handletextpad=0.3, columnspacing=1.0)
    letter(top, 0)
    letter(bottom, 1)
    return figure


@styled
def fig15(times: pd.DataFrame, published: pd.DataFrame) -> Figure:
    """Long distances: travel times walked (Ref) and simulated, published medians and interquartile ranges beside.

    Parameters
    ----------
    times : DataFrame[distance_m, model, travel_time_s] of one split; models Ref, P_Prob, P_Stat, P_Prob (calibrated)
    published : DataFrame[distance_m, model, median_s, iqr_s]; ``iqr_s`` NaN where none was stated. Only its size is
        published, so the bar is drawn centred on the median.
    """
    require(times, ["model"], "fig15", ["distance_m", "travel_time_s"])
    require(published, ["model", "iqr_s"], "fig15", ["distance_m", "median_s"])
    if "split" in times and len(set(times["split"])) > 1:
        raise InputError("fig15: the table holds several splits; pass the rows of one")
    distances = sorted({float(value) for value in times["distance_m"]})
    present = list(dict.fromkeys(times["model"]))
    models = [name for name in ("Ref", "P_Prob", "P_Stat") if name in present]
    models += [name for name in present if name not in models]
    figure = new_figure(DOUBLE_MM, 66)
    panels = figure.subplots(1, len(distances), squeeze=False)[0]
    for index, (ax, distance) in enumerate(zip(panels, distances, strict=True)):
        rows = times[times["distance_m"] == distance]
        for place, model in enumerate(models):
            values = rows.loc[rows["model"] == model, "travel_time_s"].to_numpy(dtype=float)
            if len(values):
                box = dict(zip(PERCENTILES, np.quantile(values, (0.05, 0.25, 0.5, 0.75, 0.95)), strict=True))
                draw_box(ax, place, box, 0.42, "#4D4D4D" if model == "Ref" else colour(model), vertical=True)
            stated = published[(published["distance_m"] == distance) & (published["model"] == model)]
            for median, iqr in stated[["median_s", "iqr_s"]].to_numpy(dtype=float):
                if np.isfinite(iqr):
                    ax.plot([place + 0.38] * 2, [median - iqr / 2, median + iqr / 2], color=PUBLISHED, lw=1.0)
                ax.plot(place + 0.38, median, label="published", **PUBLISHED_MARK)
        ax.set_xticks(range(len(models)), [model_label(name).replace(" (", "\n(") for name in models])
        ax.set(ylabel="travel time (s)" if index == 0 else "", xlim=(-0.5, len(models) - 0.4))
        plain_log_axis(ax, 2.5)
        ax.grid(axis="y")
        letter(ax, index, f"{distance:g} m")
    mark = Line2D([], [], color=PUBLISHED, lw=1.0, label="published median and interquartile range")
    mark.set(marker="D", markerfacecolor="white", markeredgecolor=PUBLISHED, markersize=4.5)
    figure.legend(handles=[mark], loc="outside upper right")
    return figure
