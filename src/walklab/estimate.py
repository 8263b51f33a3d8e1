"""What a run will compute, and roughly how long and how much disk it takes."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import Any

from walklab.consistency import recorded_walks

# Measured on 2 cores of a 2.6 GHz Xeon; indications, not promises (results/<run>/run.json has a run's own).
SECONDS_PER_RUN = 120.0
SECONDS_PER_TRAINING_WALK = 0.006
SECONDS_PER_CELL_SCORE = 3e-6
SECONDS_PER_TRIAL = 0.004
SHARE_OF_POPULATION = 0.5  # of a run's jobs, what one of many populations takes: no figures, no ablations
BYTES_PER_RUN = 60e6
BYTES_PER_TRAINING_WALK = 30_000
BYTES_PER_SCENARIO_WALK = 12_000
BYTES_PER_MAP_CELL = 25


def estimate(config: Mapping[str, Any], walks_per_set: int, cores: int) -> str:
    """One sentence on the size of a run.

    Parameters
    ----------
    config : completed configuration
    walks_per_set : walks in one set of all scenarios together
    cores : that work at the same time
    """
    cells = prod(len(axis["values"]) if "values" in axis else axis["count"] for axis in config["space"])
    if config["source"]["kind"] not in ("synthetic", "resampled"):
        return (
            f"the walks of {config['source']['path']} x {cells} parameter vectors, leaving out one participant at a time; "
            f"about {_minutes(SECONDS_PER_RUN, cores)} and {_size(BYTES_PER_RUN)} for fewer than a hundred walks"
        )
    training, scenario = training_walks(config), config["replicates"] * sum(config["record_scenario"]["sets"]) * walks_per_set
    maps = config["replicates"] * (config["blending_space"]["entries"] or training)
    variants = 3 + 6 + len(config["sweep_neighbours"]["k"])
    seconds = config["replicates"] * SECONDS_PER_RUN + scenario * variants * SECONDS_PER_TRIAL
    seconds += training * (SECONDS_PER_TRAINING_WALK + cells * SECONDS_PER_CELL_SCORE)
    if config["replicates"] > 1:
        seconds *= SHARE_OF_POPULATION
    disk = BYTES_PER_RUN + training * BYTES_PER_TRAINING_WALK + scenario * BYTES_PER_SCENARIO_WALK
    disk += maps * cells * BYTES_PER_MAP_CELL
    return (
        f"{training} training walks x {cells} parameter vectors, a blending space of {maps} maps, {scenario} evaluated walks; "
        f"about {_minutes(seconds, cores)} and {_size(disk)}"
    )


def training_walks(config: Mapping[str, Any]) -> int:
    """Walks out of experiment 1, the flawed ones included, in all replicates."""
    return config["replicates"] * recorded_walks(config)


def _minutes(core_seconds: float, cores: int) -> str:
    return f"{max(1, round(core_seconds / cores / 60))} min on {cores} cores"


def _size(size_bytes: float) -> str:
    return f"{size_bytes / 1e9:.1f} GB" if size_bytes >= 1e9 else f"{size_bytes / 1e6:.0f} MB"
