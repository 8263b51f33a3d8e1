"""What each dependency and each steering parameter contributes (Agethen et al. 2017, section 8.1)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from walklab.errors import InputError
from walklab.evaluation.bootstrap import (
    DECIMALS,
    RESAMPLES,
    Array,
    cluster_codes,
    cluster_counts,
    interval,
    resampled_quantiles,
)
from walklab.evaluation.pairs import paired
from walklab.evaluation.signed_rank import compare_pairs
from walklab.randomness import generator
from walklab.steering.learned import CalibratedModel
from walklab.steering.models import MotionModel, ProbabilisticModel
from walklab.steering.sharpness import SharpnessLaw
from walklab.steering.space import ParameterSpace
from walklab.steering.training import TrainingSettings, train

FULL = "full"

# cells (C, P) in the planner's order -> scores of the training walks (N, C)
Score = Callable[[Array], Array]


@dataclass(frozen=True)
class WithoutDependency:
    """A model that is given all dependencies and looks at some.

    Attributes
    ----------
    model : built from the remaining dependencies
    columns : which columns of the full dependency vectors those are
    """

    model: MotionModel
    columns: tuple[int, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the steering parameters."""
        return self.model.names

    def parameters(self, vectors: ArrayLike, generators: Sequence[np.random.Generator] | None = None) -> Array:
        """(W, P) parameters for full (W, D) dependency vectors."""
        return self.model.parameters(np.asarray(vectors, dtype=float)[:, list(self.columns)], generators)


