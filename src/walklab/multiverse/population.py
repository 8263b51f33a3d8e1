"""A population for the study: who walks, from the capture to the walks cut from it, in memory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from walklab.capture.centre_of_mass import from_belt_pose
from walklab.capture.constants import WalkerConstants
from walklab.capture.participants import Group, draw_participants
from walklab.capture.scenario import ScenarioDesign, record_scenario
from walklab.capture.segmentation import SegmentationRules, extract_walks
from walklab.capture.training import TrainingDesign, record_training
from walklab.capture.walks import Walk, pair
from walklab.geometry.plans import Plan
from walklab.geometry.standing import Standing
from walklab.randomness import generator

TRAINING = "training"
Tables = tuple[pd.DataFrame, pd.DataFrame]  # walks and samples


@dataclass(frozen=True)
class CaptureDesign:
    """Who walks what, and how walks are found.

    Attributes
    ----------
    groups : ``training`` and ``scenarios``
    training, scenarios : what they do; one design for all scenarios
    training_plans, scenario_plans : plan views by scene and by scenario
    standing, rules, curvature_scale_m : how recordings are cut into walks
    seed, replicate : the same random numbers as the study's own capture
    """

    groups: Mapping[str, Group]
    training: TrainingDesign
    scenarios: ScenarioDesign
    training_plans: Mapping[str, Plan]
    scenario_plans: Mapping[str, Plan]
    standing: Standing
    rules: SegmentationRules
    curvature_scale_m: float
    seed: int
    replicate: int


def record_population(design: CaptureDesign, constants: WalkerConstants) -> dict[str, Tables]:
    """Walks and samples of ``training`` and of every scenario, as the stages of the study find them one after the other."""
    draw = (design.seed, design.replicate)
    people = {
        name: draw_participants(group, constants, generator(*draw, "participants", name)) for name, group in design.groups.items()
    }
    cut = design.standing, design.rules, design.curvature_scale_m
    recording, _ = record_training(
        people[TRAINING], design.training, design.training_plans, constants, *draw, standing=design.standing
    )
    found = {TRAINING: extract_walks(recording, people[TRAINING], *cut)}
    everyone = people["scenarios"]
    for name, plan in design.scenario_plans.items():
        poses, _ = record_scenario(everyone, plan, design.scenarios, constants, *draw, standing=design.standing)
        track = from_belt_pose(poses, everyone, design.scenarios.controller_offset_m)
        places = {plan.scene.name: {station: at.position_m for station, at in plan.stations.items()}}
        found[name] = extract_walks(track, everyone, *cut, places)
    return found


@dataclass(frozen=True)
class Population:
    """Accepted walks: those of training in the order of their names, those of the scenarios as they were found."""

    training: list[Walk]
    scenarios: Mapping[str, list[Walk]]


def population_of(tables: Mapping[str, Tables]) -> Population:
    """The accepted walks of :func:`record_population`."""
    walks = {name: pair(*both, name) for name, both in tables.items()}
    training = sorted(walks.pop(TRAINING), key=lambda walk: walk.row["walk"])
    return Population(training, walks)
