"""Motion models: dependencies -> steering parameters (sections 5 and 7.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.bounds import block_bounds, tightened
from walklab.steering.domain import DomainOfValidity, fit_domain
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.modes import modes
from walklab.steering.sampling import draw
from walklab.steering.space import ParameterSpace
from walklab.steering.weighting import Weighting, mix

Array = NDArray[np.float64]

# Above this exponent a tight bound saves more rejected proposals than it costs (a few ms per walk).
LOOSE_BOUND_EXPONENT = 8.0

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
class ProbabilisticModel:
    """P_Prob: parameters drawn from the suitability interpolated for a walk's dependencies.

    Order of the steps: suitability of each map (already in the blending space) -> blend of the k
    nearest -> radial basis functions -> clipping at zero -> exponent -> rejection under a bound
    that covers the interpolant's overshoot. Variants (another k, weights, exponent or held
    parameters) are made with :func:`dataclasses.replace` and share coefficients and bounds.

    Attributes
    ----------
    blending : dependency blending space, N entries
    space : parameter space, C cells
    interpolant : radial basis functions over the grid
    coefficients : (N, terms) of every map
    bounds : (N, B) upper bound of every interpolated map in every block of the grid
    domain : where the model was trained
    k : neighbours
    weights : how they are weighted
    exponent : sharpness; 1 is the paper's literal reading
    fixed : parameters held at a value; the map is the slice there
    provenance : plain data on where the model comes from
    """

    blending: BlendingSpace
    space: ParameterSpace
    interpolant: GridInterpolant
    coefficients: Array
    bounds: NDArray[np.float32]
    domain: DomainOfValidity
    k: int = 100
    weights: Weighting = "linear"
    exponent: float = 1.0
    fixed: Mapping[str, float] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 1 <= self.k <= len(self.blending):
            raise InputError(f"model.k = {self.k}: must lie between 1 and the blending space's {len(self.blending)} entries")
        if not self.exponent > 0:
            raise InputError(f"model.exponent = {self.exponent}: must be positive")
        for name, value in self.fixed.items():
            if name not in self.space.names:
                raise InputError(f"model.fixed: there is no parameter {name!r}; choose from {', '.join(self.space.names)}")
            low, high = self.space.bounds[self.space.names.index(name)]
            if not low <= value <= high:
                raise InputError(f"model.fixed: {name} = {value} lies outside the parameter space, {low} to {high}")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the steering parameters."""
        return self.space.names

    @property
    def dependencies(self) -> tuple[str, ...]:
        """Names of the dependencies."""
        return self.blending.names

    @property
    def dependency_units(self) -> tuple[str, ...]:
        """Units of the dependencies."""
        return self.blending.units

    @cached_property
    def box(self) -> Array:
        """(P, 2) lowest and highest value of each parameter, equal where it is held."""
        held = self.space.bounds.copy()
        for name, value in self.fixed.items():
            held[self.space.names.index(name)] = value
        return held

    @cached_property
    def _open_blocks(self) -> NDArray[np.int64]:
        """Blocks of the grid that the box touches."""
        low, high = self.space.to_unit(self.box.T)
        shape = tuple(n - 1 for n in self.space.shape)
        first = np.clip(np.ceil(low).astype(int) - 1, 0, None)
        last = np.minimum(high.astype(int), np.array(shape) - 1)
        ranges = [np.arange(a, b + 1) for a, b in zip(first, last, strict=True)]
        blocks = np.ravel_multi_index(tuple(np.meshgrid(*ranges, indexing="ij")), shape)
        return blocks.ravel().astype(np.int64)

    def blend(self, vectors: ArrayLike) -> Array:
        """Blended suitability maps, (W, C), at the grid nodes."""
        return self._mixed(vectors, self.blending.maps)

    def blended_coefficients(self, vectors: ArrayLike) -> Array:
        """Coefficients of the blended maps, (W, terms)."""
        return self._mixed(vectors, self.coefficients)

    def _mixed(self, vectors: ArrayLike, rows: Array) -> Array:
        indices, shares = self.blending.neighbours(vectors, self.k, self.weights)
        # One product per walk, so that a walk's numbers do not depend on which others are asked for.
        return np.array([mix(rows, index, share) for index, share in zip(indices, shares, strict=True)]).reshape(
            -1, rows.shape[1]
        )

    def density(self, vector: ArrayLike, points: ArrayLike) -> Array:
        """``max(f, 0)^exponent`` at (L, P) parameter vectors, (L,); proportional to the sampling density."""
        steps = self.space.to_unit(np.atleast_2d(np.asarray(points, dtype=float)))
        surface = self.interpolant.evaluate(self.blended_coefficients(vector)[0], steps)
        return np.maximum(surface, 0.0) ** self.exponent

    def upper_bound(self, vector: ArrayLike) -> float:
        """At least the maximum of the interpolated map (before the exponent) in the box."""
        indices, shares = self.blending.neighbours(vector, self.k, self.weights)
        return self._bound(indices[0], shares[0], mix(self.coefficients, indices[0], shares[0]))

    def _bound(self, indices: NDArray[np.int64], shares: Array, surface: Array) -> float:
        coarse = mix(self.bounds, indices, shares)[self._open_blocks]
        loose = self.exponent <= LOOSE_BOUND_EXPONENT
        highest = coarse.max() if loose else tightened(self.interpolant, surface, coarse, self._open_blocks)
        return float(highest) + 1e-9  # far above the rounding of two sums in different orders

    def sample(self, vector: ArrayLike, size: int, rng: np.random.Generator) -> Array:
        """Draw (size, P) parameter vectors for one dependency vector."""
        indices, shares = self.blending.neighbours(vector, self.k, self.weights)
        return self._draw(indices[0], shares[0], size, rng)

    def _draw(self, indices: NDArray[np.int64], shares: Array, size: int, rng: np.random.Generator) -> Array:
        surface = mix(self.coefficients, indices, shares)
        return draw(
            self.interpolant, self.space, surface, self._bound(indices, shares, surface), self.exponent, self.box, size, rng
        )

    def parameters(self, vectors: ArrayLike, generators: Generators | None = None) -> Array:
        """One draw per walk, (W, P); walk i draws from ``generators[i]`` only.

        Raises
        ------
        ValueError
            If there is not one generator per walk.
        """
        indices, shares = self.blending.neighbours(vectors, self.k, self.weights)
        if generators is None or len(generators) != len(indices):
            raise ValueError("the probabilistic model needs one random generator per walk")
        drawn = [self._draw(i, s, 1, rng)[0] for i, s, rng in zip(indices, shares, generators, strict=True)]
        return np.array(drawn).reshape(-1, len(self.names))

    def mode(self, vectors: ArrayLike) -> Array:
        """Highest point of the interpolated maps, (W, P); see :meth:`ParameterSpace.on_edge` for edge optima."""
        low, high = self.space.to_unit(self.box.T)
        found = self.space.from_unit(modes(self.interpolant, self.blended_coefficients(vectors), low, high)[0])
        for name, value in self.fixed.items():
            found[:, self.names.index(name)] = value
        return found

    def inside(self, vectors: ArrayLike) -> NDArray[np.bool_]:
        """Whether each dependency vector lies in the domain of validity, (W,)."""
        return self.domain.inside(vectors)


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


def probabilistic_model(
    blending: BlendingSpace,
    space: ParameterSpace,
    interpolant: GridInterpolant | None = None,
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
    domain = fit_domain(blending.vectors[~blending.is_blend], blending.scaling)
    bounds = block_bounds(basis, coefficients)
    return ProbabilisticModel(
        blending, space, basis, coefficients, bounds, domain, k, weights, exponent, dict(fixed or {}), dict(provenance or {})
    )
