"""Blended maps and draws on a lattice of dependency vectors: what the page's view of the maps shows without Python.

Each lattice point holds the model's own answer, so nothing is recomputed or approximated in the browser but the
rounding of suitability to one of 256 steps.
"""

from __future__ import annotations

import base64
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from walklab.steering.domain import OutsideTrainingRange
from walklab.steering.models import ProbabilisticModel
from walklab.steering.space import ParameterSpace

Array = NDArray[np.float64]
Exponents = Callable[[Array], Array]

POINTS = 600  # lattice points at most: about 0.8 MB of a page
DRAWS = 40
SHOWN_AXES = 3


def steps_of(count: int) -> tuple[int, ...]:
    """How many values each of ``count`` dependencies takes: the first ones, which come first in the paper, take most.

    Their product stays at or below ``POINTS``.
    """
    fixed = {0: (), 1: (60,), 2: (30, 20), 3: (12, 10, 5)}
    return fixed[count] if count in fixed else (max(int(POINTS ** (1 / count)), 2),) * count


def lattice_axes(vectors: Array) -> list[Array]:
    """Values of each dependency: evenly from the lowest to the highest entry of the blending space, one where all agree."""
    axes = []
    for column, steps in zip(vectors.T, steps_of(vectors.shape[1]), strict=True):
        low, high = float(column.min()), float(column.max())
        axes.append(np.linspace(low, high, steps) if high > low else np.array([low]))
    return axes


def shown_grid(blended: Array, space: ParameterSpace) -> Array:
    """(W, n1, n2, n3) maps over the first three parameters: the best over further ones, one layer where there are fewer."""
    grid = blended.reshape(len(blended), *space.shape)
    if grid.ndim - 1 > SHOWN_AXES:
        return grid.max(axis=tuple(range(SHOWN_AXES + 1, grid.ndim)))
    return grid.reshape(*grid.shape, *(1,) * (SHOWN_AXES + 1 - grid.ndim))


def map_lattice(model: ProbabilisticModel, sharpness: Mapping[str, Exponents], rng: np.random.Generator) -> dict[str, Any]:
    """Blended maps, draws and modes on the lattice, as plain data for the page.

    Parameters
    ----------
    sharpness : name of a model -> its exponent for each of (W, D) dependency vectors, (W,); all share the blended maps

    Returns
    -------
    dict: ``dependencies`` and ``parameters`` (name, unit, values), ``maps`` (base64 bytes, points x cells, 255 is suitability 1),
    ``inside`` (one 0 or 1 per point), ``modes`` (points x parameters) and ``models`` (name, ``exponents`` by point, ``draws``:
    points x draws x parameters), both as base64 bytes in 1/255 of each parameter's range; the exponent does not move the mode
    """
    axes = lattice_axes(model.blending.vectors)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes)) if axes else np.zeros((1, 0))
    exponents = {name: rule(points) for name, rule in sharpness.items()}
    return {
        "dependencies": [
            {"name": name, "unit": unit, "values": [round(float(value), 4) for value in values]}
            for name, unit, values in zip(model.dependencies, model.dependency_units, axes, strict=True)
        ],
        "parameters": [
            {"name": axis.name, "unit": axis.unit, "values": list(axis.values)} for axis in model.space.axes[:SHOWN_AXES]
        ],
        "maps": _bytes(shown_grid(model.blend(points), model.space)),
        "inside": "".join("1" if inside else "0" for inside in model.domain.inside(points)),
        "draws": DRAWS,
        "modes": _bytes(_share_of_range(model.mode(points), model.space)),
        "models": [
            {
                "name": name,
                "exponents": [round(float(value), 3) for value in values],
                "draws": _bytes(_share_of_range(drawn(model, points, values, rng), model.space)),
            }
            for name, values in exponents.items()
        ],
    }


def drawn(model: ProbabilisticModel, points: Array, exponents: Array, rng: np.random.Generator) -> Array:
    """(W, DRAWS, P) draws, each point with its own exponent."""
    draws = np.empty((len(points), DRAWS, len(model.names)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutsideTrainingRange)  # said on the page, point by point
        for value in np.unique(exponents):
            rows = exponents == value
            draws[rows] = replace(model, exponent=float(value)).sample_batch(points[rows], DRAWS, rng)
    return draws


def _share_of_range(parameters: Array, space: ParameterSpace) -> Array:
    low, high = space.bounds[:SHOWN_AXES].T
    return (parameters[..., :SHOWN_AXES] - low) / (high - low)


def _bytes(shares: Array) -> str:
    """Shares of one as base64 bytes."""
    return base64.b64encode(np.clip(np.rint(shares * 255), 0, 255).astype(np.uint8).tobytes()).decode()
