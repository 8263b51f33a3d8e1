"""A copy of the project to run the DAG in, so that a test may edit, kill and rerun."""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PARTS = (
    "Snakefile",
    "workflow",
    "profiles",
    "config",
    "src",
    "examples",
    "tests/workflow/tiny.yaml",
    "README.md",
    "requirements.lock",
)
# Measured times differ from run to run, everything else must not.
MEASURED = ("cost.json", "log.txt", "timings.csv", "run.json")


@dataclass(frozen=True)
class Project:
    """A copy of the project in a folder of its own.

    Jobs import the checkout's own modules, whose kernels are compiled once for all tests (numba's cache goes by the path
    of the source); a dry run reads the copy's, which a test may have edited.
    """

    folder: Path

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "snakemake", *arguments]
        sources = self.folder if "--dry-run" in arguments else ROOT
        return subprocess.Popen(
            command,
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(sources / "src"), "NUMBA_CACHE_DIR": str(ROOT / ".snakemake/numba")},
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    def run(self, *arguments: str, fails: bool = False) -> str:
        """Run Snakemake to its end and return what it printed."""
        process = self.start(*arguments)
        output, _ = process.communicate(timeout=600)
        assert (process.returncode != 0) == fails, output[-6000:]
        return output

    def checksums(self, run: str = "tiny", skip: tuple[str, ...] = ()) -> dict[str, str]:
        """SHA-256 of every data file of a run."""
        base = self.folder / "results" / run
        files = [path for path in base.rglob("*") if path.is_file() and path.name not in MEASURED]
        kept = [path for path in files if path.suffix in {".parquet", ".nc", ".csv", ".json", ".safetensors"}]
        return {
            str(path.relative_to(base)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(kept)
            if not any(part in path.parts for part in skip)
        }


def copy_project(folder: Path) -> Project:
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
        elif source.is_file():
            (folder / part).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, folder / part)
    return Project(folder)


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return copy_project(tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """A copy in which the tiny study has run to its end, once for all workers; tests that change it take a copy of it."""
    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent  # that of a worker lies inside the one of all
    project = Project(base / "finished")
    with open(base / "finished.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not project.folder.exists():
            copy_project(project.folder).run("--cores", "2", "--configfile", "tests/workflow/tiny.yaml")
    assert (project.folder / "results/tiny/run.json").exists(), "the tiny study has failed in another worker"
    return project


@pytest.fixture
def finished_copy(finished: Project, tmp_path: Path) -> Project:
    """A private copy of the finished run, with its times of modification."""
    shutil.copytree(finished.folder, tmp_path / "copy", copy_function=shutil.copy2)
    return Project(tmp_path / "copy")
