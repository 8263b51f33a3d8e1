"""How far each uncertain constant of the synthetic capture could be from its value, with the source of the range.

The values themselves, and the works that are named here, are in :mod:`walklab.capture.constants`. "Assumed" marks a range that no
work states. Constants that stand for one uncertainty move together, from the first end of their ranges to the second.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from walklab.capture.constants import WalkerConstants
from walklab.errors import InputError

Ends = tuple[float, float]


@dataclass(frozen=True)
class Range:
    """One uncertainty.

    Attributes
    ----------
    constants : path of a constant, such as ``turn_exponent.mean`` -> its value at the low and at the high end
    source : where the range is from
    """

    constants: Mapping[str, Ends]
    source: str


# ASSUME: Where no work states a range, about half and twice the value (for exponents, shares and correlations: the values between
# which nobody would be surprised) are taken; the multiverse asks what a claim owes to a value, not how likely the value is.
RANGES: dict[str, Range] = {
    # --- speed ---
    "peak_speed": Range({"peak_over_norm": (1.0, 1.18)}, "from the norm itself (Bohannon 1997) to as far above; assumed"),
    "speed_between_people": Range(
        {"comfortable_ratio.sd": (0.065, 0.165)}, "Bohannon 1997: 0.09 to 0.23 m/s in groups of 1.39 m/s on average"
    ),
    "speed_by_height": Range({"height_exponent": (0.0, 1.0)}, "no effect, to a speed proportional to stature; assumed"),
    "short_walks": Range({"short_walk_shortfall": (0.4, 0.7)}, "assumed"),
    "distance_constant": Range(
        {"distance_constant_m.mean": (1.5, 3.0)}, "within 5 % of comfortable speed from 4 or from 7 m on, instead of 5 m; assumed"
    ),
    "distance_constant_between_people": Range({"distance_constant_m.sd": (0.0, 0.5)}, "none, to twice the value; assumed"),
    "distance_constant_by_speed": Range(
        {"distance_constant_speed_correlation": (0.0, 0.8)}, "Wong, Darici & Kuo state one value, 0.55; assumed"
    ),
    "start": Range({"start_time_s.mean": (1.1, 1.7)}, "Carlisle & Kuo 2023: two to three steps, at about 1.8 steps/s"),
    "stop": Range({"stop_time_s.mean": (1.1, 1.7)}, "Carlisle & Kuo 2023: two to three steps, at about 1.8 steps/s"),
    "start_stop_between_people": Range({"start_time_s.sd": (0.05, 0.22), "stop_time_s.sd": (0.05, 0.24)}, "assumed"),
    "turn_exponent": Range(
        {"turn_exponent.mean": (0.2, 0.45)},
        "about a third (Vieilledent et al. 2001; Hicheur et al. 2005); how far off, assumed",
    ),
    "turn_exponent_between_people": Range({"turn_exponent.sd": (0.0, 0.1)}, "none, to twice the value; assumed"),
    "turn_onset": Range(
        {"turn_onset_1_m": (0.4, 1.2)}, "0.72 to 0.92 of the straight speed on a circle of 1 m radius instead of 0.83; assumed"
    ),
    "turn_look_ahead": Range({"turn_look_ahead_m": (0.18, 0.7)}, "a quarter of a step length to a whole one; assumed"),
    # --- gait ---
    "walk_ratio": Range({"walk_ratio_m_min.mean": (0.0058, 0.0072)}, "Sekiya et al. 1996 round a value of this size; assumed"),
    "sway_lateral": Range(
        {"sway_lateral_m.mean": (0.0195, 0.035)}, "Orendurff et al. 2004: half the excursion at 1.6 and at 0.7 m/s"
    ),
    "sway_fore_aft": Range({"sway_fore_aft_m.mean": (0.0035, 0.014)}, "assumed"),
    "sway_onset": Range({"sway_onset_m_s": (0.2, 0.8)}, "assumed"),
    # --- path ---
    "clearance": Range(
        {"clearance_m.mean": (0.33, 0.53)}, "half a shoulder breadth (0.23 m) and 0.1 to 0.3 m (Gerin-Lajoie et al. 2005)"
    ),
    "freedom_at_station": Range({"freedom_at_station_m": (0.3, 1.0)}, "assumed"),
    "rounding": Range({"rounding_m.mean": (0.08, 0.32)}, "assumed"),
    "wander": Range({"wander_ratio.mean": (0.005, 0.02)}, "assumed"),
    # --- repetition ---
    "repeated_speed": Range(
        {"repeated_speed_sd": (0.035, 0.05)}, "Bohannon 1997: below 3.5 %; Seethapathi & Srinivasan 2015: 5 % at short distances"
    ),
    "repeated_start_stop": Range({"repeated_start_stop_sd": (0.04, 0.16)}, "assumed"),
    "place_scatter": Range({"place_scatter_m": (0.009, 0.036)}, "assumed"),
    # --- body, standing, work and sensors ---
    "physique": Range({"physique.height_mass_correlation": (0.4, 0.55)}, "military surveys (ANSUR)"),
    "torso_depth": Range({"physique.torso_depth_m": (0.22, 0.26)}, "adult chest and abdominal depths"),
    "standing_sway": Range({"standing_sway_m": (0.0015, 0.006)}, "assumed"),
    "posture_at_work": Range({"pelvis_tilt_rad_per_m": (0.5, 1.4), "pelvis_back_per_m": (0.085, 0.25)}, "assumed"),
    "sensor_noise": Range(
        {
            "optical_noise_m": (0.0001, 0.001),
            "belt_noise_m": (0.0002, 0.001),
            "belt_noise_rad": (0.0004, 0.0016),
            "dropouts_per_min": (0.2, 3.0),
        },
        "Niehorster et al. 2017: sub-millimetre; the others assumed",
    ),
    "belt_gap": Range({"belt_gap_error_m.sd": (0.0, 0.01)}, "none, to a centimetre; assumed"),
}


def constants_at(positions: Mapping[str, float], constants: WalkerConstants | None = None) -> WalkerConstants:
    """The generator's constants with some uncertainties moved.

    Parameters
    ----------
    positions : name in :data:`RANGES` -> place in its range, 0 at the low end, 1 at the high end
    constants : to start from; default the generator's own

    Raises
    ------
    InputError
        If a name or place is out of range.
    """
    changed = WalkerConstants() if constants is None else constants
    for name, place in positions.items():
        if name not in RANGES or not 0 <= place <= 1:
            raise InputError(f"generator: {name} at {place}: choose a place from 0 to 1 for one of {', '.join(RANGES)}")
        for path, (low, high) in RANGES[name].constants.items():
            changed = _replaced(changed, path.split("."), low + place * (high - low))
    return changed


def constant(constants: WalkerConstants, path: str) -> float:
    """The value of the constant at a path."""
    value: Any = constants
    for part in path.split("."):
        value = getattr(value, part)
    return float(value)


def _replaced(target: Any, path: list[str], value: float) -> Any:
    name, rest = path[0], path[1:]
    if not is_dataclass(target) or name not in {entry.name for entry in fields(target)}:
        raise InputError(f"generator: there is no constant {name!r}")
    return replace(target, **{name: _replaced(getattr(target, name), rest, value) if rest else value})  # type: ignore[type-var]
