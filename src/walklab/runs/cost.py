"""What a job has taken of the machine, as it measures itself when it ends.

Snakemake's benchmark directive samples from outside, which misses most of a job of a second or two and keeps
Snakemake itself busy.
"""

from __future__ import annotations

import os
import resource
import time
from pathlib import Path

import psutil

from walklab.storage import write_json

FILE = "cost.json"


def so_far() -> dict[str, float]:
    """Wall time (s) and CPU time (s, all threads) since this process began, and its peak memory (MB, resident)."""
    times = os.times()
    return {
        "wall_s": round(age_s(), 2),
        "cpu_s": round(times.user + times.system + times.children_user + times.children_system, 2),
        "peak_memory_mb": round(peak_memory_mb(), 1),
    }


def age_s() -> float:
    """Seconds since this process began.

    On Linux by the clock that its start was taken from: the time of day of a start is known to a second only.
    """
    try:
        started = int(Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19])
        return time.clock_gettime(time.CLOCK_BOOTTIME) - started / os.sysconf("SC_CLK_TCK")
    except (OSError, AttributeError):  # not Linux
        return time.time() - psutil.Process().create_time()


def peak_memory_mb(status: str | Path = "/proc/self/status") -> float:
    """Largest resident memory (MB, 10^6 bytes) of this process."""
    try:
        lines = Path(status).read_text().splitlines()
    except OSError:  # not Linux: there the peak is in bytes
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    # Not getrusage: on Linux its peak also counts the program that started this one. The file counts in KiB.
    return next(int(line.split()[1]) * 1024 / 1e6 for line in lines if line.startswith("VmHWM:"))


def write(folder: str | Path) -> None:
    """Leave the cost of this job in ``folder``, beside its log."""
    write_json(so_far(), Path(folder) / FILE)
