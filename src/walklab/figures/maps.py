"""Suitability maps, of one walk and blended: figures 5 and 8."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from matplotlib.figure import Figure
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
    norm_of,
    note,
)
from walklab.figures.style import (
    DOUBLE_MM,
    letter,
    new_figure,
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
    figure = new_figure(DOUBLE_MM, 60, constrained=False)
    if solid:
        ax = cube(figure, in_mm(figure, -2, 2, 57, 57), zoom=0.86)
        draw_cells(ax, grid, space, norm, size=15)
        note(figure, 2, 49.3, 0)
    left, side = (67.0, 28.0) if solid else (60.0, 44.0)
    for position, pair in enumerate(pairs):
        flat = figure.add_axes(in_mm(figure, left + 39 * position, 20 if solid else 10, side, side))
        mesh = draw_slice(flat, grid, space, pair, norm, at)
        letter(flat, position + solid, held_text(space, pair, at))
    bar = figure.add_axes(in_mm(figure, 87, 7.5, 64, 2) if solid else in_mm(figure, 110, 14, 2, 36))
    figure.colorbar(mesh, cax=bar, orientation="horizontal" if solid else "vertical", label=SUITABLE)
    return figure


@styled
def fig08(
    maps: Sequence[Array], lengths_m: Sequence[float], space: ParameterSpace, curvature_1_m: float, height_m: float
) -> Figure:
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
    block_mm = 88 if solid else 46
    figure = new_figure(DOUBLE_MM, blocks * block_mm + 25, constrained=False)
    for index, (grid, length) in enumerate(zip(grids, lengths_m, strict=True)):
        row, column = divmod(index, columns)
        left, base = 43.0 * column, 19 + block_mm * (blocks - 1 - row)
        title = f"{symbol('l')} = {length:.2f} m"
        at = best_cell(grid)
        if solid:
            ax = cube(figure, in_mm(figure, left + 1, base + 38, 44, 44), zoom=0.80)
            draw_cells(ax, grid, space, norm, size=8)
            note(figure, left + 6, base + 79, index, title)
        flat = figure.add_axes(in_mm(figure, left + 11, base + 3, 30, 30))
        mesh = draw_slice(flat, grid, space, (0, 1), norm, at)
        flat.set_title(held_text(space, (0, 1), at) if solid else title, fontsize=6.5, pad=2)
        flat.set(ylabel=flat.get_ylabel() if column == 0 else "")
        flat.tick_params(labelleft=column == 0)
    bar = figure.add_axes(in_mm(figure, 60, 9.5, 60, 2))
    figure.colorbar(mesh, cax=bar, orientation="horizontal", label=SUITABLE)
    top = figure.get_size_inches()[1] * 25.4 - 5
    figure.text(
        *in_mm(figure, 90, top, 0, 0)[:2], f"{symbol('c')} = {curvature_1_m:g} 1/m, {symbol('h')} = {height_m:.2f} m", ha="center"
    )
    return figure
