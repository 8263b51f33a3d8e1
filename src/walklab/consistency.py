"""What a schema cannot say of a configuration: how its values fit together, and whether their units can be meant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import isfinite
from typing import Any

from walklab.errors import InputError

# Limits of what a person can be; a value beyond them is given in another unit.
PLAUSIBLE = {"age_years": (1, 120), "height_m": (0.5, 2.6), "mass_kg": (10, 350)}


def require_consistent(config: Mapping[str, Any]) -> None:
    """Refuse a completed configuration whose values do not fit together, before anything is computed.

    Raises
    ------
    InputError
        One line with the key, what is wrong and what to do.
    """
    for check in (_numbers, _groups, _recordings, _standing, _spaces, _model):
        for key, problem in check(config):
            raise InputError(f"config key {key}: {problem}")


Problems = Iterator[tuple[str, str]]


def _numbers(config: Any, path: str = "") -> Problems:
    items = config.items() if isinstance(config, Mapping) else enumerate(config) if isinstance(config, list) else ()
    for key, value in items:
        yield from _numbers(value, f"{path}{key}.")
    if isinstance(config, float) and not isfinite(config):
        yield path.removesuffix("."), f"{config} is no finite number; give one"


def _groups(config: Mapping[str, Any]) -> Problems:
    for name, group in config["participants"].items():
        key = f"participants.{name}"
        if group["female"] > group["count"]:
            yield f"{key}.female", f"{group['female']} women among {group['count']} participants; correct one"
        for trait, (low, high) in PLAUSIBLE.items():
            asked = group[trait]
            if not asked["min"] <= asked["mean"] <= asked["max"]:
                yield f"{key}.{trait}", f"mean {asked['mean']} does not lie between min {asked['min']} and max {asked['max']}"
            if asked["min"] < low or asked["max"] > high:
                yield f"{key}.{trait}", f"{asked['min']} to {asked['max']} leaves {low} to {high}; the unit is in the key's name"


def _recordings(config: Mapping[str, Any]) -> Problems:
    sets, people = config["record_scenario"]["sets"], config["participants"]["scenarios"]["count"]
    if len(sets) != people:
        yield "record_scenario.sets", f"{len(sets)} numbers for {people} participants of the scenarios; give one each"
    recorded, flawed = recorded_walks(config), config["record_training"]["flawed_walks"]
    if flawed > recorded:
        yield "record_training.flawed_walks", f"{flawed} of {recorded} walks cannot be flawed; lower it"
    entries = config["blending_space"]["entries"]
    if config["source"]["kind"] in ("synthetic", "resampled") and entries is not None and entries < recorded - flawed:
        yield "blending_space.entries", f"{entries} is less than the {recorded - flawed} captured walks; raise it or set null"


def recorded_walks(config: Mapping[str, Any]) -> int:
    """Walks out of experiment 1 in one replicate, the flawed ones included."""
    design = config["record_training"]
    straight = len(design["straight_distances_m"]) * design["straight_repetitions"]
    turning = len(design["turning_angles_deg"]) * len(design["turning_distances_m"]) * design["turning_repetitions"]
    return config["participants"]["training"]["count"] * (straight + turning)


def _standing(config: Mapping[str, Any]) -> Problems:
    stands, walks = config["standing"]["standing_speed_m_s"], config["standing"]["walking_speed_m_s"]
    if stands >= walks:
        yield "standing.standing_speed_m_s", f"{stands} m/s is not below walking_speed_m_s ({walks} m/s); lower it"


def _spaces(config: Mapping[str, Any]) -> Problems:
    if len(config["space"]) < 2:
        yield "space", "has one axis, but the study's maps and figures need two or more; add another parameter of the planner"
    for key, axes in (("space", config["space"]), ("long_distance.space", config["long_distance"]["space"])):
        names = [axis["name"] for axis in axes]
        for index, axis in enumerate(axes):
            if axis["name"] in names[:index]:
                yield f"{key}.{index}.name", f"{axis['name']!r} stands twice; every axis is another parameter"
            values = axis.get("values", [])
            if any(after <= before for before, after in pairwise(values)):
                yield f"{key}.{index}.values", f"{values} do not ascend; sort them"


def _model(config: Mapping[str, Any]) -> Problems:
    blending, k = config["blending_space"], config["model"]["k"]
    if blending["subset"] > blending["neighbours"]:
        yield "blending_space.subset", f"{blending['subset']} of {blending['neighbours']} neighbours cannot be blended; lower it"
    if blending["entries"] is not None and k > blending["entries"]:
        yield "model.k", f"{k} neighbours among blending_space.entries ({blending['entries']}); lower it"
