"""One full synthetic capture of each experiment, shared by the tests of this room."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import pytest

from walklab.capture.centre_of_mass import from_belt_pose
from walklab.capture.constants import WalkerConstants
from walklab.capture.participants import Distribution, Group, draw_participants
from walklab.capture.scenario import ScenarioDesign, record_scenario
from walklab.capture.segmentation import SegmentationRules, extract_walks
from walklab.capture.training import TrainingDesign, record_training
from walklab.geometry.plans import Plan, load_plan
from walklab.geometry.standing import Standing
from walklab.randomness import generator

SEED = 1
SCENES = Path(__file__).parents[3] / "config" / "scenes"
CURVATURE_SCALE_M = 0.2


@dataclass(frozen=True)
class Captured:
    """Everything one experiment leaves behind."""

    participants: pd.DataFrame
    recording: pd.DataFrame
    truth: pd.DataFrame
    walks: pd.DataFrame
    samples: pd.DataFrame
    rate_hz: float

    @property
    def accepted(self) -> pd.DataFrame:
        return self.walks[self.walks["rejection"] == ""]


@pytest.fixture(scope="session")
def data_folder() -> Path:
    folder = Path(os.environ.get("WALKLAB_DATA", Path(__file__).parents[4] / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no real data: {folder} does not exist; set WALKLAB_DATA")
    return folder


@pytest.fixture(scope="session")
def constants() -> WalkerConstants:
    return WalkerConstants()


@pytest.fixture(scope="session")
def groups() -> dict[str, Group]:
    """Agethen et al. 2017, sections 4.2, 7.1 and 8.3."""
    age, height, mass = (
        Distribution(26.46, 7.50, 19, 59),
        Distribution(1.78, 0.07, 1.65, 1.90),
        Distribution(75.15, 13.09, 50, 110),
    )
    other = Distribution(27.80, 6.08, 21, 40), Distribution(1.79, 0.12, 1.60, 1.98), Distribution(76.20, 14.18, 60, 105)
    third = Distribution(26.30, 5.01, 21, 40), Distribution(1.81, 0.05, 1.75, 1.90)
    return {
        "training": Group("training", 30, 5, age, height, mass),
        "scenarios": Group("scenarios", 10, 1, *other),
        "long_distance": Group("long_distance", 10, 1, *third),
    }


@pytest.fixture(scope="session")
def plans() -> dict[str, Plan]:
    return {path.stem: load_plan(path) for path in sorted(SCENES.glob("*.yaml"))}


@pytest.fixture(scope="session")
def training(groups, plans, constants) -> Captured:
    people = draw_participants(groups["training"], constants, generator(SEED, 0, "training"))
    recording, truth = record_training(people, TrainingDesign(), plans, constants, SEED, 0)
    walks, samples = extract_walks(recording, people, Standing(), SegmentationRules(), CURVATURE_SCALE_M)
    return Captured(people, recording, truth, walks, samples, 120.0)


def _scenario(group: Group, plan: Plan, constants: WalkerConstants, flawed_walks: int) -> Captured:
    people = draw_participants(group, constants, generator(SEED, 0, "scenarios"))
    design = ScenarioDesign(flawed_walks=flawed_walks)
    poses, truth = record_scenario(people, plan, design, constants, SEED, 0)
    recording = from_belt_pose(poses, people, design.controller_offset_m)
    stations = {plan.scene.name: {name: station.position_m for name, station in plan.stations.items()}}
    walks, samples = extract_walks(recording, people, Standing(), SegmentationRules(), CURVATURE_SCALE_M, stations)
    return Captured(people, recording, truth, walks, samples, 60.0)


@pytest.fixture(scope="session")
def scenario_1(groups, plans, constants) -> Captured:
    return _scenario(groups["scenarios"], plans["scenario_1"], constants, flawed_walks=7)


@pytest.fixture(scope="session")
def scenario_2(groups, plans, constants) -> Captured:
    return _scenario(groups["scenarios"], plans["scenario_2"], constants, flawed_walks=0)
