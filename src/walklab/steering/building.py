"""Building the probabilistic model from a blending space: what is computed once, so that sampling is quick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.bounds import block_bounds, rungs_above
from walklab.steering.domain import fit_domain
from walklab.steering.interpolation import GridInterpolant, Interpolant
from walklab.steering.multilinear import MultilinearInterpolant
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.space import ParameterSpace
from walklab.steering.weighting import Weighting

Array = NDArray[np.float64]

# Coefficients are kept in single precision where that moves no map by more than this at any node: it halves what has to
# be read from memory for a sample, which is most of its cost.
SINGLE_PRECISION_ERROR = 1e-5


def probabilistic_model(
    blending: BlendingSpace,
    space: ParameterSpace,
    interpolant: Interpolant | None = None,
    *,
    k: int = 100,
    weights: Weighting = "linear",
    exponent: float = 1.0,
    fixed: Mapping[str, float] | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> ProbabilisticModel:
    """Solve the interpolant for every map of a blending space, bound the surfaces and fix the domain of validity.

    The domain is the convex hull of the captured vectors; blends may lie a little outside of it.

    Raises
    ------
    InputError
        If the maps do not belong to the space, or a setting is out of range.
    """
    basis = GridInterpolant(space.shape) if interpolant is None else interpolant
    if basis.shape != space.shape:
        raise InputError(f"the interpolant's grid {basis.shape} is not the parameter space's {space.shape}")
    coefficients = basis.coefficients(blending.maps)
    if isinstance(basis, MultilinearInterpolant):
        rungs, rung = rungs_above(coefficients)
    else:
        coefficients = single_precision(basis, coefficients)
        rungs, rung = rungs_above(block_bounds(basis, coefficients))
    domain = fit_domain(blending.vectors[~blending.is_blend], blending.scaling)
    return ProbabilisticModel(
        blending, space, basis, coefficients, rungs, rung, domain, k, weights, exponent, dict(fixed or {}), dict(provenance or {})
    )


def single_precision(basis: GridInterpolant, coefficients: Array, batch: int = 512) -> NDArray:
    """Coefficients in single precision if no map moves by more than SINGLE_PRECISION_ERROR at a node, else as they are."""
    rounded = coefficients.astype(np.float32)
    at_nodes = basis.basis(basis.nodes)
    for start in range(0, len(coefficients), batch):
        rows = slice(start, start + batch)
        if np.abs((rounded[rows] - coefficients[rows]) @ at_nodes.T).max() > SINGLE_PRECISION_ERROR:
            return coefficients
    return rounded
