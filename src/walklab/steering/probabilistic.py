"""P_Prob, the probabilistic motion model (section 5): drawn from the suitability interpolated for a walk's dependencies."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.steering import sampling
from walklab.steering.arguments import as_numbers, count_of, generator_of
from walklab.steering.blending import WEIGHTINGS, blend, blend_up
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.bounds import block_bounds, rungs_above
from walklab.steering.domain import DomainOfValidity, OutsideTrainingRange, outside_message
from walklab.steering.interpolation import Interpolant
from walklab.steering.marginals import Marginal, marginal
from walklab.steering.modes import highest_points
from walklab.steering.multilinear import MultilinearInterpolant
from walklab.steering.proposals import Blocks, blocks_of
from walklab.steering.space import ParameterSpace
from walklab.steering.uniforms import seeds_from
from walklab.steering.weighting import Weighting

Array = NDArray[np.float64]
Generators = Sequence[np.random.Generator]

ROUNDING = 1e-9  # of a parameter, in its unit: what a number may lose on its way
SHARPEST = 1e6  # exponent; beyond it the rounding of the map decides where the draws go


@dataclass(frozen=True)
class ProbabilisticModel:
    """P_Prob: parameters drawn from the suitability interpolated for a walk's dependencies.

    Order of the steps: suitability of each map (already in the blending space) -> blend of the k
    nearest -> interpolation -> clipping at zero -> exponent -> rejection under a bound that covers the
    interpolant's overshoot. Variants (another k, weights, exponent or held parameters) are made
    with :func:`dataclasses.replace` and share coefficients and bounds.

    Attributes
    ----------
    blending : dependency blending space, N entries
    space : parameter space, C cells
    interpolant : radial basis functions over the grid, or the multilinear basis
    coefficients : (N, terms) of every map
    rungs, rung : upper bounds of every map as whole numbers of ``rung``: (N, B), one per block of the grid for
        radial basis functions; (N, C), one per node for the multilinear basis
    domain : where the model was trained
    k : neighbours
    weights : how they are weighted
    exponent : sharpness; 1 is the paper's literal reading
    fixed : parameters held at a value; the map is the slice there
    provenance : plain data on where the model comes from
    origin : the file it was opened from, for messages
    """

    blending: BlendingSpace
    space: ParameterSpace
    interpolant: Interpolant
    coefficients: NDArray
    rungs: NDArray[np.uint8]
    rung: float
    domain: DomainOfValidity
    k: int = 100
    weights: Weighting = "linear"
    exponent: float = 1.0
    fixed: Mapping[str, float] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    origin: str = "model"

    def __post_init__(self) -> None:
        if not 1 <= self.k <= len(self.blending):
            raise InputError(f"model.k = {self.k}: must lie between 1 and the blending space's {len(self.blending)} entries")
        if self.weights not in WEIGHTINGS:
            raise InputError(f"model.weights: there is no {self.weights!r}; choose from {', '.join(WEIGHTINGS)}")
        if not 0 < self.exponent <= SHARPEST:
            raise InputError(
                f"model.exponent = {self.exponent}: must be above 0 and at most {SHARPEST:g}; the mode is what all draws tend to"
            )
        for name, value in self.fixed.items():
            if name not in self.space.names:
                raise InputError(f"model.fixed: there is no parameter {name!r}; choose from {', '.join(self.space.names)}")
            low, high = self.space.bounds[self.space.names.index(name)]
            if not low <= value <= high:
                raise InputError(f"model.fixed: {name} = {value} lies outside the parameter space, {low} to {high}")

    @staticmethod
    def load(path: str | Path) -> ProbabilisticModel:
        """Open a saved model: memory-mapped, so in milliseconds; see :func:`walklab.steering.model_file.read_model`."""
        from walklab.steering.model_file import read_model  # late: that module builds on this one

        return read_model(path, check_all=False)

    def save(self, path: str | Path) -> None:
        """Write the model to one safetensors file."""
        from walklab.steering.model_file import write_model

        write_model(self, path)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the steering parameters."""
        return self.space.names

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the steering parameters."""
        return tuple(axis.unit for axis in self.space.axes)

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
    def _held(self) -> dict[int, float]:
        """Axis -> where it is held, grid steps."""
        at = self.space.to_unit(self.box[:, 0])
        return {self.names.index(name): float(at[self.names.index(name)]) for name in self.fixed}

    @cached_property
    def _bounds(self) -> tuple[NDArray[np.uint8], float]:
        """Rungs and their unit; of the slice where a parameter is held, since the map may be much lower there."""
        if not self.fixed or isinstance(self.interpolant, MultilinearInterpolant):
            return self.rungs, self.rung
        return rungs_above(block_bounds(self.interpolant, self.coefficients, self._held))

    def vector(self, **dependencies: float) -> Array:
        """Dependencies given by name as a (D,) vector in the model's order.

        Raises
        ------
        InputError
            If one is missing or unknown.
        """
        for name in dependencies:
            if name not in self.dependencies:
                raise InputError(f"there is no dependency {name!r}; this model has {', '.join(self.dependencies) or 'none'}")
        for name, unit in zip(self.dependencies, self.dependency_units, strict=True):
            if name not in dependencies:
                raise InputError(f"dependency {name} ({unit}) is missing; this model needs {', '.join(self.dependencies)}")
        return as_numbers([dependencies[name] for name in self.dependencies], self.dependencies)

    def blend(self, vectors: ArrayLike) -> Array:
        """Blended suitability maps, (W, C), at the grid nodes."""
        return self._mixed(vectors, self.blending.maps)

    def blended_coefficients(self, vectors: ArrayLike) -> Array:
        """Coefficients of the blended maps, (W, terms)."""
        return self._mixed(vectors, self.coefficients)

    def _mixed(self, vectors: ArrayLike, rows: NDArray) -> Array:
        indices, shares = self.blending.neighbours(vectors, self.k, self.weights)
        # One sum per walk, so that a walk's numbers do not depend on which others are asked for.
        return np.array([blend(rows, index, share) for index, share in zip(indices, shares, strict=True)]).reshape(
            -1, rows.shape[1]
        )

    def density(self, vector: ArrayLike, points: ArrayLike) -> Array:
        """``max(f, 0)^exponent`` at (L, P) parameter vectors, (L,); proportional to the sampling density.

        It is 0 outside of the parameter space and where a held parameter has another value: nothing is drawn there.

        Raises
        ------
        InputError
            If a point has another number of parameters or is no number, or there is more than one dependency vector.
        """
        asked = np.atleast_2d(np.asarray(points, dtype=float))
        if asked.shape[1] != len(self.names) or not np.isfinite(asked).all():
            raise InputError(f"density: each point needs finite numbers for {', '.join(self.names)}")
        surfaces = self.blended_coefficients(vector)
        if len(surfaces) != 1:
            raise InputError(f"density: {len(surfaces)} dependency vectors were given; ask for one at a time")
        low, high = self.box.T
        drawn = ((asked >= low - ROUNDING) & (asked <= high + ROUNDING)).all(axis=1)
        surface = self.interpolant.evaluate(surfaces[0], self.space.to_unit(asked))
        return np.where(drawn, np.maximum(surface, 0.0) ** self.exponent, 0.0)

    def marginal(self, vector: ArrayLike, *names: str, points_per_step: int = 4) -> Marginal:
        """Density of one or two parameters, the others integrated out; see :func:`walklab.steering.marginals.marginal`."""
        return marginal(self, vector, names, points_per_step)

    def upper_bound(self, vector: ArrayLike) -> float:
        """At least the maximum of the interpolated map (before the exponent) in the box."""
        if len(self.fixed) == len(self.names):
            return float(self.density(vector, self.box[:, 0])[0] ** (1 / self.exponent))
        if isinstance(self.interpolant, MultilinearInterpolant):
            return float(self.interpolant.slice(self.blend(vector), self._held)[1].max())
        indices, shares = self.blending.neighbours(vector, self.k, self.weights)
        return float(blend_up(*self._bounds, indices[0], shares[0]).max())

    def sample(
        self, vector: ArrayLike | None = None, size: int = 1, rng: np.random.Generator | None = None, **dependencies: float
    ) -> Array:
        """Draw (size, P) parameter vectors for one walk.

        Parameters
        ----------
        vector : (D,) dependencies in the model's order; or give each by its name, e.g. ``length=2.5`` (m)
        size : how many to draw
        rng : source of randomness; None takes a fresh one

        Raises
        ------
        InputError
            If a dependency is missing, unknown, not a finite number or negative, ``size`` is no count, or ``rng`` no generator.

        Warns
        -----
        OutsideTrainingRange
            If no training walk is like this one; the sample then comes from the nearest that are.
        """
        if vector is None:
            vector = self.vector(**dependencies)
        elif dependencies:
            raise InputError("give the dependencies as one vector or by their names, not both")
        asked = self._asked(vector)
        if len(asked) != 1:
            raise InputError(f"sample draws for one dependency vector, {len(asked)} were given; see sample_batch")
        return self._draw(asked, generator_of(rng).random(1), count_of(size))[0]

    def sample_batch(self, vectors: ArrayLike, size: int = 1, rng: np.random.Generator | Generators | None = None) -> Array:
        """Draw (W, size, P) parameter vectors for (W, D) dependency vectors at once.

        With one generator per walk, walk i draws from the i-th only, and as :meth:`sample` would. Warns like it, once.
        """
        asked, count = self._asked(vectors), count_of(size)
        if isinstance(rng, Sequence):
            return self._draw(asked, self._seeds(rng, len(asked)), count)
        return self._draw(asked, generator_of(rng).random(len(asked)), count)

    def parameters(self, vectors: ArrayLike, generators: Generators | None = None) -> Array:
        """One draw per walk, (W, P); walk i draws from ``generators[i]`` only.

        Raises
        ------
        ValueError
            If there is not one generator per walk.
        """
        asked = self.blending.checked(vectors)
        return self._draw(asked, self._seeds(generators, len(asked)), 1)[:, 0]

    @staticmethod
    def _seeds(generators: Generators | None, count: int) -> Array:
        if generators is None or len(generators) != count:
            raise ValueError("the probabilistic model needs one random generator per walk")
        return seeds_from(generators)

    def _draw(self, asked: Array, seeds: Array, size: int) -> Array:
        samples = np.empty((len(asked), size, len(self._drawn)))
        first = 0 if self._drawn else len(asked)
        while first < len(asked):
            outcome, walk = self._sampler(asked[first:], seeds[first:], samples[first:])
            if outcome == sampling.DONE:
                break
            first += walk
            if outcome != sampling.EXHAUSTED:
                raise InputError(f"{self.origin}: {sampling.REASONS[outcome]} (for dependencies {asked[first].tolist()})")
            samples[first] = self._draw_sharp(asked[first], seeds[first], size)
            first += 1
        if not self.fixed:
            return samples
        whole = np.tile(self.box[:, 0], (len(asked), size, 1))
        whole[:, :, self._drawn] = samples
        return whole

    @cached_property
    def _drawn(self) -> list[int]:
        """Axes of what the sampler returns: without held ones for the multilinear basis, and where all are held."""
        if len(self._held) == len(self.names) or isinstance(self.interpolant, MultilinearInterpolant):
            return [axis for axis in range(len(self.names)) if axis not in self._held]
        return list(range(len(self.names)))

    @cached_property
    def _ground(self) -> tuple[Interpolant, NDArray, tuple[NDArray[np.uint8], float], Blocks]:
        """Basis, coefficients, their bounds and the blocks to draw from; a slice where the multilinear basis is held."""
        if not self.fixed or not isinstance(self.interpolant, MultilinearInterpolant):
            return self.interpolant, self.coefficients, self._bounds, blocks_of(self.space, self.box)
        basis, maps = self.interpolant.slice(self.coefficients, self._held)
        space = ParameterSpace(tuple(self.space.axes[axis] for axis in self._drawn))
        return basis, maps, rungs_above(maps), blocks_of(space, space.bounds)

    @cached_property
    def _sampler(self) -> sampling.Sampler:
        scaling, tree = self.blending.scaling, self.blending.tree
        search = (scaling.offset, scaling.scale, tree.points, tree.order, tree.boxes)
        basis, coefficients, bounds, blocks = self._ground
        return sampling.sampler(basis, search, self.k, WEIGHTINGS[self.weights], coefficients, *bounds, blocks, self.exponent)

    def _draw_sharp(self, vector: Array, seed: float, size: int) -> Array:
        """The slower way of drawing, for walks whose density the compiled one hardly ever hits."""
        from walklab.steering.sharp import draw_sharp  # late: it is seldom needed

        basis, coefficients, bounds, blocks = self._ground
        indices, shares = self.blending.neighbours(vector, self.k, self.weights)
        surface = blend(coefficients, indices[0], shares[0])
        tops = None if isinstance(basis, MultilinearInterpolant) else blend_up(*bounds, indices[0], shares[0]).astype(float)
        rng = np.random.Generator(np.random.PCG64(int(seed * 2**53)))
        try:
            return draw_sharp(basis, surface, tops, blocks, self.exponent, size, rng)
        except RuntimeError as error:
            raise InputError(f"{self.origin}: {error} (for dependencies {vector.tolist()})") from None

    def mode(self, vectors: ArrayLike) -> Array:
        """Highest point of the interpolated maps, (W, P); see :meth:`ParameterSpace.on_edge` for edge optima."""
        low, high = self.space.to_unit(self.box.T)
        surfaces = self.blended_coefficients(vectors)
        found = self.space.from_unit(highest_points(self.interpolant, surfaces, low, high)[0])
        for name, value in self.fixed.items():
            found[:, self.names.index(name)] = value
        return found

    def inside(self, vectors: ArrayLike) -> NDArray[np.bool_]:
        """Whether each dependency vector lies in the domain of validity, (W,)."""
        return self.domain.contains(self.blending.shaped(vectors))

    def _asked(self, vectors: ArrayLike) -> Array:
        """(W, D) vectors, checked; warns if some are outside of the domain, as seen by who called the caller."""
        asked = self.blending.shaped(vectors)
        if not self.domain.contains_all(asked):  # what is not a number is not inside either
            self.blending.checked(asked)
            inside = self.domain.contains(asked)
            captured = self.blending.vectors[~self.blending.is_blend]
            told = outside_message(self.dependencies, self.dependency_units, captured, asked, inside)
            warnings.warn(told, OutsideTrainingRange, stacklevel=3)
        return asked
