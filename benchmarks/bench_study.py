"""The whole study, ``make``, in a copy of the tracked files: nothing of an earlier run is there, not even compiled kernels.

The environment is that of this checkout, so that set-up does not count.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from case import Case, Work

from walklab.storage import read_json

ROOT = Path(__file__).resolve().parents[1]
COPY = ROOT / "results/bench/study"


def copied() -> Work:
    """``make`` in a fresh copy."""
    shutil.rmtree(COPY, ignore_errors=True)
    names = subprocess.run(["git", "-C", str(ROOT), "ls-files"], capture_output=True, text=True, check=True).stdout.splitlines()
    for name in names:
        (COPY / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, COPY / name)
    (COPY / ".venv").symlink_to(ROOT / ".venv")

    def make() -> None:
        environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
        # -o: the environment counts as ready, whatever the times of the copied files say.
        done = subprocess.run(
            ["make", "-o", ".venv/ready", "all"], cwd=COPY, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise RuntimeError("the study failed:\n" + "\n".join(done.stderr.splitlines()[-20:]))

    return Work(make, 1, f"s, {os.cpu_count()} cores", rounds=1)


def peak_memory_mb() -> float:
    """Of the stage that needed most, from the record of that run."""
    return float(read_json(COPY / "results/steering/run.json")["totals"]["peak_memory_mb"])


CASES = [Case("study", copied, wall=True)]
MEASURES = {"study_memory": (peak_memory_mb, "MB")}
