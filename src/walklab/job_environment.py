"""Environment variables that every job of a run inherits, and whether its packages are those of the lock file."""

from __future__ import annotations

import os
import sys
from importlib.metadata import distributions
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

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


def stale(root: Path, prefix: str | Path = sys.prefix) -> str:
    """One line if the checkout's own environment lacks packages of its lock file, or has others; else empty.

    A job that misses a package fails before it has a log, and then only a traceback of Snakemake's is seen. Another
    environment, as of a workflow that uses walklab as a module, is its owner's business.
    """
    if Path(prefix).resolve() != (root / ".venv").resolve():
        return ""
    differing = unlike(root / "requirements.lock", {canonicalize_name(found.name): found.version for found in distributions()})
    if not differing:
        return ""
    named = ", ".join(differing[:3]) + (f" and {len(differing) - 3} more" if len(differing) > 3 else "")
    return f"walklab: .venv is not that of requirements.lock ({named}); run make --always-make .venv/ready"


def unlike(lock: Path, installed: dict[str, str]) -> list[str]:
    """The requirements of a lock file, ``name==version``, that installed versions (by canonical name) do not meet here."""
    lines = [line.removesuffix("\\").strip() for line in lock.read_text().splitlines() if line[:1] not in ("", " ", "#")]
    wanted = [one for one in map(Requirement, lines) if one.marker is None or one.marker.evaluate()]
    versions = [installed.get(canonicalize_name(one.name), "0") for one in wanted]
    met = [one.specifier.contains(version, prereleases=True) for one, version in zip(wanted, versions, strict=True)]
    return [f"{one.name}{one.specifier}" for one, is_met in zip(wanted, met, strict=True) if not is_met]
