"""What the tests of faults share: the part of the study they run, what it must leave, and the count of what was survived."""

from __future__ import annotations

import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tally import Tally, keep

from walklab.runs import checksums
from walklab.runs.record import commit

ROOT = Path(__file__).parents[3]
CONFIGURATION = ("--configfile", "tests/workflow/tiny.yaml")
# The chain from the first stage to the model: every kind of file, and jobs of all lengths.
STAGES = (
    "draw_participants",
    "record_training",
    "extract_training",
    "plan_training",
    "score_maps",
    "build_space",
    "train_model",
)
PATIENCE_S = 600


@pytest.fixture(scope="session")
def tally() -> Iterator[Tally]:
    """Written to results/bench/faults.json at the end."""
    tally = Tally()
    yield tally
    keep(tally.counts, ROOT / "results/bench/faults.json", commit(ROOT))


@dataclass(frozen=True)
class Study:
    """The study of a project as far as the model, or whole, and what it leaves if nothing disturbs it."""

    project: Any
    undisturbed: dict[str, str]
    whole: bool = False

    @property
    def arguments(self) -> tuple[str, ...]:
        return ("--cores", "2", *CONFIGURATION, *(() if self.whole else ("--until", STAGES[-1])))

    @property
    def results(self) -> Path:
        return self.project.folder / "results/tiny"

    def start(self) -> subprocess.Popen[str]:
        return self.project.start(*self.arguments)

    def run(self, *more: str, fails: bool = False) -> str:
        return self.project.run(*self.arguments, *more, fails=fails)

    def unlock(self) -> None:
        self.project.run("--unlock", *CONFIGURATION)

    def finished_jobs(self) -> int:
        return len(list(self.results.rglob(checksums.MANIFEST)))

    def wait_for_jobs(self, process: subprocess.Popen[str], count: int) -> bool:
        """Wait until that many jobs have ended; False if the run ended before."""
        return wait(lambda: self.finished_jobs() >= count or process.poll() is not None) and process.poll() is None

    def remove(self, *stages: str) -> None:
        """Take the products of stages away, so that they are made again."""
        for stage in stages:
            for path in (self.results / "0" / stage).rglob("*"):
                if path.is_file():
                    path.unlink()

    def products(self) -> dict[str, str]:
        files = self.project.checksums()
        return files if self.whole else chain(files)

    def assert_whole(self) -> None:
        """Whatever stands under a product's name is what an undisturbed run writes there."""
        wrong = {name for name, found in self.products().items() if self.undisturbed[name] != found}
        assert not wrong, f"half-written: {wrong}"

    def assert_undisturbed(self) -> None:
        """All products are there, as an undisturbed run leaves them, and nothing else."""
        assert self.products() == self.undisturbed
        found = checksums.inspect(self.results)
        assert not found.damaged
        assert not found.half_written
        if self.whole:
            assert all((self.results / name).is_file() for name in ("report.html", "report.pdf", "run.json"))


def chain(files: dict[str, str]) -> dict[str, str]:
    """The files of the stages that are run."""
    return {name: found for name, found in files.items() if not set(STAGES).isdisjoint(Path(name).parts)}


@pytest.fixture
def study(project: Any, finished: Any) -> Study:
    """Nothing has been computed yet."""
    return Study(project, chain(finished.checksums()))


@pytest.fixture
def whole_study(project: Any, finished: Any) -> Study:
    """Nothing has been computed yet, and all of the study is going to be: evaluation, figures and report, too."""
    return Study(project, finished.checksums(), whole=True)


@pytest.fixture
def done(finished_copy: Any, finished: Any) -> Study:
    """The chain has been computed, and nothing after it; a test takes away what it wants to see made again.

    Snakemake does not miss an intermediate file while what was made from it is there.
    """
    study = Study(finished_copy, chain(finished.checksums()))
    for path in (*study.results.iterdir(), *(study.results / "0").iterdir()):
        if path.name not in {"0", *STAGES}:
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    return study


def wait(condition: Callable[[], bool], patience_s: float = PATIENCE_S) -> bool:
    """Wait until something holds; False if it never does."""
    deadline = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.05)
    return True


@pytest.fixture
def wait_until() -> Callable[[Callable[[], bool]], bool]:
    """Waits until something holds; False if it never does."""
    return wait
