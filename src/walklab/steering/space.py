"""The discretised steering-parameter space (Agethen et al. 2017, section 4.3, eq. 6-9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError

Array = NDArray[np.float64]

_PER_SECOND = "/s", " s-1", " s^-1", " s⁻¹", "·s⁻¹", "*s^-1"
_PER_SECOND_SQUARED = "/s²", "/s2", "/s^2", "/s**2", "/s/s", " s-2", " s^-2", " s⁻²", "·s⁻²", "*s^-2"
# Spellings of a unit -> the one that results use.
SPELLINGS = {
    **{f"{unit}{per}": f"{unit}/s" for unit in ("m", "rad") for per in _PER_SECOND},
    **{f"{unit}{per}": f"{unit}/s²" for unit in ("m", "rad") for per in _PER_SECOND_SQUARED},
    **dict.fromkeys(("m-1", "m^-1", "m⁻¹", "m**-1"), "1/m"),
    **dict.fromkeys(("s-1", "s^-1", "s⁻¹", "s**-1", "Hz"), "1/s"),
}


@dataclass(frozen=True)
class Axis:
    """One steering parameter: its name as the planner knows it, its unit and its ascending values.

    A unit in another common spelling (m/s2, m s-2) becomes the one that results use (m/s²).
    """

    name: str
    unit: str
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "unit", SPELLINGS.get(self.unit.strip(), self.unit.strip()))
        if len(self.values) < 2 or np.any(np.diff(self.values) <= 0):
            raise InputError(f"space axis {self.name}: needs at least two ascending values")


@dataclass(frozen=True)
class ParameterSpace:
    """A grid over named steering parameters; cells run with the last axis fastest."""

    axes: tuple[Axis, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(axis.name for axis in self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(axis.values) for axis in self.axes)

    @cached_property
    def cells(self) -> Array:
        """(cells, axes) array: every parameter vector of the grid."""
        grids = np.meshgrid(*(axis.values for axis in self.axes), indexing="ij")
        return np.column_stack([grid.ravel() for grid in grids])

    @cached_property
    def bounds(self) -> Array:
        """(axes, 2) array: lowest and highest value of each parameter."""
        return np.array([(axis.values[0], axis.values[-1]) for axis in self.axes])

    def to_unit(self, parameters: Array) -> Array:
        """Parameters in grid steps: 0 at the first value, n - 1 at the last, linear between grid values."""
        columns = [np.interp(parameters[..., i], axis.values, np.arange(len(axis.values))) for i, axis in enumerate(self.axes)]
        return np.stack(columns, axis=-1)

    def from_unit(self, steps: Array) -> Array:
        """Inverse of :meth:`to_unit`."""
        columns = [np.interp(steps[..., i], np.arange(len(axis.values)), axis.values) for i, axis in enumerate(self.axes)]
        return np.stack(columns, axis=-1)

    def on_edge(self, parameters: Array, tolerance_steps: float = 1e-3) -> NDArray[np.bool_]:
        """Whether each parameter vector lies on the border of the grid, (..., axes) array."""
        steps = self.to_unit(parameters)
        return (steps < tolerance_steps) | (steps > np.array(self.shape) - 1 - tolerance_steps)

    def without(self, name: str) -> ParameterSpace:
        """The same space without one axis."""
        return ParameterSpace(tuple(axis for axis in self.axes if axis.name != name))


def space_from_config(axes: Sequence[Mapping[str, Any]]) -> ParameterSpace:
    """A space from ``[{name, unit, start, step, count}]`` or ``[{name, unit, values}]``."""
    built = []
    for axis in axes:
        values = axis.get("values") or [axis["start"] + i * axis["step"] for i in range(axis["count"])]
        built.append(Axis(axis["name"], axis["unit"], tuple(float(value) for value in values)))
    if len({axis.name for axis in built}) != len(built):
        raise InputError("space: two axes have the same name")
    return ParameterSpace(tuple(built))
