"""What all figures share: one style, one colour per model, checks of what is drawn, and saving.

Figures are ``matplotlib.figure.Figure`` objects made without pyplot, so that no global
state decides what they look like. Colours are those of Okabe and Ito (2008), which
people with any common colour vision can tell apart.
"""

from __future__ import annotations

import contextlib
import functools
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.storage import atomic_path

Array = NDArray[np.float64]

SINGLE_MM = 88.0
DOUBLE_MM = 180.0
PNG_DPI = 300

BLACK, ORANGE, SKY, GREEN, BLUE, VERMILLION, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)
PUBLISHED = "#6E6E6E"  # always a hollow marker or an outline
FAINT = "#C8C8C8"
OBSTACLE = "#D9D9D9"

WINE, INDIGO = "#882255", "#332288"  # of Paul Tol's muted set, apart from the others for every kind of colour vision

MODEL_COLOURS: dict[str, str] = {
    "Ref": BLACK,
    "P_Stat": ORANGE,
    "P_Adapt": GREEN,
    "P_Prob": BLUE,
    "P_Prob (calibrated)": WINE,
    "P_Prob (extended)": INDIGO,
}
OTHER_MODEL = PURPLE  # baselines that the paper does not have
SET_COLOURS = (SKY, VERMILLION, PURPLE, "#F0E442")  # data sets, in the order given: never a model's colour
PUBLISHED_MARK: dict[str, Any] = {"marker": "D", "mfc": "white", "mec": PUBLISHED, "mew": 1.0, "ms": 4.5, "ls": "none"}
SUITABILITY = "viridis"  # yellow is suitable, as in the paper

RC: Any = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # shipped with matplotlib: the same metrics on every machine
    "mathtext.default": "regular",
    "text.hinting": "none",  # as wide at every resolution: what was laid out at one fits at any other
    "font.size": 7,
    "axes.titlesize": 7.5,
    "axes.labelsize": 7,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "legend.handlelength": 1.4,
    "legend.borderaxespad": 0.2,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.titlelocation": "left",
    "axes.titlepad": 4,
    "axes.labelpad": 2.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.major.pad": 2,
    "ytick.major.pad": 2,
    "lines.linewidth": 1.0,
    "lines.markersize": 4,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.5,
    "figure.dpi": 200,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.fonttype": "none",
    "svg.hashsalt": "walklab",
    "image.interpolation": "nearest",
}

P = ParamSpec("P")


@contextlib.contextmanager
def style() -> Iterator[None]:
    """The style, whatever the caller's matplotlib settings are; matplotlib reads some of them only when it draws."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(RC)
        yield


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Run a drawing function under the style and lay its figure out."""

    @functools.wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with style():
            return _settled(draw(*args, **kwargs))

    return wrapper


def _settled(figure: Figure) -> Figure:
    """Lay the figure out once and keep the result, rounded.

    The constraint solver's last bits depend on the order of objects in memory; without rounding, the identifiers in
    an SVG, which are digests of positions, would differ from run to run.
    """
    if isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
        for _ in range(3):  # a new size may change the ticks, and these the size
            figure.draw_without_rendering()
        figure.set_layout_engine("none")
        for ax in figure.axes:
            ax.set_position(tuple(round(value, 6) for value in ax.get_position(original=True).bounds))
    return figure


def new_figure(width_mm: float, height_mm: float, constrained: bool = True) -> Figure:
    """An empty figure of exactly this size."""
    layout = ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.03, wspace=0.03, hspace=0.03) if constrained else None
    return Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout=layout)


def save(figure: Figure, path_svg: str | Path, path_png: str | Path, dpi: int = PNG_DPI) -> None:
    """Write a figure as SVG (text stays text) and PNG, atomically and without dates or versions."""
    with style(), atomic_path(path_svg) as temporary:
        figure.savefig(temporary, format="svg", dpi=dpi, metadata={"Date": None, "Creator": None})
    save_png(figure, path_png, dpi)


def save_png(figure: Figure, path: str | Path, dpi: int = PNG_DPI) -> None:
    """Write a figure as PNG alone, atomically and without the writer's version."""
    with style(), atomic_path(path) as temporary:
        figure.savefig(temporary, format="png", dpi=dpi, metadata={"Software": None})


def colour(model: str) -> str:
    """The one colour of a model; a variant such as ``P_Prob without dependencies`` has its model's."""
    for name in sorted(MODEL_COLOURS, key=len, reverse=True):
        if model == name or model.startswith((f"{name}_", f"{name} ", f"{name},")):
            return MODEL_COLOURS[name]
    return OTHER_MODEL


