"""Reading the record of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from walklab.errors import InputError
from walklab.storage import read_json

# What a record must have, and what it may: key -> kind of value. A commit is null where there is no git.
NEEDED: dict[str, tuple[type, ...]] = {
    "run": (str,),
    "config": (dict,),
    "commit": (dict, type(None)),
    "versions": (dict,),
    "stages": (list,),
}
OPTIONAL: dict[str, tuple[type, ...]] = {"claims": (list,), "scores": (list,), "code": (dict,), "products": (dict,)}


def read_record(run: str | Path) -> dict[str, Any]:
    """The record of a run, given its folder or its ``run.json``.

    Raises
    ------
    InputError
        If there is none, or it is no record.
    """
    path = Path(run) / "run.json" if Path(run).is_dir() else Path(run)
    if not path.is_file():
        raise InputError(f"{path}: no such record; name the folder of a finished run, such as results/steering")
    found = read_json(path)
    missing = [name for name in NEEDED if not isinstance(found, dict) or name not in found]
    if missing:
        raise InputError(f"{path}: not the record of a run (it lacks {missing[0]}); run the study again")
    for name, kinds in (NEEDED | OPTIONAL).items():
        value = found.get(name, kinds[0]())
        if not isinstance(value, kinds) or (isinstance(value, list) and not all(isinstance(row, dict) for row in value)):
            raise InputError(f"{path}: damaged, {name} is not what a record has there; run the study again")
    return found
