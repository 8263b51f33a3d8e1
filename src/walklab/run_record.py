"""The record of a run: configuration, versions, commit, and the cost of every stage."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Mapping, Sequence
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

import pandas as pd


def record(config: Mapping[str, Any], root: str | Path, benchmarks: Sequence[str]) -> dict[str, Any]:
    """Everything that is needed to tell one run from another.

    Parameters
    ----------
    config : the completed configuration
    root : the checkout
    benchmarks : Snakemake's benchmark file of every job, ``.../<replicate>/<stage>/[<part>/]benchmark.tsv``

    Returns
    -------
    dict with run, seed, config, commit, versions, machine, stages (wall time and peak memory of each job) and totals
    """
    stages = [stage_cost(path) for path in sorted(benchmarks)]
    return {
        "run": config["run"],
        "seed": config["seed"],
        "config": dict(config),
        "commit": commit(root),
        "versions": dict(sorted((found.metadata["Name"], found.version) for found in distributions())),
        "machine": {"platform": platform.platform(), "python": platform.python_version(), "cores": os.cpu_count()},
        "stages": stages,
        "totals": {
            "jobs_wall_s": round(sum(stage["wall_s"] for stage in stages), 1),
            "peak_memory_mb": max((stage["peak_memory_mb"] for stage in stages), default=0.0),
        },
    }


def stage_cost(path: str | Path) -> dict[str, Any]:
    """Wall time and peak memory of one job from its benchmark file."""
    parts = Path(path).parts
    replicate, stage, *part = parts[2:-1]
    row = pd.read_csv(path, sep="\t", na_values="-").iloc[0]
    memory_mb = row.get("max_rss", 0.0)
    return {
        "stage": stage,
        "part": "/".join(part),
        "replicate": int(replicate),
        "wall_s": round(float(row["s"]), 2),
        # A job shorter than the polling interval has no measured memory.
        "peak_memory_mb": 0.0 if pd.isna(memory_mb) else round(float(memory_mb), 1),
    }


def commit(root: str | Path) -> dict[str, Any]:
    """The commit of the checkout and whether files differ from it; empty outside of git."""

    def git(*arguments: str) -> str:
        done = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True, check=False)
        return done.stdout.strip() if done.returncode == 0 else ""

    try:
        identity = git("rev-parse", "HEAD")
        return {"id": identity, "dirty": bool(git("status", "--porcelain"))} if identity else {}
    except OSError:
        return {}
