"""The synthetic capture of each experiment as the default study makes it, shared by the tests of this room."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import pytest
import yaml

from walklab.capture.centre_of_mass import from_belt_pose
from walklab.capture.constants import WalkerConstants
from walklab.capture.participants import Distribution, Group, draw_participants
from walklab.capture.scenario import ScenarioDesign, record_scenario
from walklab.capture.segmentation import SegmentationRules, extract_walks
from walklab.capture.training import TrainingDesign, record_training
from walklab.configuration import complete, load_schema
from walklab.geometry.plans import Plan, load_plan
from walklab.geometry.standing import Standing
from walklab.randomness import generator

ROOT = Path(__file__).parents[3]
CONFIG = complete(
    yaml.safe_load((ROOT / "config/config.yaml").read_text()), load_schema(ROOT / "workflow/schemas/config.schema.yaml")
)
SCENES = ROOT / "config" / "scenes"
SEED = CONFIG["seed"]
STANDING = Standing(**CONFIG["standing"])
MEASURED = ("age_years", "height_m", "mass_kg")
HOW = (STANDING, SegmentationRules(**CONFIG["extract_walks"]), CONFIG["dependencies"]["curvature_scale_m"])


@dataclass(frozen=True)
class Captured:
    """Everything one experiment leaves behind."""

    participants: pd.DataFrame
    recording: pd.DataFrame
    truth: pd.DataFrame
    walks: pd.DataFrame
    samples: pd.DataFrame
    rate_hz: float
    seed: int = SEED

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
    return {
        name: Group(name, group["count"], group["female"], *(Distribution(**group[key]) for key in MEASURED))
        for name, group in CONFIG["participants"].items()
    }


@pytest.fixture(scope="session")
def plans() -> dict[str, Plan]:
    return {path.stem: load_plan(path) for path in sorted(SCENES.glob("*.yaml"))}


def _people(group: Group, constants: WalkerConstants) -> pd.DataFrame:
    return draw_participants(group, constants, generator(SEED, 0, "participants", group.name))


@pytest.fixture(scope="session")
def training(groups, plans, constants) -> Captured:
    people, design = _people(groups["training"], constants), TrainingDesign(**CONFIG["record_training"])
    recording, truth = record_training(people, design, plans, constants, SEED, 0, standing=STANDING)
    return Captured(people, recording, truth, *extract_walks(recording, people, *HOW), design.rate_hz)


def _scenario(group: Group, plan: Plan, constants: WalkerConstants) -> Captured:
    people, design = _people(group, constants), ScenarioDesign(**CONFIG["record_scenario"])
    poses, truth = record_scenario(people, plan, design, constants, SEED, 0, standing=STANDING)
    recording = from_belt_pose(poses, people, design.controller_offset_m)
    stations = {plan.scene.name: {name: station.position_m for name, station in plan.stations.items()}}
    return Captured(people, recording, truth, *extract_walks(recording, people, *HOW, stations), design.rate_hz)


@pytest.fixture(scope="session")
def scenario_1(groups, plans, constants) -> Captured:
    return _scenario(groups["scenarios"], plans["scenario_1"], constants)


@pytest.fixture(scope="session")
def scenario_2(groups, plans, constants) -> Captured:
    return _scenario(groups["scenarios"], plans["scenario_2"], constants)
