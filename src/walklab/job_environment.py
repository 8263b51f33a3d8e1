"""Environment variables that every job of a run inherits."""

from __future__ import annotations

import os
from pathlib import Path

from walklab.code_digest import source_digest


def prepare(root: Path) -> None:
    """Set what results and compiled kernels depend on.

    One BLAS thread a job, because results must not depend on how a library splits its sums; a
    numba cache keyed by the sources (see :func:`walklab.code_digest.source_digest`); figures
    without a display; and the default place of real recordings.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    compiled = Path(os.environ.get("NUMBA_CACHE_DIR", root / ".snakemake/numba"))
    os.environ["NUMBA_CACHE_DIR"] = str(compiled / source_digest(root / "src/walklab"))
    os.environ["MPLBACKEND"] = "agg"
    os.environ.setdefault("WALKLAB_DATA", "../shared/data")