@dataclass(frozen=True)
class WithHeldParameter:
    """A model of the remaining steering parameters, the removed one held.

    Attributes
    ----------
    model : gives the remaining parameters
    name, value : the removed one and what it is held at
    position : its place among the planner's parameters
    """

    model: MotionModel
    name: str
    value: float
    position: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the steering parameters, the held one included."""
        rest = self.model.names
        return (*rest[: self.position], self.name, *rest[self.position :])

    def parameters(self, vectors: ArrayLike, generators: Sequence[np.random.Generator] | None = None) -> Array:
        """(W, P) parameters, the held one the same for all."""
        return np.insert(self.model.parameters(vectors, generators), self.position, self.value, axis=1)


def held_cells(space: ParameterSpace, name: str, value: float) -> tuple[ParameterSpace, Array]:
    """The space without one axis, and its cells as full parameter vectors with that parameter held.

    Returns
    -------
    (reduced space, (C', P) array in the order of the full space)
    """
    if name not in space.names:
        raise InputError(f"ablation: the parameter space has no axis {name!r}; its axes are {', '.join(space.names)}")
    reduced = space.without(name)
    return reduced, np.insert(reduced.cells, space.names.index(name), value, axis=1)


def ablated_models(
    scores: Array,
    vectors: pd.DataFrame,
    participants: Sequence[str],
    space: ParameterSpace,
    settings: TrainingSettings,
    score: Score,
    held: Mapping[str, float],
    seed: int,
    replicate: int,
) -> dict[str, MotionModel]:
    """A sub-model without each dependency and without each steering parameter.

    Without a dependency: trained again, up-sampling included, from the training vectors without its
    column. Without a steering parameter: the training walks are scored again over the remaining
    parameters with it held, and the model is trained on those maps.

    Parameters
    ----------
    scores : (W, C) of the training walks over the full space
    vectors : (W, D) dependencies of the training walks; its columns name them
    participants : (W,) who walked
    score : (C', P) cells in the order of the full space -> (W, C') scores of the training walks
    held : steering parameter -> the value it is held at

    Returns
    -------
    {"without_<name>": model}, dependencies first; every model takes full dependency vectors and gives
    full parameter vectors
    """
    # ASSUME: Section 8.1 does not say which value a removed steering parameter takes; it is held at P_Stat's optimum,
    # which is what a planner without a model of that parameter would use.
    models: dict[str, MotionModel] = {}
    dependencies = list(vectors.columns)
    for name in dependencies:
        rest = vectors.drop(columns=name)
        rng = generator(seed, replicate, "ablation", str(name))
        model = train(scores, rest, participants, space, settings, rng)
        models[f"without_{name}"] = WithoutDependency(model, tuple(dependencies.index(other) for other in rest.columns))
    for position, name in enumerate(space.names):
        if name not in held:
            raise InputError(f"ablation: no value to hold {name} at; give one for each of {', '.join(space.names)}")
        reduced, cells = held_cells(space, name, held[name])
        rng = generator(seed, replicate, "ablation", name)
        model = train(score(cells), vectors, participants, reduced, settings, rng)
        models[f"without_{name}"] = WithHeldParameter(model, name, float(held[name]), position)
    return models


def calibrated_variants(models: Mapping[str, MotionModel], law: SharpnessLaw) -> dict[str, MotionModel]:
    """The same models, each drawing with the exponents of a law that was learned for the full one.

    Parameters
    ----------
    models : :class:`ProbabilisticModel`, as they are or within :func:`ablated_models`; a law whose dependency is taken away
        keeps the exponent of its centre
    """
    return {name: _calibrated(model, law) for name, model in models.items()}


def _calibrated(model: MotionModel, law: SharpnessLaw) -> MotionModel:
    if isinstance(model, WithoutDependency):
        return replace(model, model=_calibrated(model.model, law.over(model.columns)))
    if isinstance(model, WithHeldParameter):
        return replace(model, model=_calibrated(model.model, law))
    if not isinstance(model, ProbabilisticModel):
        raise InputError(f"ablation: {type(model).__name__} has no sharpness to calibrate")
    return CalibratedModel(model, law)


def ablation_table(
    trials: pd.DataFrame, rng: np.random.Generator, held: Mapping[str, float], resamples: int = RESAMPLES
) -> pd.DataFrame:
    """Median |dt| of the full model and each sub-model (figure 13).

    Parameters
    ----------
    trials : of the models ``full`` and ``without_<name>``

    Returns
    -------
    DataFrame[variant, removed, held_at (NaN for dependencies), n, not_arrived, value, low, high (median |dt|, s, and its
    95 % interval over participants), p25, p75, increase_s, increase_low, increase_high (against full), p (Wilcoxon)]
    """
    return pd.DataFrame([_ablation_row(name, group, trials, rng, held, resamples) for name, group in _groups(trials)])


def _groups(trials: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    groups = {str(name): group for name, group in trials.groupby("model", sort=False)}
    if FULL not in groups:
        raise InputError(f"ablation: the trials have no model {FULL!r} to compare with; add P_Prob's under that name")
    return [(FULL, groups.pop(FULL)), *groups.items()]


def _ablation_row(
    variant: str,
    group: pd.DataFrame,
    trials: pd.DataFrame,
    rng: np.random.Generator,
    held: Mapping[str, float],
    resamples: int,
) -> dict[str, Any]:
    table = paired(trials, FULL, variant) if variant != FULL else paired(trials, FULL, FULL)
    full, own = table["first"].to_numpy(), table["second"].to_numpy()
    codes, clusters = cluster_codes(table["participant"])
    counts = cluster_counts(clusters, resamples, rng)
    draws_full, draws = (resampled_quantiles(values, codes, counts, [0.5])[:, 0] for values in (full, own))
    low, high = interval(draws, clusters)
    increase_low, increase_high = interval(draws - draws_full, clusters)
    removed = variant.removeprefix("without_")
    return {
        "variant": variant,
        "removed": "" if variant == FULL else removed,
        "held_at": held.get(removed, np.nan) if variant != FULL else np.nan,
        "n": len(own),
        "not_arrived": int((group["arrival"] != "arrived").sum()),
        "value": float(np.median(own)),
        "low": low,
        "high": high,
        "p25": float(np.quantile(own, 0.25)),
        "p75": float(np.quantile(own, 0.75)),
        "increase_s": round(float(np.median(own) - np.median(full)), DECIMALS) + 0.0,
        "increase_low": increase_low,
        "increase_high": increase_high,
        "p": 1.0 if variant == FULL else float(compare_pairs(trials, rng, [(variant, FULL)], resamples=2)["p"].iloc[0]),
    }
