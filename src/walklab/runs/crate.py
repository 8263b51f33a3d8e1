"""A finished run as a Workflow Run RO-Crate: the workflow, what went in, what came out, in one zip with its description.

The profile: https://w3id.org/ro/wfrun/workflow/0.5. Captured walks and intermediate files are not part of a crate
(docs/privacy.md says why).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from walklab.errors import InputError
from walklab.runs.crate_inputs import data_folder, inputs
from walklab.runs.io import read_record
from walklab.runs.record import commit
from walklab.storage import atomic_path

PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
LICENSE = "https://spdx.org/licenses/MIT"
# What the workflow needs to run again, as `make` does.
WORKFLOW = (
    *("workflow", "config", "profiles", "src", "Makefile"),
    *("requirements.lock", "pyproject.toml", "README.md", "LICENSE", "CITATION.cff"),
)
PRODUCTS = ("*.csv", "*.json", "*.html", "*.pdf", "*.md", "*.safetensors", "figures/*", "tables/*.csv")
FORMATS = {
    ".csv": "text/csv",
    ".json": "application/json",
    ".html": "text/html",
    ".md": "text/markdown",
    ".pdf": "application/pdf",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".safetensors": "application/octet-stream",
    ".yaml": "application/yaml",
}


def write_crate(run: str | Path, root: str | Path, path: str | Path) -> int:
    """Write the crate of a finished run as a zip file.

    Parameters
    ----------
    run : the run's folder
    root : the checkout that it was made with
    path : the zip file to write

    Returns
    -------
    number of files of the run in the crate

    Raises
    ------
    InputError
        If there is no record, the checkout is at another commit than the run, or the package rocrate is not installed.
    """
    folder, root = Path(run), Path(root)
    record = read_record(folder)
    code = _code(folder, record["commit"], root)
    crate = _new_crate(record)
    workflow = crate.add_workflow(root / "Snakefile", "Snakefile", main=True, lang="snakemake", lang_version=_snakemake(record))
    workflow["name"] = "walklab"
    workflow["license"] = {"@id": LICENSE}
    workflow["version"] = record["commit"].get("id", "unknown")
    workflow["description"] = code
    for name in _tracked(root):
        crate.add_file(root / name, name, properties=_described(Path(name)))
    given = [*_configuration(crate, record), *_inputs(crate, record, root)]
    made = [
        crate.add_file(file, f"results/{file.relative_to(folder).as_posix()}", properties=_described(file))
        for file in _products(folder)
    ]
    crate.add_action(
        workflow,
        identifier=f"#{record['run']}-{record['commit'].get('id', 'unknown')[:12]}",
        object=given,
        result=made,
        properties={
            "name": f"walklab study {record['run']}",
            "endTime": record["recorded"],
            "actionStatus": {"@id": "http://schema.org/CompletedActionStatus"},
        },
    )
    with atomic_path(path) as temporary:
        crate.write_zip(temporary)
    return len(made)


def _code(folder: Path, ran: Mapping[str, Any], root: Path) -> str:
    """How the packed code relates to what ran: the commit, and whether files differed from it, then or now."""
    here = commit(root)
    if ran.get("id") != here.get("id"):
        made, found = (known.get("id", "no commit")[:12] for known in (ran, here))
        raise InputError(f"{folder}: made by {made}, but the checkout is at {found}; check that one out and name it with --root")
    if not here:
        return "Packed outside of git: whether this is the code that ran is not known."
    differed = [when for when, known in (("when the run was made", ran), ("when it was packed", here)) if known["dirty"]]
    same = f"The code of commit {here['id']}."
    return f"{same} Files differed from it {' and '.join(differed)}: this may not be all that ran." if differed else same


def _new_crate(record: Mapping[str, Any]) -> Any:
    try:
        from rocrate.model.contextentity import ContextEntity
        from rocrate.rocrate import ROCrate
    except ImportError:
        raise InputError("rocrate is not installed; use `make crate`, or install the extra walklab[tracking]") from None
    crate = ROCrate(version="1.1")
    crate.name = f"walklab study {record['run']}"
    crate.description = "What captured walks tell about steering: configuration, results and record of one run of walklab."
    crate.license = crate.add(ContextEntity(crate, LICENSE, {"@type": "CreativeWork", "name": "MIT License"}))
    profiles = [
        crate.add(ContextEntity(crate, address, {"@type": "CreativeWork", "name": name, "version": version}))
        for address, (name, version) in PROFILES.items()
    ]
    crate.root_dataset["conformsTo"] = profiles
    return crate


def _configuration(crate: Any, record: Mapping[str, Any]) -> list[Any]:
    """The completed configuration as a file of the crate, described as the run's input."""
    import io

    text = io.StringIO(json.dumps(record["config"], indent=2) + "\n")
    return [crate.add_file(text, "configuration.json", properties=_described(Path("configuration.json")))]


def _inputs(crate: Any, record: Mapping[str, Any], root: Path) -> list[Any]:
    """Plan views and recordings as names with checksums: recordings are of people, so they are not packed."""
    from rocrate.model.contextentity import ContextEntity

    return [
        crate.add(
            ContextEntity(
                crate, f"#input-{number}", {"@type": "PropertyValue", "name": name, "propertyID": "sha256", "value": checksum}
            )
        )
        for number, (name, checksum) in enumerate(inputs(record["config"], root, data_folder()).items())
    ]


def _tracked(root: Path) -> Iterator[str]:
    for name in WORKFLOW:
        source = root / name
        files = sorted(source.rglob("*")) if source.is_dir() else [source]
        yield from (file.relative_to(root).as_posix() for file in files if file.is_file() and not _made(file))


def _made(file: Path) -> bool:
    """Whether a file of the checkout came of installing or importing it."""
    return any(part == "__pycache__" or part.endswith(".egg-info") for part in file.parts)


def _products(folder: Path) -> list[Path]:
    found = {file for pattern in PRODUCTS for file in folder.glob(pattern)}
    return sorted(file for file in found if file.is_file())


def _described(file: Path) -> dict[str, str]:
    kind = FORMATS.get(file.suffix)
    return {"name": file.name, **({"encodingFormat": kind} if kind else {})}


def _snakemake(record: Mapping[str, Any]) -> str:
    return str(record["versions"].get("snakemake", ""))
