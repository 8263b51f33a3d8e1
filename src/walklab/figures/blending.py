"""The blending space and the run-time procedure: figures 6 and 9, and where the dependency vectors lie."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, product
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import ConnectionPatch
from matplotlib.ticker import MaxNLocator
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
    in_mm,
    label_cube,
    norm_of,
    note,
)
from walklab.figures.style import (
    BLACK,
    BLUE,
    DOUBLE_MM,
    FAINT,
    SET_COLOURS,
    SINGLE_MM,
    SUITABILITY,
    VERMILLION,
    letter,
    new_figure,
    quantity,
    require,
    require_array,
    set_label,
    styled,
    symbol,
    unit_text,
)
from walklab.steering.space import ParameterSpace

Array = NDArray[np.float64]

SUITABLE = "suitability (1)"


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
        ax: Any = cube(figure, in_mm(figure, 46, 10, 84, 78), zoom=0.98)
    else:
        ax = figure.add_axes(in_mm(figure, 58, 24, 60, 60))
    columns = points[:, :3].T if points.shape[1] > 1 else np.stack([points[:, 0], np.zeros(len(points))])
    depth = {"depthshade": False} if len(columns) == 3 else {}
    ax.scatter(*columns[:, blend], s=2.0, c=FAINT, linewidths=0, rasterized=True, label=f"blend (n = {blend.sum()})", **depth)
    ax.scatter(
        *columns[:, ~blend], s=3.5, c=BLACK, linewidths=0, rasterized=True, label=f"captured walk (n = {(~blend).sum()})", **depth
    )
    labels = [quantity(name, unit) for name, unit in zip(names, units, strict=True)][:3]
    if len(columns) == 3:
        label_cube(ax, labels, ticks=5, pad=(-6, -6, -5))
        ax.tick_params(pad=-2.5)
    else:
        ax.set_xlabel(labels[0])
        ax.set_ylabel(labels[1] if len(labels) > 1 else "")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.04), ncols=2, markerscale=2.5, columnspacing=1.0, handletextpad=0.2)
    _inset_maps(figure, ax, columns, grids, space, norm, list(zip(names, units, strict=True)), points)
    bar = figure.add_axes(in_mm(figure, 72, 9.5, 36, 1.8))
    figure.colorbar(ScalarMappable(norm, SUITABILITY), cax=bar, orientation="horizontal", label=SUITABLE)
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
    if solid:
        figure.canvas.draw()  # settles the projection
    projected = {
        row: np.array(proj3d.proj_transform(*columns[:, row], ax.get_proj())[:2]) if solid else columns[:, row] for row in grids
    }
    rows = sorted(grids, key=lambda row: projected[row][0])
    half = (len(rows) + 1) // 2
    for left, members in ((10.0, rows[:half]), (142.0, rows[half:])):
        for place, row in enumerate(sorted(members, key=lambda row: -projected[row][1])):
            inset = figure.add_axes(in_mm(figure, left, 54 - 45 * place, 28, 26))
            at = best_cell(grids[row])
            draw_slice(inset, grids[row], space, (0, 1), norm, at, mark=False)
            described = [f"{symbol(name)} {points[row, i]:.2f} {unit}" for i, (name, unit) in enumerate(dependencies[:4])]
            if held := held_text(space, (0, 1), at):
                described.append(f"at {held}".replace("\n", ", "))
            inset.set_title("\n".join(described), fontsize=6, pad=2, linespacing=1.05)
            edge = (1.0, 0.5) if left < 90 else (0.0, 0.5)
            if left > 90:
                inset.yaxis.tick_right()
                inset.yaxis.set_label_position("right")
            entry = (float(projected[row][0]), float(projected[row][1]))
            link = ConnectionPatch(edge, entry, "axes fraction", "data", axesA=inset, axesB=ax, color=VERMILLION, lw=0.7)
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
    rows = (("captured path", captured), ("planned path", planned))
    columns = min(len(pairs), 3)
    blocks = -(-len(pairs) // columns)
    figure = new_figure(max(60.0 * columns, SINGLE_MM), 104 * blocks + 8)
    axes = figure.subplots(2 * blocks, columns, squeeze=False)
    for (row, (kind, training)), (index, (first, second)) in product(enumerate(rows), enumerate(pairs)):
        block, column = divmod(index, columns)
        ax, above = axes[2 * block + row, column], axes[2 * block, column]
        if row:
            ax.sharex(above)
            ax.sharey(above)
        ax.scatter(training[first], training[second], s=9, c=FAINT, linewidths=0, rasterized=True, label="training")
        for mark, hue, (name, table) in zip("+x12", SET_COLOURS, run_time.items(), strict=False):
            text = f"run time, {set_label(name)}"
            ax.scatter(table[first], table[second], s=6, c=hue, marker=mark, linewidths=0.4, rasterized=True, label=text)
        ax.set(xlabel=quantity(first, units[first]) if row else "", ylabel=quantity(second, units[second]))
        letter(ax, row * len(pairs) + index, f"training by {kind}" if column == 0 else "")
    for ax in axes.flat:
        ax.set_visible(ax.has_data())
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper center", ncols=len(labels), columnspacing=1.2, handletextpad=0.3, markerscale=1.6
    )
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
    require_array([*accepted, *rejected], "fig09", "the samples", 2)
    grid = as_grid(blended, space, "fig09")
    figure = new_figure(DOUBLE_MM, 60, constrained=False)
    _neighbours(figure, points, [quantity(n, u) for n, u in zip(names, units, strict=True)], query, neighbours, weights)
    _blended(figure, grid, space)
    first, second = space.axes[:2]
    ax = figure.add_axes(in_mm(figure, 106, 20, 31, 31))
    mesh = ax.pcolormesh(*fine_values, surface.T, cmap=SUITABILITY, shading="nearest", rasterized=True)
    ax.contour(*fine_values, surface.T, levels=6, colors="white", linewidths=0.4)
    bar = figure.add_axes(in_mm(figure, 106, 7.5, 31, 1.8))
    figure.colorbar(mesh, cax=bar, orientation="horizontal", label="density, not normalised (1)")
    units_of = {axis.name: unit_text(axis.unit) for axis in space.axes}
    held = [f"{symbol(name)} = {value:.2f} {units_of.get(name, '')}" for name, value in held_at.items()]
    letter(ax, 2, "\n".join(held) or "interpolated map")
    last = figure.add_axes(in_mm(figure, 148, 20, 31, 31))
    looks: list[tuple[str, Array, dict[str, Any]]] = [
        ("rejected", rejected, {"marker": "x", "color": FAINT, "ms": 2.5, "mew": 0.6}),
        ("accepted", accepted, {"marker": "o", "color": BLUE, "ms": 2.2, "mew": 0}),
    ]
    for word, draws, look in looks:
        if len(draws):
            last.plot(*np.asarray(draws)[:, :2].T, ls="none", label=f"{word} ({len(draws)})", rasterized=True, **look)
    last.legend(loc="upper center", bbox_to_anchor=(0.5, -0.26), markerscale=1.8, handletextpad=0.2)
    letter(last, 3, "samples")
    for panel in (ax, last):
        panel.set(xlabel=quantity(first.name, first.unit), ylabel=quantity(second.name, second.unit))
        panel.set(xlim=(first.values[0], first.values[-1]), ylim=(second.values[0], second.values[-1]))
        panel.xaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))  # a long label at the right end would be cut off
    return figure


def _neighbours(
    figure: Figure, points: Array, labels: list[str], query: Array, neighbours: NDArray[np.int64], weights: Array
) -> None:
    """Panel a: the blending space, the k nearest entries coloured by weight, and the walk that is planned."""
    solid = points.shape[1] >= 3
    ax: Any = cube(figure, in_mm(figure, -1, 5, 48, 50)) if solid else figure.add_axes(in_mm(figure, 12, 20, 32, 32))
    width = 3 if solid else 2
    padded = points if points.shape[1] > 1 else np.column_stack([points, np.zeros(len(points))])
    target = np.append(np.asarray(query, dtype=float), 0.0)[:width]
    depth = {"depthshade": False} if solid else {}
    ax.scatter(*padded[:, :width].T, s=1.2, c="#DDDDDD", linewidths=0, rasterized=True, **depth)
    near = padded[np.asarray(neighbours)][:, :width]
    shade = np.asarray(weights) / np.max(weights)
    ax.scatter(*near.T, s=6, c=shade, cmap="Greys", vmin=-0.9, vmax=1.0, linewidths=0, rasterized=True, **depth)
    ax.plot(*target[:, None], "*", color=VERMILLION, ms=5, mec="black", mew=0.4)
    if solid:
        label_cube(ax, labels[:3], pad=(-9, -9, -5))
    else:
        ax.set(xlabel=labels[0], ylabel=labels[1] if len(labels) > 1 else "")
    note(figure, 2, 53.2, 0, f"{len(near)} nearest maps")


def _blended(figure: Figure, grid: Array, space: ParameterSpace) -> None:
    """Panel b: the blended map."""
    norm = norm_of(grid)
    if grid.ndim >= 3:
        draw_cells(cube(figure, in_mm(figure, 48, 5, 48, 50)), grid, space, norm, size=9)
    else:
        draw_slice(figure.add_axes(in_mm(figure, 60, 20, 32, 32)), grid, space, (0, 1), norm, best_cell(grid))
    note(figure, 51, 53.2, 1, "blended map")
