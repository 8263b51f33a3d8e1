"""The record of a run: configuration, code, versions, machine, results in brief, and the cost of every stage."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
from collections.abc import Mapping, Sequence
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

import pandas as pd

from walklab.runs import cost
from walklab.runs.checksums import sha256
from walklab.storage import read_json, read_table

CLAIM_COLUMNS = ("id", "published", "ours", "ours_low", "ours_high", "verdict")
# What names a row of a table of scores, and what is kept of it.
SCORE_KEYS = ("scenario", "participant", "model", "information")
SCORE_VALUES = ("crps_s", "energy_m", "coverage_90")


def record(
    config: Mapping[str, Any],
    root: str | Path,
    costs: Sequence[str],
    code: Mapping[str, str],
    products: Sequence[str],
    folder: str | Path,
    maker: str,
) -> dict[str, Any]:
    """Everything that is needed to tell one run from another.

    Parameters
    ----------
    config : the completed configuration
    root : the checkout
    costs : what every job has left of its cost, ``<folder>/[<replicate>/]<stage>/[<part>/]cost.json`` (:mod:`walklab.runs.cost`)
    code : digest of what each script of the workflow computes with
    products : files the run was made for; ``claims.csv`` and ``scores.csv`` among them are kept in brief
    folder : the run's folder, ``results/<run>``; its last part names the run
    maker : the stage that this is called in, whose cost until now is the last of stages

    Returns
    -------
    dict with run, recorded (UTC), seed, config, commit, code, versions, machine, claims, scores, products (SHA-256 by
    path below the folder), stages (wall time, CPU time and peak memory of each job) and totals
    """
    stages = [stage for stage in (stage_cost(path, folder) for path in sorted(costs)) if stage["stage"] != maker]
    stages.append({"stage": maker, "part": "", "replicate": 0, **cost.so_far()})
    inside = sorted(path for path in map(Path, products) if path.is_relative_to(folder))
    return {
        "run": Path(folder).name,
        "recorded": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "seed": config["seed"],
        "config": dict(config),
        "commit": commit(root),
        "code": dict(sorted(code.items())),
        "versions": dict(sorted((found.metadata["Name"], found.version) for found in distributions())),
        "machine": machine(),
        "claims": brief(Path(folder) / "claims.csv", inside, CLAIM_COLUMNS),
        "scores": brief(Path(folder) / "scores.csv", inside, (*SCORE_KEYS, *SCORE_VALUES)),
        "products": {path.relative_to(folder).as_posix(): sha256(path) for path in inside},
        "stages": stages,
        "totals": totals(stages),
    }


def totals(stages: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """What all jobs together took, and the largest of them."""
    return {
        "jobs_wall_s": round(sum(stage["wall_s"] for stage in stages), 1),
        "jobs_cpu_s": round(sum(stage["cpu_s"] for stage in stages), 1),
        "peak_memory_mb": max((stage["peak_memory_mb"] for stage in stages), default=0.0),
    }


def stage_cost(path: str | Path, folder: str | Path) -> dict[str, Any]:
    """Wall time (s), CPU time (s) and peak memory (MB) that a job left; what has no replicates counts as replicate 0."""
    parts = Path(path).relative_to(folder).parts[:-1]
    replicate, stage, *part = parts if parts[0].isdigit() else ("0", *parts)
    return {"stage": stage, "part": "/".join(part), "replicate": int(replicate), **read_json(path)}


def brief(path: Path, products: Sequence[Path], columns: Sequence[str]) -> list[dict[str, Any]]:
    """The named columns of a product, a dictionary per row; rows that split a score by hull are left out.

    Empty for a table of another kind, without the first or the last column, as the tables over many replicates
    or specifications are.
    """
    if path not in products:
        return []
    table = read_table(path)
    if not {columns[0], columns[-1]} <= set(table):
        return []
    if "hull" in table:
        table = table[table["hull"] == "all"]
    kept = table[[name for name in columns if name in table]]
    return [
        {str(name): None if pd.isna(value) else value for name, value in row.items()} for row in kept.to_dict(orient="records")
    ]


def machine() -> dict[str, Any]:
    """What the run was made on, without a name that would identify it."""
    memory_bytes = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "platform": platform.platform(),
        "python": platform.python_version(),
        "processor": processor(),
        "cores": os.cpu_count(),
        "memory_gb": round(memory_bytes / 1e9, 1),
    }


def processor(source: str | Path = "/proc/cpuinfo") -> str:
    """The processor's name as Linux tells it, else as Python knows it."""
    try:
        lines = Path(source).read_text().splitlines()
    except OSError:
        lines = []
    named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor()


def commit(root: str | Path) -> dict[str, Any]:
    """The commit of the checkout and whether files differ from it; where git knows none, what an image was built from."""

    def git(*arguments: str) -> str:
        done = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True, check=False)
        return done.stdout.strip() if done.returncode == 0 else ""

    try:
        identity = git("rev-parse", "HEAD")
        return {"id": identity, "dirty": bool(git("status", "--porcelain"))} if identity else built_from()
    except OSError:
        return built_from()


def built_from() -> dict[str, Any]:
    """The commit that the Containerfile was given; empty outside of such an image. Dirty unless it was said to be clean."""
    identity = os.environ.get("WALKLAB_COMMIT", "").strip()
    return {"id": identity, "dirty": os.environ.get("WALKLAB_DIRTY", "").strip() != "false"} if identity else {}
