"""People drawn to published distributions, with the hidden traits that shape their walking."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.constants import Spread, WalkerConstants
from walklab.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Distribution:
    """Published mean, standard deviation (n - 1) and extremes of a group."""

    mean: float
    sd: float
    min: float
    max: float


@dataclass(frozen=True)
class Group:
    """A group of participants; ``mass_kg`` is None where it is not published."""

    name: str
    count: int
    female: int
    age_years: Distribution
    height_m: Distribution
    mass_kg: Distribution | None = None


def participant_names(group: str, count: int) -> list[str]:
    """``training_P01``, ``training_P02``, ..."""
    return [f"{group}_P{index + 1:02d}" for index in range(count)]


def draw_participants(group: Group, constants: WalkerConstants, rng: np.random.Generator) -> pd.DataFrame:
    """A group whose sample has the published mean, standard deviation, minimum and maximum.

    Ranks come from correlated normals (stature and mass; women shorter; ages skewed to the
    right); values are then fitted to the published moments, see :func:`fit_to_moments`.

    Parameters
    ----------
    group : size, number of women and distributions
    rng : draws the whole group, always at once

    Returns
    -------
    DataFrame with participant, sex, age_years, height_m, mass_kg, torso_depth_m and hidden traits ``trait_*``

    Raises
    ------
    InputError
        If the group has fewer than 3 people or more women than people.

    Notes
    -----
    Agethen et al. 2017, sections 4.2, 7.1 and 8.3.
    """
    if group.count < 3 or not 0 <= group.female <= group.count:
        raise InputError(f"group {group.name}: needs at least 3 people and no more women than people; correct count and female")
    physique = constants.physique
    woman = rng.permutation(np.arange(group.count) < group.female)
    stature = rng.standard_normal(group.count) - physique.sex_shift_sd * woman
    independent = rng.standard_normal(group.count)
    rho = physique.height_mass_correlation
    heft = rho * stature + np.sqrt(1 - rho**2) * independent
    age = np.exp(physique.age_log_sd * rng.standard_normal(group.count))
    height_m = fit_to_moments(stature, group.height_m)
    if group.mass_kg is None:
        mass_kg = (physique.body_mass_index + physique.body_mass_index_sd * np.clip(independent, -2, 2)) * height_m**2
    else:
        mass_kg = fit_to_moments(heft, group.mass_kg)
    people = pd.DataFrame(
        {
            "participant": participant_names(group.name, group.count),
            "sex": np.where(woman, "female", "male"),
            "age_years": np.round(fit_to_moments(age, group.age_years)),
            "height_m": np.round(height_m, 3),
            "mass_kg": np.round(mass_kg, 1),
        }
    )
    width = np.sqrt((people["mass_kg"] / people["height_m"] ** 2) / physique.torso_reference_bmi)
    deviation = np.clip(rng.standard_normal(group.count), -2, 2)
    people["torso_depth_m"] = np.round(physique.torso_depth_m * width + physique.torso_depth_sd_m * deviation, 3)
    return pd.concat([people, _traits(people, constants, rng)], axis=1)


def fit_to_moments(ranks: Array, wanted: Distribution) -> Array:
    """Shift and stretch values until their sample has the wanted mean, standard deviation, minimum and maximum.

    The two extremes are set to the published ones (somebody in the group had them);
    the others are shifted and stretched, and pushed back inside, until both moments hold.
    """
    order = np.argsort(ranks)
    lowest, highest, inner = order[0], order[-1], order[1:-1]
    values = np.empty(len(ranks))
    values[lowest], values[highest] = wanted.min, wanted.max
    count = len(ranks)
    inner_mean = (wanted.mean * count - wanted.min - wanted.max) / len(inner)
    squares = wanted.sd**2 * (count - 1) - (wanted.min - wanted.mean) ** 2 - (wanted.max - wanted.mean) ** 2
    inner_variance = max(squares / len(inner) - (inner_mean - wanted.mean) ** 2, 0.0)
    fitted = np.asarray(ranks, dtype=float)[inner]
    for _ in range(200):
        spread = fitted.std()
        scale = np.sqrt(inner_variance) / spread if spread > 0 else 0.0
        fitted = np.clip(inner_mean + scale * (fitted - fitted.mean()), wanted.min, wanted.max)
    values[inner] = fitted
    return values


def _draw(spread: Spread, normal: Array) -> Array:
    return spread.mean + spread.sd * np.clip(normal, -spread.reach, spread.reach)


def _traits(people: pd.DataFrame, constants: WalkerConstants, rng: np.random.Generator) -> pd.DataFrame:
    normal = rng.standard_normal((12, len(people)))
    rho = constants.distance_constant_speed_correlation
    own_distance = rho * normal[0] + np.sqrt(1 - rho**2) * normal[1]
    ratio = _draw(constants.comfortable_ratio, normal[0])
    traits = {
        "speed_ratio": ratio,
        "distance_constant_m": _draw(constants.distance_constant_m, own_distance),
        "start_time_s": _draw(constants.start_time_s, normal[2]),
        "stop_time_s": _draw(constants.stop_time_s, normal[3]),
        "turn_exponent": _draw(constants.turn_exponent, normal[4]),
        "walk_ratio_m_min": _draw(constants.walk_ratio_m_min, normal[5]),
        "sway_lateral_m": _draw(constants.sway_lateral_m, normal[6]),
        "sway_fore_aft_m": _draw(constants.sway_fore_aft_m, normal[7]),
        "clearance_m": _draw(constants.clearance_m, normal[8]),
        "rounding_m": _draw(constants.rounding_m, normal[9]),
        "wander_ratio": _draw(constants.wander_ratio, normal[10]),
        "belt_gap_error_m": _draw(constants.belt_gap_error_m, normal[11]),
    }
    return pd.DataFrame({f"trait_{name}": values for name, values in traits.items()})
