"""From raw scores to a motion model in one call: what training, ablations and cross-validation repeat."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.steering.blending_space import BlendingSpace, homogenise
from walklab.steering.interpolation import Basis, Kernel, interpolant_named
from walklab.steering.models import ProbabilisticModel, probabilistic_model
from walklab.steering.scaling import ScalingRule, fit_scaling
from walklab.steering.space import ParameterSpace
from walklab.steering.suitability import Normalisation, normalise
from walklab.steering.weighting import Weighting

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TrainingSettings:
    """Choices of the model, named as in the configuration.

    Attributes
    ----------
    normalisation : scores to suitability
    scaling : what each dependency is divided by before distances are measured
    count : entries of the blending space after up-sampling; None adds none
    neighbours, subset, delta : of the up-sampling
    basis : how maps are interpolated between grid nodes: ``rbf`` (the paper) or ``multilinear``
    kernel, epsilon : of the radial basis functions
    k, weights, exponent : of the model
    """

    normalisation: Normalisation = "per_map_max"
    scaling: ScalingRule = "standard_deviation"
    count: int | None = 5000
    neighbours: int = 50
    subset: int = 4
    delta: float = 0.1
    basis: Basis = "rbf"
    kernel: Kernel = "multiquadric"
    epsilon: float = 1.0
    k: int = 100
    weights: Weighting = "linear"
    exponent: float = 1.0


def train_blending_space(
    scores: Array, vectors: pd.DataFrame, participants: Sequence[str], settings: TrainingSettings, rng: np.random.Generator
) -> BlendingSpace:
    """Suitability of the scores, scaled dependencies, and the up-sampled blending space.

    Parameters
    ----------
    scores : (W, C) raw metric, smaller is better
    vectors : (W, D) dependencies; its columns name them
    participants : (W,) who walked
    """
    values = vectors.to_numpy(dtype=float)
    return homogenise(
        values,
        normalise(scores, settings.normalisation),
        len(values) if settings.count is None else settings.count,
        settings.neighbours,
        settings.subset,
        settings.delta,
        rng,
        names=tuple(vectors.columns),
        scaling=fit_scaling(values, participants, settings.scaling),
    )


def train(
    scores: Array,
    vectors: pd.DataFrame,
    participants: Sequence[str],
    space: ParameterSpace,
    settings: TrainingSettings,
    rng: np.random.Generator,
    fixed: Mapping[str, float] | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> ProbabilisticModel:
    """A probabilistic model from raw scores; drop a column of ``vectors`` to train without a dependency."""
    blending = train_blending_space(scores, vectors, participants, settings, rng)
    interpolant = interpolant_named(settings.basis, space.shape, settings.kernel, settings.epsilon)
    return probabilistic_model(
        blending,
        space,
        interpolant,
        k=settings.k,
        weights=settings.weights,
        exponent=settings.exponent,
        fixed=fixed,
        provenance=provenance,
    )
