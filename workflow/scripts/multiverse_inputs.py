"""What the scripts of the multiverse make of the files and parameters they share."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from capture_inputs import group_of, plans_by_scene
from map_inputs import settings_of
from walklab.capture.scenario import ScenarioDesign
from walklab.capture.segmentation import SegmentationRules
from walklab.capture.training import TrainingDesign
from walklab.geometry.plans import load_plan
from walklab.geometry.scene import Body
from walklab.geometry.standing import Standing
from walklab.multiverse.population import CaptureDesign
from walklab.multiverse.specifications import Specification
from walklab.multiverse.study import StudySettings
from walklab.multiverse.table import specification_named
from walklab.steering.space import space_from_config
from walklab.storage import read_table

REPLICATE = 0


def specification_of(snakemake: Any) -> Specification:
    """The specification that the job is named after, from the table of all."""
    table: pd.DataFrame = read_table(snakemake.input.specifications)
    return specification_named(table, snakemake.wildcards.specification)


def capture_design(snakemake: Any) -> CaptureDesign:
    """Who walks what, as often as the budget allows."""
    params, files = snakemake.params, snakemake.input
    groups = {name: group_of(name, params.participants[name]) for name in ("training", "scenarios")}
    return CaptureDesign(
        groups,
        TrainingDesign(**params.record_training),
        ScenarioDesign(**params.record_scenario),
        plans_by_scene(files.training_plans),
        {name: load_plan(path) for name, path in zip(params.scenarios, files.scenario_plans, strict=True)},
        Standing(**params.standing),
        SegmentationRules(**params.extract_walks),
        params.dependencies["curvature_scale_m"],
        params.seed,
        REPLICATE,
    )


def study_settings(params: Any, design: CaptureDesign) -> StudySettings:
    """What all specifications share."""
    planner: Mapping[str, Any] = params.planner
    wanted = params.dependencies
    plans = [*design.training_plans.values(), *design.scenario_plans.values()]
    blending_space = {**params.blending_space, "entries": params.multiverse["entries"]}
    return StudySettings(
        space_from_config(params.space),
        planner["name"],
        planner["step_s"],
        planner["options"],
        planner["time_limit_s"],
        {plan.scene.name: plan.scene for plan in plans},
        Body(**params.body),
        design.standing,
        tuple(wanted["names"]),
        wanted["curvature_scale_m"],
        wanted["route_sigma_samples"],
        settings_of(blending_space, params.model),
        params.fit_static["evaluations"],
        params.fit_static["starts"],
        params.calibrate_model["walks_per_participant"],
        params.statistics["bootstraps"],
        params.seed,
        REPLICATE,
    )
