"""Motion models: dependencies -> steering parameters (sections 5 and 7.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.steering.building import probabilistic_model
from walklab.steering.probabilistic import ProbabilisticModel

__all__ = ["AdaptiveModel", "MotionModel", "ProbabilisticModel", "StaticModel", "probabilistic_model"]

Array = NDArray[np.float64]

Generators = Sequence[np.random.Generator]


@runtime_checkable
class MotionModel(Protocol):
    """Steering parameters for walks.

    Attributes
    ----------
    names : of the steering parameters
    """

    @property
    def names(self) -> tuple[str, ...]: ...

    def parameters(self, vectors: ArrayLike, generators: Generators | None = None) -> Array:
        """(W, P) parameters for (W, D) dependency vectors; walk i draws from ``generators[i]`` only."""
        ...


@dataclass(frozen=True)
class StaticModel:
    """P_Stat: the same steering parameters for every walk."""

    names: tuple[str, ...]
    values: tuple[float, ...]

    def parameters(self, vectors: ArrayLike, generators: Generators | None = None) -> Array:
        """(W, P): the one vector, W times."""
        return np.tile(np.array(self.values, dtype=float), (len(np.asarray(vectors)), 1))


@dataclass(frozen=True)
class AdaptiveModel:
    """P_Adapt: the highest point of the same interpolated suitability (section 7.3)."""

    model: ProbabilisticModel

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the steering parameters."""
        return self.model.names

    def parameters(self, vectors: ArrayLike, generators: Generators | None = None) -> Array:
        """The mode for each walk, (W, P); nothing is drawn."""
        return self.model.mode(vectors)

    def inside(self, vectors: ArrayLike) -> NDArray[np.bool_]:
        """Whether each dependency vector lies in the domain of validity, (W,)."""
        return self.model.inside(vectors)
