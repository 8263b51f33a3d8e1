"""Drawing one suitability map: its cells in three dimensions, or a slice through them."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.figures.style import SUITABILITY, bold_letter, quantity, symbol, unit_text
from walklab.steering.space import Axis, ParameterSpace

Array = NDArray[np.float64]


def as_grid(values: Any, space: ParameterSpace, figure: str) -> Array:
    """A map as an array of the space's shape, from that shape or from a flat vector of cells.

    Raises
    ------
    InputError
        If the number of cells is not the space's, nothing in it is finite, or the space has one axis.
    """
    array = np.asarray(values, dtype=float)
    if array.size != int(np.prod(space.shape)):
        raise InputError(f"{figure}: the map has {array.size} cells, the space {int(np.prod(space.shape))}; they belong together")
    if not np.isfinite(array).any():
        raise InputError(f"{figure}: the map has no finite value; check the stage that writes it")
    if len(space.axes) < 2:
        raise InputError(f"{figure}: the space has one axis; a map is drawn over at least two")
    return array.reshape(space.shape)


def best_cell(grid: Array) -> tuple[int, ...]:
    """Index of the most suitable cell (the first of equals)."""
    return tuple(int(i) for i in np.unravel_index(np.nanargmax(grid), grid.shape))


def slice_through(grid: Array, at: tuple[int, ...], kept: tuple[int, ...]) -> Array:
    """The map over the kept axes, the other axes held at a cell; kept axes in the order given."""
    index = tuple(slice(None) if axis in kept else at[axis] for axis in range(grid.ndim))
    cut = grid[index]
    return np.transpose(cut, np.argsort(np.argsort(kept)))


def norm_of(*grids: Array) -> Normalize:
    """One colour scale for several maps."""
    low = min(float(np.nanmin(grid)) for grid in grids)
    high = max(float(np.nanmax(grid)) for grid in grids)
    return Normalize(low, high if high > low else low + 1.0)


def cube(figure: Figure, position: tuple[float, float, float, float], zoom: float = 0.82) -> Any:
    """Three-dimensional axes with quiet panes in a rectangle of the figure; later artists cover earlier ones."""
    ax: Any = figure.add_axes(position, projection="3d")
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_pane_color((1, 1, 1, 0))
        axis._axinfo["grid"].update(color="#E3E3E3", linewidth=0.4)
        axis.line.set_linewidth(0.6)
    ax.view_init(elev=24, azim=-52)
    ax.set_proj_type("ortho")
    ax.set_box_aspect((1, 1, 0.85), zoom=zoom)
    ax.computed_zorder = False
    ax.set_facecolor("none")
    return ax


def in_mm(figure: Figure, left: float, bottom: float, width: float, height: float) -> tuple[float, float, float, float]:
    """A rectangle given in millimetres, as fractions of the figure."""
    across, up = figure.get_size_inches() * 25.4
    return left / across, bottom / up, width / across, height / up


def note(figure: Figure, left_mm: float, bottom_mm: float, index: int, text: str = "") -> None:
    """A panel title where axes give it no good place: a bold letter and a few words."""
    x, y = in_mm(figure, left_mm, bottom_mm, 0, 0)[:2]
    figure.text(x, y, f"{bold_letter(index)}  {text}", fontsize=7.5)


def label_cube(ax: Any, labels: list[str], ticks: int = 3, pad: tuple[float, float, float] = (-9.0, -9.0, -9.0)) -> None:
    """Name the three axes, close to them."""
    for axis, text, distance in zip((ax.xaxis, ax.yaxis, ax.zaxis), labels, pad, strict=True):
        axis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 5, 10]))
        axis.set_label_text(text)
        axis.labelpad = distance
    # The lowest number of the second axis would run into the highest of the first.
    low, high = ax.get_ylim()
    ax.set_yticks([at for at in ax.get_yticks() if low + 0.12 * (high - low) < at < high])
    ax.tick_params(pad=-4, labelsize=6)
    ax.zaxis.set_tick_params(pad=-1.5)


def draw_cells(ax: Any, grid: Array, space: ParameterSpace, norm: Normalize, size: float = 16.0, labels: bool = True) -> None:
    """Every cell as a dot over the first three axes; unsuitable cells fade so that the inside can be seen."""
    if grid.ndim < 3:
        raise InputError("draw_cells: needs a map over three axes; draw a slice of this one")
    axes = space.axes[:3]
    cube_grid = slice_through(grid, best_cell(grid), (0, 1, 2))
    places = np.stack(np.meshgrid(*(axis.values for axis in axes), indexing="ij"), axis=-1).reshape(-1, 3)
    values = cube_grid.ravel()
    finite = np.isfinite(values)
    places, values = places[finite], values[finite]
    order = np.argsort(values, kind="stable")
    places, values = places[order], values[order]
    weight = np.clip(norm(values), 0, 1)
    colours = ScalarMappable(norm, SUITABILITY).to_rgba(values)
    colours[:, 3] = 0.08 + 0.92 * weight**2.5
    ax.scatter(*places.T, s=size * (0.15 + 0.85 * weight**2), c=colours, linewidths=0, depthshade=False, rasterized=True)
    if labels:
        label_cube(ax, [quantity(axis.name, axis.unit) for axis in axes])


def edges(axis: Axis) -> Array:
    """Borders between cells: midway between grid values, and as far outside at the ends."""
    values = np.array(axis.values)
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def draw_slice(
    ax: Axes, grid: Array, space: ParameterSpace, kept: tuple[int, int], norm: Normalize, at: tuple[int, ...], mark: bool = True
) -> Any:
    """A slice over two axes through cell ``at``; that cell is ringed."""
    first, second = (space.axes[i] for i in kept)
    values = slice_through(grid, at, kept)
    mesh = ax.pcolormesh(edges(first), edges(second), values.T, norm=norm, cmap=SUITABILITY, rasterized=True)
    if mark:
        ax.plot(first.values[at[kept[0]]], second.values[at[kept[1]]], "o", mfc="none", mec="black", mew=0.9, ms=5)
    ax.set_xlabel(quantity(first.name, first.unit))
    ax.set_ylabel(quantity(second.name, second.unit))
    for spine in ax.spines.values():
        spine.set_visible(True)
    return mesh


def held_text(space: ParameterSpace, kept: tuple[int, ...], at: tuple[int, ...]) -> str:
    """What the other axes of a slice are held at, e.g. ``omega = 1.36 1/m``; a line each."""
    held = [axis for i, axis in enumerate(space.axes) if i not in kept]
    values = [axis.values[at[i]] for i, axis in enumerate(space.axes) if i not in kept]
    return "\n".join(
        f"{symbol(axis.name)} = {value:.2f} {unit_text(axis.unit)}" for axis, value in zip(held, values, strict=True)
    )
