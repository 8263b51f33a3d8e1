"""What a run will compute, and roughly how long and how much disk it takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

# Measured on 2 cores of a 2.6 GHz EPYC; indications, not promises (see results/<run>/run.json for a run's own).
SECONDS_PER_CELL_SCORE = 8e-6
SECONDS_PER_TRAINING_WALK = 0.03
SECONDS_PER_TRIAL = 0.012
SECONDS_PER_RUN = 120.0
BYTES_PER_TRAINING_WALK = 45_000
BYTES_PER_CELL = 6
BYTES_PER_SCENARIO_WALK = 12_000


@dataclass(frozen=True)
class Estimate:
    """Size of a run.

    Attributes
    ----------
    training_walks, scenario_walks, cells, maps : counts, replicates included
    wall_minutes : time on the given number of cores
    disk_gb : size of the results
    """

    training_walks: int
    scenario_walks: int
    cells: int
    maps: int
    wall_minutes: float
    disk_gb: float


def estimate(config: Mapping[str, Any], walks_per_set: int, cores: int) -> Estimate:
    """Size of a run from its completed configuration.

    Parameters
    ----------
    walks_per_set : walks in one set of all scenarios together
    cores : that work at the same time
    """
    replicates = config["replicates"]
    design = config["record_training"]
    straight = len(design["straight_distances_m"]) * design["straight_repetitions"]
    turning = len(design["turning_angles_deg"]) * len(design["turning_distances_m"]) * design["turning_repetitions"]
    training = replicates * config["participants"]["training"]["count"] * (straight + turning)
    scenario = replicates * sum(config["record_scenario"]["sets"]) * walks_per_set
    cells = prod(len(axis["values"]) if "values" in axis else axis["count"] for axis in config["space"])
    maps = replicates * (config["blending_space"]["entries"] or training)
    variants = 3 + 6 + len(config["sweep_neighbours"]["k"])
    seconds = (
        SECONDS_PER_RUN
        + training * (SECONDS_PER_TRAINING_WALK + cells * SECONDS_PER_CELL_SCORE)
        + scenario * variants * SECONDS_PER_TRIAL
    )
    disk = (
        training * BYTES_PER_TRAINING_WALK + scenario * BYTES_PER_SCENARIO_WALK + (training + 3 * maps) * cells * BYTES_PER_CELL
    )
    return Estimate(training, scenario, cells, maps, seconds / cores / 60, disk / 1e9)
