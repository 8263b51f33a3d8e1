"""What a study of many walks costs: straight lines through measured jobs, carried on to more walks.

A job's CPU time, peak memory and bytes on disk are taken to be ``fixed + per_walk * n`` with n the walks that
the job handles; the two numbers come from the jobs of at least two sizes (least squares).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq

from walklab.errors import InputError

# Stages that run once a shard, in their order, and the one that all maps meet in.
SHARDED = ("record_training", "extract_training", "plan_training", "score_maps")
MEETING = "build_space"
HOUR_S = 3600.0
# What lies beside the products of a job.
BESIDE = ("log.txt", "benchmark.tsv", "checksums.txt", "cost.json")


@dataclass(frozen=True)
class Cost:
    """Of one job."""

    walks: int
    cpu_s: float
    memory_mb: float
    disk_mb: float


@dataclass(frozen=True)
class Line:
    """``fixed + per_walk * walks``, neither below zero."""

    fixed: float
    per_walk: float

    def at(self, walks: float) -> float:
        return self.fixed + self.per_walk * walks


def measured(runs: Sequence[str | Path]) -> dict[str, list[Cost]]:
    """Costs of the jobs of each training stage in finished runs.

    Raises
    ------
    InputError
        If a run has no finished blending space.
    """
    costs: dict[str, list[Cost]] = {stage: [] for stage in (*SHARDED, MEETING)}
    for run in runs:
        replicate = Path(run) / "0"
        tables = replicate.glob("extract_training/*/walks.parquet")
        counts = {table.parent.name: pq.read_metadata(table).num_rows for table in tables}
        if not counts or not (replicate / MEETING / "benchmark.tsv").is_file():
            raise InputError(f"{run}: no finished {MEETING} in it; run the study first")
        for stage in SHARDED:
            costs[stage] += [_cost(replicate / stage / shard, walks) for shard, walks in counts.items()]
        costs[MEETING].append(_cost(replicate / MEETING, sum(counts.values())))
    return costs


def _cost(folder: Path, walks: int) -> Cost:
    row = pd.read_csv(folder / "benchmark.tsv", sep="\t", na_values="-").iloc[0]
    size = sum(path.stat().st_size for path in folder.iterdir() if path.name not in BESIDE)
    return Cost(walks, float(row["cpu_time"]), float(row["max_rss"]), size / 1e6)


def line(costs: Sequence[Cost], what: str) -> Line:
    """Least squares through one quantity of jobs of different sizes.

    Raises
    ------
    InputError
        If all jobs have about the same size, so that fixed and growing costs cannot be told apart.
    """
    walks = np.array([cost.walks for cost in costs], dtype=float)
    values = np.array([getattr(cost, what) for cost in costs])
    if walks.max() < 1.2 * walks.min():
        raise InputError("all measured jobs have about the same number of walks; give runs of different sizes")
    per_walk, fixed = np.polyfit(walks, values, 1)
    if fixed < 0:  # noise: what no walk costs cannot be negative
        return Line(0.0, float((walks @ values) / (walks @ walks)))
    return Line(float(fixed), float(max(per_walk, 0.0)))


def sizing(costs: dict[str, list[Cost]], walks: Sequence[int], walks_per_shard: int) -> pd.DataFrame:
    """Cost of capture, maps and blending space for numbers of walks; a row per number and stage.

    Returns
    -------
    DataFrame[walks, stage, jobs, core_hours, memory_gb, disk_gb]: memory of one job, everything else in all
    """
    rows = []
    for total in walks:
        for stage in (*SHARDED, MEETING):
            jobs = 1 if stage == MEETING else -(-total // walks_per_shard)
            share = total / jobs
            cpu_s, memory_mb, disk_mb = (line(costs[stage], what).at(share) for what in ("cpu_s", "memory_mb", "disk_mb"))
            rows.append((total, stage, jobs, jobs * cpu_s / HOUR_S, memory_mb / 1e3, jobs * disk_mb / 1e3))
    return pd.DataFrame(rows, columns=["walks", "stage", "jobs", "core_hours", "memory_gb", "disk_gb"])


def as_markdown(table: pd.DataFrame, node_memory_gb: float) -> str:
    """The table for the manual, with a line per number of walks that says whether it fits a node."""
    lines = ["| walks | stage | jobs | core-hours | memory of a job (GB) | disk (GB) |", "|---|---|---|---|---|---|"]
    for total, part in table.groupby("walks"):
        for row in part.itertuples():
            cells = (f"{row.core_hours:.3g}", f"{row.memory_gb:.2g}", f"{row.disk_gb:.2g}")
            lines.append(f"| {total:,} | {row.stage} | {row.jobs:,} | {' | '.join(cells)} |")
        largest = part.sort_values("memory_gb").iloc[-1]
        fits = largest["memory_gb"] <= node_memory_gb
        verdict = "fits" if fits else f"breaks: {largest['stage']} does not fit"
        lines.append(
            f"| **{total:,}** | **all; {verdict} into {node_memory_gb:g} GB** | **{part['jobs'].sum():,}** "
            f"| **{part['core_hours'].sum():.3g}** | **{largest['memory_gb']:.2g}** | **{part['disk_gb'].sum():.2g}** |"
        )
    return "\n".join(lines)
