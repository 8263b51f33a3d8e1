"""Suitability maps and the blending space: figures 5, 6, 8 and 9."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import ConnectionPatch
from mpl_toolkits.mplot3d import proj3d
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.figures.cells import (
    as_grid,
    best_cell,
    cube,
    draw_cells,
    draw_slice,
    held_text,
    label_cube,
    norm_of,
)
from walklab.figures.style import (
    BLUE,
    DOUBLE_MM,
    FAINT,
    GREEN,
    ORANGE,
    PUBLISHED,
    SUITABILITY,
    VERMILLION,
    letter,
    new_figure,
    quantity,
    require,
    require_array,
    styled,
    symbol,
)
from walklab.steering.space import ParameterSpace

Array = NDArray[np.float64]

SUITABLE = "suitability (1)"


@styled
def fig05(suitability: Array, space: ParameterSpace) -> Figure:
    """One suitability map: all cells in three dimensions, and the slices through its best cell.

    Parameters
    ----------
    suitability : array of the space's shape (or its flat cells), 1 is best
    """
    grid = as_grid(suitability, space, "fig05")
    at, norm = best_cell(grid), norm_of(grid)
    pairs = list(combinations(range(min(grid.ndim, 3)), 2))
    solid = grid.ndim >= 3
    figure = new_figure(DOUBLE_MM, 58 if solid else 62)
    columns = figure.add_gridspec(1, len(pairs) + solid, width_ratios=[1.55] * solid + [1.0] * len(pairs))
    if solid:
        ax = cube(figure, columns[0])
        draw_cells(ax, grid, space, norm, size=15)
        letter(ax, 0)
    flat = []
    for position, pair in enumerate(pairs):
        ax = figure.add_subplot(columns[position + solid])
        draw_slice(ax, grid, space, pair, norm, at)
        ax.set_box_aspect(1)
        letter(ax, position + solid, held_text(space, pair, at))
        flat.append(ax)
    figure.colorbar(ScalarMappable(norm, SUITABILITY), ax=flat, label=SUITABLE, shrink=0.75, pad=0.02, aspect=25)
    return figure


@styled
def fig06(
    vectors: Array,
    is_blend: NDArray[np.bool_],
    names: Sequence[str],
    units: Sequence[str],
    insets: Mapping[int, Array],
    space: ParameterSpace,
) -> Figure:
    """The dependency blending space, with the maps of a few of its entries.

    Parameters
    ----------
    vectors : (N, D) dependency vectors in natural units
    is_blend : (N,) whether an entry was blended by the homogenisation
    names, units : of the D dependencies, e.g. ``("length", "curvature", "height")`` and ``("m", "1/m", "m")``
    insets : up to four entries: row of ``vectors`` -> its map (cells of ``space``)
    """
    points = require_array(vectors, "fig06", "vectors", 2)
    if not 1 <= len(insets) <= 4:
        raise InputError(f"fig06: {len(insets)} inset maps; pass between one and four")
    grids = {row: as_grid(values, space, "fig06") for row, values in insets.items()}
    norm = norm_of(*grids.values())
    figure = new_figure(DOUBLE_MM, 92, constrained=False)
    blend = np.asarray(is_blend, dtype=bool)
    if points.shape[1] >= 3:
        ax: Any = cube(figure, (0.23, 0.06, 0.50, 0.90))
    else:
        ax = figure.add_axes((0.31, 0.16, 0.36, 0.72))
    columns = points[:, :3].T if points.shape[1] > 1 else np.stack([points[:, 0], np.zeros(len(points))])
    depth = {"depthshade": False} if len(columns) == 3 else {}
    ax.scatter(*columns[:, blend], s=2.0, c=FAINT, linewidths=0, rasterized=True, label=f"blend (n = {blend.sum()})", **depth)
    ax.scatter(*columns[:, ~blend], s=3.5, c=BLUE, linewidths=0, rasterized=True, label=f"captured walk (n = {(~blend).sum()})", **depth)
    labels = [quantity(name, unit) for name, unit in zip(names, units, strict=True)][:3]
    if len(columns) == 3:
        label_cube(ax, labels, ticks=5, pad=-3)
        ax.tick_params(pad=-1.5)
    else:
        ax.set_xlabel(labels[0])
        ax.set_ylabel(labels[1] if len(labels) > 1 else "")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.04), ncols=2, markerscale=2.5, columnspacing=1.0, handletextpad=0.2)
    _inset_maps(figure, ax, columns, grids, space, norm, list(zip(names, units, strict=True)), points)
    bar = figure.add_axes((0.40, 0.055, 0.20, 0.018))
    figure.colorbar(ScalarMappable(norm, SUITABILITY), cax=bar, orientation="horizontal")
    bar.set_title(SUITABLE, fontsize=6.5, pad=2, loc="center")
    return figure


def _inset_maps(
    figure: Figure,
    ax: Any,
    columns: Array,
    grids: Mapping[int, Array],
    space: ParameterSpace,
    norm: Normalize,
    dependencies: list[tuple[str, str]],
    points: Array,
) -> None:
    """Small maps at the corners, the leftmost entries on the left, each linked to its entry."""
    solid = len(columns) == 3
    figure.canvas.draw() if solid else None
    projected = {
        row: np.array(proj3d.proj_transform(*columns[:, row], ax.get_proj())[:2]) if solid else columns[:, row] for row in grids
    }
    rows = sorted(grids, key=lambda row: projected[row][0])
    half = (len(rows) + 1) // 2
    sides = [(0.065, rows[:half]), (0.80, rows[half:])]
    for left, members in sides:
        for place, row in enumerate(sorted(members, key=lambda row: -projected[row][1])):
            inset = figure.add_axes((left, 0.60 - 0.49 * place, 0.16, 0.30))
            grid = grids[row]
            draw_slice(inset, grid, space, (0, 1), norm, best_cell(grid), mark=False)
            inset.set_title(
                "\n".join(f"{symbol(name)} {points[row, i]:.2f} {unit}" for i, (name, unit) in enumerate(dependencies[:3])),
                fontsize=6,
                loc="left",
                pad=2,
                linespacing=1.05,
            )
            edge = (1.0, 0.5) if left < 0.5 else (0.0, 0.5)
            link = ConnectionPatch(edge, projected[row], "axes fraction", "data", inset, ax, color=VERMILLION, lw=0.7, zorder=10)
            figure.add_artist(link)
            ax.plot(*columns[:, [row]], "o", mfc="none", mec=VERMILLION, ms=5, mew=1.0, zorder=20)


@styled
def dependency_clouds(
    captured: pd.DataFrame,
    planned: pd.DataFrame,
    run_time: Mapping[str, pd.DataFrame],
    units: Mapping[str, str],
) -> Figure:
    """Where the training walks lie in dependency space, by captured and by planned path, and where the run-time vectors fall.

    Parameters
    ----------
    captured, planned : one column per dependency, one row per training walk
    run_time : evaluated set (e.g. ``scenario_1``) -> table with the same columns
    units : dependency -> unit; its keys name the columns that are drawn
    """
    names = list(units)
    for table in (captured, planned, *run_time.values()):
        require(table, [], "dependency_clouds", names)
    pairs = list(combinations(names, 2)) or [(names[0], names[0])]
    columns = min(len(pairs), 3)
    rows = -(-len(pairs) // columns)
    figure = new_figure(DOUBLE_MM, 62 * rows + 6)
    marks = ["+", "x", "1", "2"]
    for index, (first, second) in enumerate(pairs):
        ax = figure.add_subplot(rows, columns, index + 1)
        ax.scatter(captured[first], captured[second], s=5, c=FAINT, linewidths=0, rasterized=True, label="training, captured path")
        ax.scatter(planned[first], planned[second], s=7, c=ORANGE, linewidths=0, rasterized=True, label="training, planned path")
        for mark, hue, (name, table) in zip(marks, (BLUE, GREEN, VERMILLION, PUBLISHED), run_time.items(), strict=False):
            ax.scatter(
                table[first], table[second], s=10, c=hue, marker=mark, linewidths=0.6, rasterized=True,
                label=f"run time, {name.replace('_', ' ')}",
            )  # fmt: skip
        ax.set_xlabel(quantity(first, units[first]))
        ax.set_ylabel(quantity(second, units[second]))
        letter(ax, index)
        if index == 0:
            handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), columnspacing=1.2, handletextpad=0.3)
    return figure


@styled
def fig08(maps: Sequence[Array], lengths_m: Sequence[float], space: ParameterSpace, curvature_1_m: float, height_m: float) -> Figure:
    """Blended maps for growing walking distances: cells in three dimensions over slices through the best cell.

    Parameters
    ----------
    maps : one map per length, cells of ``space``
    lengths_m : distances the maps were blended for
    curvature_1_m, height_m : the other dependencies, the same for all
    """
    if len(maps) == 0 or len(maps) != len(lengths_m):
        raise InputError(f"fig08: {len(maps)} maps for {len(lengths_m)} lengths; pass one map per length")
    grids = [as_grid(values, space, "fig08") for values in maps]
    norm = norm_of(*grids)
    solid = grids[0].ndim >= 3
    columns = min(4, len(grids))
    blocks = -(-len(grids) // columns)
    figure = new_figure(DOUBLE_MM, blocks * (84 if solid else 46) + 8)
    layout = figure.add_gridspec(blocks * (1 + solid), columns, height_ratios=([1.3] * solid + [1.0]) * blocks)
    slices = []
    for index, (grid, length) in enumerate(zip(grids, lengths_m, strict=True)):
        row, column = divmod(index, columns)
        title = f"{symbol('l')} = {length:.2f} m"
        if solid:
            ax = cube(figure, layout[2 * row, column])
            draw_cells(ax, grid, space, norm, size=9)
            letter(ax, index, title)
        flat = figure.add_subplot(layout[row * (1 + solid) + solid, column])
        at = best_cell(grid)
        draw_slice(flat, grid, space, (0, 1), norm, at)
        flat.set_box_aspect(1)
        flat.set_title(held_text(space, (0, 1), at) if solid else title, fontsize=6.5, pad=2)
        slices.append(flat)
    figure.colorbar(ScalarMappable(norm, SUITABILITY), ax=figure.axes, label=SUITABLE, shrink=0.5, pad=0.01, aspect=35)
    figure.suptitle(f"{symbol('c')} = {curvature_1_m:g} 1/m, {symbol('h')} = {height_m:.2f} m", fontsize=7.5)
    return figure


@styled
def fig09(
    vectors: Array,
    names: Sequence[str],
    units: Sequence[str],
    query: Array,
    neighbours: NDArray[np.int64],
    weights: Array,
    blended: Array,
    space: ParameterSpace,
    fine_values: tuple[Array, Array],
    fine: Array,
    accepted: Array,
    rejected: Array,
    held_at: Mapping[str, float],
) -> Figure:
    """The run-time procedure on one example: neighbours, blended map, interpolated map, samples.

    Parameters
    ----------
    vectors : (N, D) entries of the blending space; names, units : of the D dependencies
    query : (D,) dependency vector of the walk; neighbours : (k,) rows of ``vectors``; weights : (k,) their weights
    blended : the blended map, cells of ``space``
    fine_values : values of the first two steering parameters at which the interpolant was evaluated
    fine : (n1, n2) interpolated density over them; held_at : the other parameters' values there
    accepted, rejected : (n, P) samples
    """
    points = require_array(vectors, "fig09", "vectors", 2)
    surface = require_array(fine, "fig09", "the interpolated map", 2)
    kept = require_array(accepted, "fig09", "accepted samples", 2)
    grid = as_grid(blended, space, "fig09")
    figure = new_figure(DOUBLE_MM, 58, constrained=True)
    columns = figure.add_gridspec(1, 4, width_ratios=[1.15, 1.15, 1, 1])
    _neighbours(figure, columns[0], points, [quantity(n, u) for n, u in zip(names, units, strict=True)], query, neighbours, weights)
    norm = norm_of(grid)
    if grid.ndim >= 3:
        ax = cube(figure, columns[1])
        draw_cells(ax, grid, space, norm, size=9)
    else:
        ax = figure.add_subplot(columns[1])
        draw_slice(ax, grid, space, (0, 1), norm, best_cell(grid))
        ax.set_box_aspect(1)
    letter(ax, 1, "blended map")
    first, second = space.axes[:2]
    ax = figure.add_subplot(columns[2])
    mesh = ax.pcolormesh(*fine_values, surface.T, cmap=SUITABILITY, shading="nearest", rasterized=True)
    ax.contour(*fine_values, surface.T, levels=6, colors="white", linewidths=0.4)
    figure.colorbar(mesh, ax=ax, orientation="horizontal", location="bottom", label="density before scaling (1)", aspect=18, pad=0.04)
    letter(ax, 2, "interpolated" + "".join(f", {symbol(name)} = {value:.2f}" for name, value in held_at.items()))
    last = figure.add_subplot(columns[3])
    if len(rejected):
        last.plot(*np.asarray(rejected)[:, :2].T, "x", color=FAINT, ms=2.5, mew=0.6, label=f"rejected ({len(rejected)})", rasterized=True)
    last.plot(*kept[:, :2].T, "o", color=BLUE, ms=2.2, mew=0, label=f"accepted ({len(kept)})", rasterized=True)
    last.legend(loc="upper center", bbox_to_anchor=(0.5, -0.30), ncols=1, markerscale=1.8, handletextpad=0.2)
    letter(last, 3, "samples")
    for panel in (ax, last):
        panel.set(xlabel=quantity(first.name, first.unit), ylabel=quantity(second.name, second.unit))
        panel.set(xlim=(first.values[0], first.values[-1]), ylim=(second.values[0], second.values[-1]))
        panel.set_box_aspect(1)
    return figure


def _neighbours(
    figure: Figure, position: Any, points: Array, labels: list[str], query: Array, neighbours: NDArray[np.int64], weights: Array
) -> None:
    """Panel a: the blending space, the k nearest entries coloured by weight, and the walk that is planned."""
    solid = points.shape[1] >= 3
    ax: Any = cube(figure, position) if solid else figure.add_subplot(position)
    width = 3 if solid else 2
    padded = points if points.shape[1] > 1 else np.column_stack([points, np.zeros(len(points))])
    target = np.append(np.asarray(query, dtype=float), 0.0)[:width]
    depth = {"depthshade": False} if solid else {}
    ax.scatter(*padded[:, :width].T, s=1.0, c=FAINT, linewidths=0, alpha=0.5, rasterized=True, **depth)
    near = padded[np.asarray(neighbours)][:, :width]
    ax.scatter(*near.T, s=4, c=np.asarray(weights), cmap="Blues", vmin=-0.3 * np.max(weights), linewidths=0, rasterized=True, **depth)
    ax.plot(*target[:, None], "*", color=VERMILLION, ms=7, mec="white", mew=0.4, zorder=30)
    if solid:
        label_cube(ax, labels[:3])
    else:
        ax.set(xlabel=labels[0], ylabel=labels[1] if len(labels) > 1 else "")
        ax.set_box_aspect(1)
    letter(ax, 0, f"{len(near)} nearest maps")
