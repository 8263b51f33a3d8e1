"""Blended maps and draws on a lattice of dependency vectors: what the page's view of the maps shows without Python.

Each lattice point holds the model's own answer, so nothing is recomputed or approximated in the browser but the
rounding of suitability to one of 256 steps.
"""

from __future__ import annotations

import base64
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from walklab.steering.domain import OutsideTrainingRange
from walklab.steering.models import ProbabilisticModel
from walklab.steering.space import ParameterSpace

Array = NDArray[np.float64]

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


def map_lattice(models: Mapping[str, ProbabilisticModel], rng: np.random.Generator) -> dict[str, Any]:
    """Blended maps, draws and modes on the lattice, as plain data for the page.

    Parameters
    ----------
    models : name -> model; they differ in the exponent alone and so share their blended maps

    Returns
    -------
    dict: ``dependencies`` and ``parameters`` (name, unit, values), ``maps`` (base64 bytes, points x cells, 255 is suitability 1),
    ``inside`` (one 0 or 1 per point), ``modes`` (points x parameters) and ``models`` (name, exponent, ``draws``: points x draws x
    parameters), both as base64 bytes in 1/255 of each parameter's range; the exponent does not move the mode
    """
    first = next(iter(models.values()))
    axes = lattice_axes(first.blending.vectors)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes)) if axes else np.zeros((1, 0))
    maps = shown_grid(first.blend(points), first.space)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutsideTrainingRange)  # said on the page, point by point
        draws = {name: model.sample_batch(points, DRAWS, rng) for name, model in models.items()}
    return {
        "dependencies": [
            {"name": name, "unit": unit, "values": [round(float(value), 4) for value in values]}
            for name, unit, values in zip(first.dependencies, first.dependency_units, axes, strict=True)
        ],
        "parameters": [
            {"name": axis.name, "unit": axis.unit, "values": list(axis.values)} for axis in first.space.axes[:SHOWN_AXES]
        ],
        "maps": _bytes(maps),
        "inside": "".join("1" if inside else "0" for inside in first.domain.inside(points)),
        "draws": DRAWS,
        "modes": _bytes(_share_of_range(first.mode(points), first.space)),
        "models": [
            {
                "name": name,
                "exponent": model.exponent,
                "draws": _bytes(_share_of_range(draws[name], model.space)),
            }
            for name, model in models.items()
        ],
    }


def _share_of_range(parameters: Array, space: ParameterSpace) -> Array:
    low, high = space.bounds[:SHOWN_AXES].T
    return (parameters[..., :SHOWN_AXES] - low) / (high - low)


def _bytes(shares: Array) -> str:
    """Shares of one as base64 bytes."""
    return base64.b64encode(np.clip(np.rint(shares * 255), 0, 255).astype(np.uint8).tobytes()).decode()
