"""Densities of single steering parameters and of pairs, the others integrated out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError

if TYPE_CHECKING:
    from walklab.steering.probabilistic import ProbabilisticModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Marginal:
    """Density of one or two parameters.

    Attributes
    ----------
    names, units : of the parameters
    values : middles of the intervals along each parameter
    widths : of the intervals
    density : per unit of the parameters, integrates to 1; (n,) or (n, m)
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: tuple[Array, ...]
    widths: tuple[Array, ...]
    density: Array


def marginal(model: ProbabilisticModel, vector: ArrayLike, names: Sequence[str], points_per_step: int = 4) -> Marginal:
    """Density of one or two free parameters for one dependency vector, by the midpoint rule.

    Parameters
    ----------
    names : one or two
    points_per_step : intervals per grid step, along every parameter

    Raises
    ------
    InputError
        If a name is unknown, repeated or of a held parameter, or there are none or more than two.
    """
    free = [name for name in model.names if name not in model.fixed]
    if not 1 <= len(names) <= 2 or len(set(names)) != len(names) or any(name not in free for name in names):
        raise InputError(f"marginal: give one or two of the free parameters {', '.join(free)}; asked for {', '.join(names)}")
    values, widths = [], []
    for axis, (low, _) in zip(model.space.axes, model.box, strict=True):
        if axis.name in model.fixed:
            values.append(np.array([low]))
            widths.append(np.ones(1))
            continue
        ends = np.interp(
            np.arange((len(axis.values) - 1) * points_per_step + 1) / points_per_step, np.arange(len(axis.values)), axis.values
        )
        values.append((ends[1:] + ends[:-1]) / 2)
        widths.append(np.diff(ends))
    points = np.stack(np.meshgrid(*values, indexing="ij"), axis=-1).reshape(-1, len(values))
    mass = model.density(vector, points).reshape([len(v) for v in values])
    for axis_number, width in enumerate(widths):
        mass = mass * width.reshape([-1 if other == axis_number else 1 for other in range(len(widths))])
    chosen = [model.names.index(name) for name in names]
    mass = mass.sum(axis=tuple(a for a in range(len(values)) if a not in chosen))
    if chosen != sorted(chosen):
        mass = mass.T
    density = mass / mass.sum()
    for position, number in enumerate(chosen):
        density = density / widths[number].reshape([-1 if other == position else 1 for other in range(len(chosen))])
    units = tuple(model.units[number] for number in chosen)
    return Marginal(tuple(names), units, tuple(values[n] for n in chosen), tuple(widths[n] for n in chosen), density)
