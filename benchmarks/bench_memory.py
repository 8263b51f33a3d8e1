"""Peak memory of a process that opens a saved model and draws from it, and does nothing else."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from bench_model import synthetic_model

DRAWING = """
import sys
import numpy as np
from walklab import ProbabilisticModel
model = ProbabilisticModel.load(sys.argv[1])
rng = np.random.default_rng(0)
model.sample(length=2.5, curvature=0.3, height=1.78, size=1000, rng=rng)
model.sample_batch(np.array([[2.5, 0.3, 1.78], [1.5, 0.1, 1.7]]), 1, rng)
# Not ru_maxrss: a process that was started inherits that of the one which started it.
print(next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM")) / 1024)
"""


def sampling_process_mb() -> float:
    """Largest resident memory of such a process with 5000 maps of 1000 cells, MB; its kernels are compiled by one before it."""
    with tempfile.TemporaryDirectory() as folder:
        saved = Path(folder) / "model.safetensors"
        synthetic_model("rbf").save(saved)
        command = [sys.executable, "-W", "ignore", "-c", DRAWING, str(saved)]
        for _ in range(2):
            done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stdout)


# Numbers that are no times: key -> (measurement, unit).
MEASURES = {"sampling_memory": (sampling_process_mb, "MB")}
