"""What a study of many walks costs: what its jobs have taken in runs of different sizes, carried on to more walks.

A job's CPU time, peak memory and bytes on disk are taken to be ``fixed + per_walk * n`` with n the walks that the job handles.
Every run gives one point for each stage: of its equal jobs, the lower median of CPU time (a job that compiles the kernels
first is no measure of the others), the largest memory and the mean of the disk.

The blending space is one job of all walks; n counts its entries, the added ones too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import xarray as xr

from walklab.errors import InputError
from walklab.runs import cost
from walklab.runs.checksums import BESIDE
from walklab.storage import read_json

# Stages that run once a shard, in their order, and the one that all maps meet in.
SHARDED = ("record_training", "extract_training", "plan_training", "score_maps")
MEETING = "build_space"
HOUR_S = 3600.0
QUANTITIES = ("cpu_s", "memory_mb", "disk_mb")


@dataclass(frozen=True)
class Cost:
    """Of one job, or of the typical one of a stage; ``added`` entries are blended, in the blending space only."""

    walks: float
    cpu_s: float
    memory_mb: float
    disk_mb: float
    added: int = 0

    @property
    def entries(self) -> float:
        """Walks and what is added to them."""
        return self.walks + self.added


@dataclass(frozen=True)
class Line:
    """``fixed + per_walk * walks``, neither below zero."""

    fixed: float
    per_walk: float

    def at(self, walks: float) -> float:
        return self.fixed + self.per_walk * walks


def measured(runs: Sequence[str | Path]) -> dict[str, list[Cost]]:
    """A typical job of each training stage in each of some finished runs, as the jobs measured them (:mod:`walklab.runs.cost`).

    Raises
    ------
    InputError
        If a run has no finished blending space.
    """
    stages: dict[str, list[Cost]] = {stage: [] for stage in (*SHARDED, MEETING)}
    for run in runs:
        replicate = Path(run) / "0"
        # Not what extract_training cuts out of the recordings: half of that is no training walk.
        tables = replicate.glob("plan_training/*/vectors.parquet")
        counts = {table.parent.name: pq.read_metadata(table).num_rows for table in tables}
        if not counts or not (replicate / MEETING / cost.FILE).is_file():
            raise InputError(f"{run}: no finished {MEETING} in it; run the study first")
        for stage in SHARDED:
            stages[stage].append(typical([_cost(replicate / stage / shard, walks) for shard, walks in counts.items()]))
        with xr.open_dataset(replicate / MEETING / "blending_space.nc") as space:
            entries = space.sizes["entry"]
        walks = sum(counts.values())
        stages[MEETING].append(_cost(replicate / MEETING, walks, entries - walks))
    return stages


def typical(jobs: Sequence[Cost]) -> Cost:
    """One job for the equal ones of a run: lower median of CPU time, largest memory, mean of walks and disk."""
    return Cost(
        float(np.mean([job.walks for job in jobs])),
        sorted(job.cpu_s for job in jobs)[(len(jobs) - 1) // 2],
        max(job.memory_mb for job in jobs),
        float(np.mean([job.disk_mb for job in jobs])),
    )


def _cost(folder: Path, walks: int, added: int = 0) -> Cost:
    took = read_json(folder / cost.FILE)
    size = sum(path.stat().st_size for path in folder.iterdir() if path.name not in BESIDE)
    return Cost(walks, float(took["cpu_s"]), float(took["peak_memory_mb"]), size / 1e6, added)


def line(sizes: Sequence[float], values: Sequence[float]) -> Line:
    """Least squares through one quantity of jobs of different sizes.

    Raises
    ------
    InputError
        If all jobs have about the same size, so that fixed and growing costs cannot be told apart.
    """
    walks, taken = np.array(sizes, dtype=float), np.array(values, dtype=float)
    if walks.max() < 1.2 * walks.min():
        raise InputError("all measured jobs have about the same number of walks; give runs of different sizes")
    per_walk, fixed = np.polyfit(walks, taken, 1)
    if fixed < 0:  # noise: what no walk costs cannot be negative
        return Line(0.0, float((walks @ taken) / (walks @ walks)))
    return Line(float(fixed), float(max(per_walk, 0.0)))


def sizing(
    stages: Mapping[str, Sequence[Cost]], walks: Sequence[int], walks_per_shard: int, added_per_walk: float
) -> pd.DataFrame:
    """Cost of capture, maps and blending space for numbers of walks; a row per number and stage.

    Returns
    -------
    DataFrame[walks, stage, jobs, core_hours, memory_gb, disk_gb]: memory of one job, everything else in all
    """
    rows = []
    for total in walks:
        jobs = -(-total // walks_per_shard)
        rows += [(total, stage, jobs, *_carried(stages[stage], jobs, total / jobs)) for stage in SHARDED]
        rows.append((total, MEETING, 1, *_carried(stages[MEETING], 1, total + round(added_per_walk * total))))
    return pd.DataFrame(rows, columns=["walks", "stage", "jobs", "core_hours", "memory_gb", "disk_gb"])


def _carried(points: Sequence[Cost], jobs: int, entries: float) -> tuple[float, float, float]:
    """Core-hours of all jobs of a stage, memory of one and disk of all (GB), each job with so many entries."""
    sizes = [point.entries for point in points]
    cpu_s, memory_mb, disk_mb = (line(sizes, [getattr(point, what) for point in points]).at(entries) for what in QUANTITIES)
    return jobs * cpu_s / HOUR_S, memory_mb / 1e3, jobs * disk_mb / 1e3


def measurements(stages: Mapping[str, Sequence[Cost]]) -> str:
    """What the lines go through, as a table for the manual: a row per stage and run."""
    lines = ["| stage | walks of a job | entries added | CPU time (s) | memory (GB) | disk (MB) |", "|---|---|---|---|---|---|"]
    lines += [
        f"| {stage} | {job.walks:,.0f} | {job.added or '-'} | {job.cpu_s:.3g} | {job.memory_mb / 1e3:.2g} | {job.disk_mb:.3g} |"
        for stage, jobs in stages.items()
        for job in jobs
    ]
    return "\n".join(lines)


def as_markdown(table: pd.DataFrame, node_memory_gb: float, job_hours: float) -> str:
    """The table for the manual, with a line per number of walks that says whether its jobs fit a node and its longest job."""
    lines = ["| walks | stage | jobs | core-hours | memory of a job (GB) | disk (GB) |", "|---|---|---|---|---|---|"]
    for total, part in table.groupby("walks"):
        for row in part.to_dict("records"):
            cells = " | ".join(_number(row[name]) for name in ("core_hours", "memory_gb", "disk_gb"))
            lines.append(f"| {total:,} | {row['stage']} | {row['jobs']:,} | {cells} |")
        lines.append(
            f"| **{total:,}** | **all: {_verdict(part, node_memory_gb, job_hours)}** | **{part['jobs'].sum():,}** "
            f"| **{_number(part['core_hours'].sum())}** | **{_number(part['memory_gb'].max())}** "
            f"| **{_number(part['disk_gb'].sum())}** |"
        )
    return "\n".join(lines)


def _number(value: float) -> str:
    """Two digits, or all before the point."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.2g}"


def _verdict(part: pd.DataFrame, node_memory_gb: float, job_hours: float) -> str:
    large = part[part["memory_gb"] > node_memory_gb]["stage"]
    long = part[part["core_hours"] / part["jobs"] > job_hours]["stage"]
    breaks = [f"{stage} needs more than {node_memory_gb:g} GB" for stage in large]
    breaks += [f"{stage} takes more than {job_hours:g} hours" for stage in long]
    return f"breaks: {'; '.join(breaks)}" if breaks else f"fits nodes of {node_memory_gb:g} GB"
