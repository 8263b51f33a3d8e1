"""What the capture scripts make of their parameters."""

from collections.abc import Iterable, Mapping
from typing import Any

import pandas as pd

from walklab.capture.constants import WalkerConstants, without_dependency_effects, without_repetition_variation
from walklab.capture.io import read_participants
from walklab.capture.participants import Distribution, Group
from walklab.capture.real_shapes import read_shapes
from walklab.capture.resampling import resampled_person
from walklab.capture.walker import MakePerson, person_from_row
from walklab.geometry.plans import OPEN, Plan, load_plan


def constants_of(generator: Mapping[str, bool]) -> WalkerConstants:
    """The generator's constants with the switches of the negative controls applied."""
    constants = WalkerConstants()
    if not generator["dependency_effects"]:
        constants = without_dependency_effects(constants)
    if not generator["repetition_variation"]:
        constants = without_repetition_variation(constants)
    return constants


def people_of(shapes: str, seed: int) -> MakePerson:
    """The first generator's people, or, if shapes of real walks are given, people who walk by these."""
    if not shapes:
        return person_from_row
    found = read_shapes(shapes)
    return lambda row, constants: resampled_person(row, constants, found, seed)


def group_of(name: str, group: Mapping[str, Any]) -> Group:
    """A group of participants from its section of the configuration."""
    return Group(
        name, group["count"], group["female"], *(Distribution(**group[key]) for key in ("age_years", "height_m", "mass_kg"))
    )


def participants_of_group(path: str, group: str) -> pd.DataFrame:
    """The participants of one group."""
    everyone = read_participants(path)
    return everyone[everyone["participant"].str.startswith(f"{group}_")].reset_index(drop=True)


def participants_of_shard(everyone: pd.DataFrame, shard: int, shards: int) -> pd.DataFrame:
    """Every ``shards``-th participant."""
    return everyone.iloc[shard::shards].reset_index(drop=True)


def plans_by_scene(paths: Iterable[str]) -> dict[str, Plan]:
    """Plan views by scene name, with the empty scene."""
    plans = [load_plan(path) for path in paths]
    return {"open": OPEN, **{plan.scene.name: plan for plan in plans}}
