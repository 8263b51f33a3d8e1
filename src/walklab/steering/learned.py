"""P_Prob with what was learned from training walks on top: its sharpness, and people's own pace. Both are motion models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.steering.arguments import count_of, generator_of
from walklab.steering.pace import PaceEffect, Trend, student
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.sharpness import SharpnessLaw

Array = NDArray[np.float64]
Generators = Sequence[np.random.Generator]

# How a parameter changes when all times of a walk are multiplied by s: by s to minus this power. Units as an axis spells them.
POWERS_OF_TIME = {"m/s": 1, "m/s²": 2, "rad/s": 1, "rad/s²": 2, "1/s": 1, "s": -1, "1/m": 0, "rad/m": 0, "m": 0, "rad": 0, "1": 0}


@dataclass(frozen=True)
class CalibratedModel:
    """P_Prob (calibrated): the exponent of each walk follows a law of its dependencies."""

    model: ProbabilisticModel
    law: SharpnessLaw

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the steering parameters."""
        return self.model.names

    def parameters(self, vectors: ArrayLike, generators: Generators | None = None) -> Array:
        """One draw per walk, (W, P); walk i draws from ``generators[i]`` only."""
        asked = self.model.blending.checked(vectors)
        if generators is None or len(generators) != len(asked):
            raise ValueError("the calibrated model needs one random generator per walk")
        drawn = np.empty((len(asked), len(self.names)))
        exponents = self.law.exponents(asked)
        for exponent in np.unique(exponents):
            rows = np.flatnonzero(exponents == exponent)
            variant = replace(self.model, exponent=float(exponent))
            drawn[rows] = variant.parameters(asked[rows], [generators[int(row)] for row in rows])
        return drawn

    def sample(self, vector: ArrayLike, size: int = 1, rng: np.random.Generator | None = None) -> Array:
        """Draw (size, P) parameter vectors for one walk."""
        exponent = float(self.law.exponents(self.model.blending.checked(vector))[0])
        return replace(self.model, exponent=exponent).sample(vector, size, rng)

    def inside(self, vectors: ArrayLike) -> NDArray[np.bool_]:
        """Whether each dependency vector lies in the domain of validity, (W,)."""
        return self.model.inside(vectors)


def ignoring(model: ProbabilisticModel, columns: Sequence[int]) -> ProbabilisticModel:
    """The same maps, neighbours being searched without these dependencies."""
    scale = np.array(model.blending.scaling.scale, dtype=float)
    scale[list(columns)] = np.inf
    return replace(model, blending=replace(model.blending, scaling=replace(model.blending.scaling, scale=scale)))


@dataclass(frozen=True)
class Pace:
    """What P_Prob (extended) learned: the density's exponent, the dependencies it ignores, and the pace.

    Attributes
    ----------
    exponent : of the density
    ignored : columns of the dependencies without which neighbours are searched
    trend : mean of the pace over the dependencies
    effect : of people and walks about the trend
    rest_sd : spread between walks of one person that the density's own spread leaves
    """

    exponent: float
    ignored: tuple[int, ...]
    trend: Trend
    effect: PaceEffect
    rest_sd: float


@dataclass(frozen=True)
class ExtendedModel:
    """P_Prob (extended): draws of the density, at the pace of a person.

    Attributes
    ----------
    model : any sharpness; the pace brings its own
    pace : what was learned
    """

    model: ProbabilisticModel
    pace: Pace

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the steering parameters."""
        return self.model.names

    def _powers_of_time(self) -> Array:
        """(P,) powers by which the parameters fall when a walk takes longer."""
        units = self.model.units
        for name, unit in zip(self.names, units, strict=True):
            if unit not in POWERS_OF_TIME:
                raise InputError(
                    f"extended model: how {name} changes with the pace is unknown for its unit {unit!r};"
                    f" give it in one of {', '.join(POWERS_OF_TIME)}"
                )
        if "m/s" not in units:
            raise InputError(f"extended model: none of {', '.join(self.names)} is a speed in m/s, so a pace means nothing")
        return np.array([POWERS_OF_TIME[unit] for unit in units])

    def density_model(self) -> ProbabilisticModel:
        """The density that is drawn from, before the pace."""
        return replace(ignoring(self.model, self.pace.ignored), exponent=self.pace.exponent)

    def parameters(self, vectors: ArrayLike, generators: Generators | None = None) -> Array:
        """One draw per walk of somebody new, (W, P); walk i draws from ``generators[i]`` only."""
        asked = self.model.blending.checked(vectors)
        if generators is None:
            raise ValueError("the extended model needs one random generator per walk")
        return self.sample_batch(asked, 1, generators)[:, 0]

    def sample(
        self, vector: ArrayLike, size: int = 1, rng: np.random.Generator | None = None, known: tuple[float, float] | None = None
    ) -> Array:
        """Draw (size, P) parameter vectors for one walk.

        Parameters
        ----------
        known : mean and standard deviation of this person's effect (``effect.posterior``); None: somebody new
        """
        effects = None if known is None else (np.array([known[0]]), np.array([known[1]]))
        return self.sample_batch(np.atleast_2d(vector), size, [generator_of(rng)], effects)[0]

    def sample_batch(self, vectors: ArrayLike, size: int, rng: Generators, known: tuple[Array, Array] | None = None) -> Array:
        """Draw (W, size, P) parameter vectors; walk i draws from the i-th generator only.

        Parameters
        ----------
        known : (W,) means and (W,) standard deviations of the persons' effects; None: everybody is new

        Raises
        ------
        InputError
            If there is nothing to slow down: no parameter in m/s; or if a unit is none whose change with the pace is known.
        """
        count_of(size)
        asked, effect, powers = self.model.blending.checked(vectors), self.pace.effect, self._powers_of_time()
        density = self.density_model()
        drawn = density.sample_batch(asked, size, rng)
        nobody = np.full(len(asked), effect.mean), np.full(len(asked), effect.new_person_sd)
        mean, sd = known if known is not None else nobody
        shares = np.stack([generator.random(size) for generator in rng])
        quantiles = student(shares, effect.freedom(sd, self.pace.rest_sd)[:, None])
        logs = (self.pace.trend(asked) + mean)[:, None] + np.hypot(sd, self.pace.rest_sd)[:, None] * quantiles
        return np.asarray(drawn * np.exp(-logs[:, :, None] * powers))

    def inside(self, vectors: ArrayLike) -> NDArray[np.bool_]:
        """Whether each dependency vector lies in the domain of validity, (W,)."""
        return self.model.inside(vectors)
