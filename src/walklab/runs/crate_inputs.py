"""What a run read that no job of it made: plan views, walks and recordings, by name and SHA-256, never by content."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from walklab.capture.recording_files import present
from walklab.configuration import named_paths
from walklab.runs.checksums import sha256

GONE = "not there any more"


def inputs(config: Mapping[str, Any], root: str | Path, data: str | Path) -> dict[str, str]:
    """SHA-256 of each file that a run of this configuration reads, as the file is now; a file that is gone says so.

    Parameters
    ----------
    config : the completed configuration of the run
    root : the checkout, in which plan views are looked for that are not in the working folder
    data : WALKLAB_DATA; with a synthetic capture, the recordings there are what its realism is measured by

    Returns
    -------
    dict from the file's name to its SHA-256; names are as configured, or relative to the folder of the recordings, so that
    they tell nothing of the machine
    """
    found: dict[str, str] = {}
    for named in named_paths(config).values():
        found |= {name: sha256(path) if path.is_file() else GONE for name, path in _files(named, Path(root))}
    if config["source"]["kind"] == "synthetic":
        found |= {path.relative_to(data).as_posix(): sha256(path) for path in present(data)}
    return found


def data_folder() -> str:
    """WALKLAB_DATA, or a folder that is not there."""
    return os.environ.get("WALKLAB_DATA", "no recordings")


def _files(named: str, root: Path) -> Iterator[tuple[str, Path]]:
    path = Path(named) if Path(named).exists() else root / named
    if path.is_dir():
        yield from ((file.relative_to(path.parent).as_posix(), file) for file in sorted(path.rglob("*.a[sm][fc]")))
    else:
        yield (path.name if Path(named).is_absolute() else named), path