def read_name(model: str) -> str:
    """A model's name as it is read: the paper's model, beside its calibrated variant, is the literal one."""
    return "P_Prob (literal)" if model == "P_Prob" else model


def model_label(model: str) -> str:
    """A model's name as it is read, and its first word as the paper sets it, with an index."""
    found = re.fullmatch(r"P_([A-Za-z]+)(.*)", read_name(model))
    return f"$P_{{{found[1]}}}${found[2].replace('_', ' ')}" if found else model.replace("_", " ")


GREEK = {"omega", "tau", "alpha", "beta", "gamma", "theta", "kappa", "sigma", "lambda", "mu"}


def set_label(name: str) -> str:
    """``scenario_1`` in words."""
    return name.replace("_", " ")


def symbol(name: str) -> str:
    """A parameter's name as a symbol: omega in Greek, single letters in italics, words as they are."""
    if name in GREEK:
        return f"$\\mathit{{\\{name}}}$"
    return f"$\\mathit{{{name}}}$" if len(name) == 1 else name.replace("_", " ")


def quantity(name: str, unit: str) -> str:
    """An axis label: the quantity and its unit."""
    return f"{symbol(name)} ({unit_text(unit)})" if unit else symbol(name)


def unit_text(unit: str) -> str:
    """A unit with its square as a superscript."""
    return unit.replace("s2", "s²").replace("m2", "m²").replace("^2", "²")


def require(frame: pd.DataFrame, columns: Iterable[str], figure: str, values: Iterable[str] = ()) -> None:
    """Refuse a table that would give a blank figure.

    Parameters
    ----------
    columns : columns that must exist
    values : columns of numbers that must hold at least one finite value

    Raises
    ------
    InputError
        If the table has no rows, lacks a column, or a column of ``values`` has nothing to draw.
    """
    missing = [name for name in (*columns, *values) if name not in frame.columns]
    if missing:
        raise InputError(f"{figure}: the table lacks column {missing[0]!r}; it has {sorted(map(str, frame.columns))}")
    if frame.empty:
        raise InputError(f"{figure}: the table has no rows; check the stage that writes it")
    for name in values:
        if not np.isfinite(pd.to_numeric(frame[name], errors="coerce").to_numpy(dtype=float)).any():
            raise InputError(f"{figure}: column {name!r} has no finite value; check the stage that writes it")


def require_array(values: Any, figure: str, what: str, dimensions: int | None = None) -> Array:
    """The values as an array of numbers with something in it.

    Raises
    ------
    InputError
        If the array is empty, has the wrong number of dimensions, or holds no finite value.
    """
    array = np.asarray(values, dtype=float)
    if dimensions is not None and array.ndim != dimensions:
        raise InputError(f"{figure}: {what} has {array.ndim} dimensions, needs {dimensions}; pass one value per cell")
    if array.size == 0 or not np.isfinite(array).any():
        raise InputError(f"{figure}: {what} has no finite value; check the stage that writes it")
    return array


def letter(ax: Axes, index: int, text: str = "") -> None:
    """Panel title: a bold letter and, if given, a few words."""
    ax.set_title(f"{bold_letter(index)}  {text}".rstrip(), loc="left")


def bold_letter(index: int) -> str:
    """a, b, c, ... in bold."""
    return f"$\\mathbf{{{'abcdefghijklmnopqrstuvwxyz'[index]}}}$"


def plain_log_axis(ax: Axes, from_ratio: float) -> None:
    """A logarithmic y axis with plain numbers, if the data span more than a ratio."""
    low, high = ax.dataLim.ymin, ax.dataLim.ymax
    if not (low > 0 and high / low >= from_ratio):
        return
    ax.set_yscale("log")
    # A margin in the logarithm, and the finer steps only where they have room.
    ax.set_ylim(low / (high / low) ** 0.06 / 1.02, high * (high / low) ** 0.06 * 1.02)
    steps = (1.0,) if high / low > 300 else (1.0, 2.0, 5.0) if high / low > 15 else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
    ax.yaxis.set_major_locator(LogLocator(subs=steps))
    ax.yaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def spread(count: int, width: float) -> Array:
    """Fixed sideways offsets that keep points of one group apart (no random jitter: figures are deterministic)."""
    golden = (np.sqrt(5) - 1) / 2
    return width * (np.mod(np.arange(count) * golden, 1.0) - 0.5)


def ordered_models(names: Sequence[str]) -> list[str]:
    """Known models in the paper's order, then the others as they come."""
    present = list(dict.fromkeys(names))
    return [name for name in MODEL_COLOURS if name in present] + [name for name in present if name not in MODEL_COLOURS]
