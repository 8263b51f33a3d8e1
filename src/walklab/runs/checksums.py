"""Checksums of a run's products: written when a job ends, verified before another one reads them.

Each job leaves a ``checksums.txt`` beside its log: a line per product, its SHA-256 and its path from that folder,
so that ``sha256sum --check checksums.txt`` reads it too.
"""

from __future__ import annotations

import hashlib
import os
import re
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from walklab.errors import InputError
from walklab.runs import cost
from walklab.runs.io import read_record
from walklab.storage import is_temporary, write_text

MANIFEST = "checksums.txt"
BESIDE = ("log.txt", MANIFEST, cost.FILE)  # what a job leaves of itself in its folder
LINE = re.compile(r"([0-9a-f]{64})  (.+)")
# Bulky files, which Snakemake deletes once they are read (workflow/rules/common.smk), but for those of the single population 0.
TEMPORARY = re.compile(r"[1-9]\d*/(record_training|record_scenario)/[^/]+/(recording|poses)\.parquet$")
# Clocks of file servers differ a little; what is dated further ahead was written before the clock went back.
CLOCK_TOLERANCE_S = 60.0


@dataclass(frozen=True)
class Damage:
    """A product, or a job's list of checksums, that is not what its job wrote; ``rebuild`` is the file or rule to make again."""

    path: str
    reason: str
    rebuild: str


@dataclass(frozen=True)
class Inspection:
    """What :func:`inspect` found in a run's folder.

    Attributes
    ----------
    checked : products that are there
    damaged : those that are not what was written, and lists of checksums that are empty, cut off or gone
    missing : products that are gone and should not be
    temporary : number of products that are gone because they were read, as Snakemake's temporary files are
    half_written : files that killed writers left behind
    """

    checked: int
    damaged: tuple[Damage, ...]
    missing: tuple[str, ...]
    temporary: int
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
        if path.name in BESIDE:  # nothing vouches for what a job says of itself
            continue
        expected = _recorded(path)
        reason = _reason(path, expected) if expected else _unvouched(path)
        if reason:
            raise InputError(
                f"{path}: damaged ({reason}); rebuild it: .venv/bin/snakemake --forcerun {path}"
                " (and the --configfile of this run)"
            )


def inspect(run: str | Path) -> Inspection:
    """Compare every product of a run's folder with its checksum, and look for what killed writers left behind.

    Products are those that jobs list in their folders, and those that ``run.json`` lists.

    Raises
    ------
    InputError
        If there is no such folder, or no job has left anything in it.
    """
    files = _files(run)
    if not any(path.name in BESIDE for path in files):
        raise InputError(f"{run}: no {MANIFEST} in it; give the folder of a run, as results/steering")
    entries = _entries(files)
    there = {path: expected for path, expected in entries.items() if Path(path).is_file()}
    damaged = [Damage(path, reason, path) for path, expected in there.items() if (reason := _reason(Path(path), expected))]
    gone = [path for path in entries if path not in there]
    missing = [path for path in gone if not TEMPORARY.search(path)]
    return Inspection(
        len(there),
        (*damaged, *_unlisted(files, run)),
        tuple(missing),
        len(gone) - len(missing),
        tuple(str(path) for path in files if is_temporary(path)),
    )


def date_back(run: str | Path, now_s: float | None = None) -> list[str]:
    """Date what jobs wrote from the future to now, all alike, and return the files' names.

    They were written before the clock was put back; Snakemake compares dates and would take what is made of them for outdated.
    """
    now = time.time() if now_s is None else now_s
    files = _files(run)
    entries = _entries(files)
    ours = [path for path in files if path.name in BESIDE or os.path.normpath(path) in entries]
    future = [path for path in ours if path.stat().st_mtime > now + CLOCK_TOLERANCE_S]
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


