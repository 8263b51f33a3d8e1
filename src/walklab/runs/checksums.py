"""Checksums of a run's products: written when a job ends, verified before another one reads them.

Each job leaves a ``checksums.txt`` beside its log: a line per product, its SHA-256 and its path from that folder,
so that ``sha256sum --check checksums.txt`` reads it too.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from walklab.errors import InputError
from walklab.storage import write_text

MANIFEST = "checksums.txt"
# Clocks of file servers differ a little; what is dated further ahead was written before the clock went back.
CLOCK_TOLERANCE_S = 60.0


@dataclass(frozen=True)
class Damage:
    """A product that is not what its job wrote."""

    path: str
    reason: str


@dataclass(frozen=True)
class Inspection:
    """What :func:`inspect` found in a run's folder.

    Attributes
    ----------
    checked : products that are there
    damaged : those that are not what was written
    missing : products that are gone, as temporary ones are; Snakemake makes what it needs again
    half_written : files that killed writers left behind
    """

    checked: int
    damaged: tuple[Damage, ...]
    missing: tuple[str, ...]
    half_written: tuple[str, ...]


def record(products: Iterable[str | Path], folder: str | Path) -> None:
    """Write the checksums of a job's products to ``folder``."""
    lines = [f"{sha256(path)}  {os.path.relpath(path, folder)}\n" for path in products]
    write_text("".join(lines), Path(folder) / MANIFEST)


def verify(inputs: Iterable[str | Path]) -> None:
    """Look whether files are what their jobs wrote; a file that no job of a run wrote passes.

    Raises
    ------
    InputError
        With the first damaged file, and what rebuilds it.
    """
    for path in map(Path, inputs):
        expected = _recorded(path)
        if expected and (reason := _reason(path, expected)):
            raise InputError(
                f"{path}: damaged ({reason}); rebuild it: snakemake --forcerun {path} (and the --configfile of this run)"
            )


def inspect(run: str | Path) -> Inspection:
    """Compare every product of a run's folder with its checksum, and look for what killed writers left behind.

    Raises
    ------
    InputError
        If there is no such folder, or no job has left checksums in it.
    """
    manifests = sorted(Path(run).rglob(MANIFEST))
    if not manifests:
        raise InputError(f"{run}: no {MANIFEST} in it; give the folder of a run, as results/steering")
    entries: dict[str, set[str]] = {}
    for manifest in manifests:
        for name, expected in _lines(manifest):
            entries.setdefault(os.path.normpath(manifest.parent / name), set()).add(expected)
    there = [(path, expected) for path, expected in entries.items() if Path(path).is_file()]
    damaged = [Damage(path, reason) for path, expected in there if (reason := _reason(Path(path), expected))]
    missing = [path for path in entries if not Path(path).is_file()]
    half_written = [str(path) for path in sorted(Path(run).rglob(".*")) if path.is_file()]
    return Inspection(len(there), tuple(damaged), tuple(missing), tuple(half_written))


def date_back(run: str | Path, now_s: float | None = None) -> list[str]:
    """Date files from the future to now, all alike, and return their names.

    They were written before the clock was put back; Snakemake compares dates and would take what is made of them for outdated.
    """
    now = time.time() if now_s is None else now_s
    future = [path for path in sorted(Path(run).rglob("*")) if path.is_file() and path.stat().st_mtime > now + CLOCK_TOLERANCE_S]
    for path in future:
        os.utime(path, (now, now))
    return [str(path) for path in future]


def sha256(path: str | Path) -> str:
    """SHA-256 of a file's content, hexadecimal."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _reason(path: Path, expected: set[str]) -> str:
    """Why a product is not what its job wrote; empty if it is."""
    if sha256(path) in expected:
        return ""
    return "its content is not what was written" if path.stat().st_size else "empty"


def _recorded(path: Path) -> set[str]:
    """The checksums of a product in the manifests of jobs that wrote it; none if no job did.

    More than one if another configuration had it written by another rule, whose manifest is still there.
    """
    # A job's log lies beside its products or one folder above; what is shown at the top of a run, in its stage's folder.
    folders = (path.parent, path.parent.parent)
    beside = _named([folder / MANIFEST for folder in folders], path)
    return beside or _named([m for f in folders for stages in ("[0-9]*/*", "*") for m in f.glob(f"{stages}/{MANIFEST}")], path)


def _named(manifests: Iterable[Path], path: Path) -> set[str]:
    return {
        expected
        for manifest in manifests
        if manifest.is_file()
        for name, expected in _lines(manifest)
        if name == os.path.relpath(path, manifest.parent)
    }


def _lines(manifest: Path) -> Iterator[tuple[str, str]]:
    for line in manifest.read_text(errors="replace").splitlines():
        expected, _, name = line.partition("  ")
        yield name, expected