def _files(run: str | Path) -> list[Path]:
    """All files of a folder, without those in hidden folders (.git, .venv), which are nobody's run."""
    found: list[Path] = []
    for folder, folders, names in os.walk(run):
        folders[:] = [name for name in folders if not name.startswith(".")]
        found += [path for name in names if (path := Path(folder, name)).is_file()]
    return sorted(found)


def _entries(files: Iterable[Path]) -> dict[str, set[str]]:
    """The checksums of every product, as jobs and the records of runs list them."""
    found: dict[str, set[str]] = {}
    for path in files:
        for name, expected in _lines(path) if path.name == MANIFEST else _listed(path) if path.name == "run.json" else ():
            found.setdefault(os.path.normpath(path.parent / name), set()).add(expected)
    return found


def _listed(path: Path) -> list[tuple[str, str]]:
    """Path from the run's folder and checksum of the products that the record of a run lists."""
    try:
        return [(str(name), str(expected)) for name, expected in read_record(path).get("products", {}).items()]
    except (InputError, AttributeError):  # of another program, or damaged, which its own checksum tells
        return []


def _unlisted(files: Iterable[Path], run: str | Path) -> list[Damage]:
    """Lists of checksums that are empty, cut off or gone, with the rule to run again."""
    manifests = sorted({path.parent / MANIFEST for path in files if path.name in BESIDE})
    return [
        Damage(
            str(manifest),
            "no list of checksums" if manifest.is_file() else "gone, or its job did not end",
            _rule(manifest.parent, Path(run)),
        )
        for manifest in manifests
        if not _lines(manifest)
    ]


def _rule(folder: Path, run: Path) -> str:
    """The rule whose job left something in ``<run>/[<replicate>/]<rule>/[<part>/]``."""
    top = next((parent for parent in folder.parents if (parent / "run.json").is_file()), run)
    parts = folder.relative_to(top).parts if folder.is_relative_to(top) else ()
    return next((part for part in parts if not part.isdigit()), folder.name)


def _recorded(path: Path) -> set[str]:
    """The checksums of a product in the manifests of jobs that wrote it; none if no job did.

    More than one if another configuration had it written by another rule, whose manifest is still there.
    """
    # A job's log lies beside its products or one folder above; what is shown at the top of a run, in its stage's folder.
    beside = _named([folder / MANIFEST for folder in (path.parent, path.parent.parent)], path)
    return beside or _named(_of_stages(path, MANIFEST), path)


def _of_stages(path: Path, name: str) -> list[Path]:
    """Files of that name which the jobs left that may have written a product at the top of a run, or a folder below."""
    folders, stages = (path.parent, path.parent.parent), ("[0-9]*/*", "*")
    return [found for folder in folders for stage in stages for found in folder.glob(f"{stage}/{name}")]


def _unvouched(path: Path) -> str:
    """Why a file that no manifest names may be damaged all the same; empty if no job wrote it.

    A job leaves its cost after its manifest: where there is a cost and no manifest to read, this was damaged.
    """
    if (path.parent / cost.FILE).is_file():
        return f"{path.parent / MANIFEST} does not name it"
    jobs = [path.parent.parent / cost.FILE, *_of_stages(path, cost.FILE)]
    lost = [job.parent / MANIFEST for job in jobs if job.is_file() and not _lines(job.parent / MANIFEST)]
    return f"{lost[0]} is gone or no list of checksums" if lost else ""


def _named(manifests: Iterable[Path], path: Path) -> set[str]:
    return {
        expected
        for manifest in manifests
        for name, expected in _lines(manifest)
        if name == os.path.relpath(path, manifest.parent)
    }


def _lines(manifest: Path) -> list[tuple[str, str]]:
    """Path from the manifest's folder and checksum of every product; none if it is gone, or any line is not as it was written."""
    lines = manifest.read_text(errors="replace").splitlines() if manifest.is_file() else []
    matches = [found for line in lines if (found := LINE.fullmatch(line))]
    return [(found[2], found[1]) for found in matches] if len(matches) == len(lines) else []
