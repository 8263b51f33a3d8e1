"""A digest changes with the code a script reaches, and with nothing else."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

SCRIPT = "import numpy\nfrom adapter import job\nfrom walklab.steering import space\n"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "workflow/scripts", tmp_path / "scripts", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "scripts/probe.py").write_text(SCRIPT)
    return tmp_path


def digest(project: Path) -> str:
    # A fresh process per digest: import graphs are cached within one.
    source = "import sys; from walklab.code_digest import digest; print(digest(*sys.argv[1:]))"
    arguments = [sys.executable, "-c", source, str(project / "scripts/probe.py"), str(project / "src/walklab")]
    return subprocess.run(
        arguments, capture_output=True, text=True, check=True, env={"PYTHONPATH": str(project / "src")}
    ).stdout.strip()


def append(path: Path, text: str) -> None:
    path.write_text(path.read_text() + text)


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("src/walklab/steering/space.py", "\nEXTRA = 1\n"),  # imported directly
        ("src/walklab/errors.py", "\nEXTRA = 1\n"),  # imported by what is imported
        ("src/walklab/steering/__init__.py", "\nEXTRA = 1\n"),  # runs on import
        ("scripts/adapter.py", "\nEXTRA = 1\n"),
        ("scripts/probe.py", "\nEXTRA = 1\n"),
    ],
)
def test_an_edit_of_reached_code_changes_the_digest(project, file, text):
    before = digest(project)
    append(project / file, text)
    assert digest(project) != before


def test_comments_docstrings_and_other_modules_leave_the_digest_alone(project):
    before = digest(project)
    append(project / "src/walklab/steering/space.py", "\n# a comment\n")
    space = project / "src/walklab/steering/space.py"
    space.write_text(space.read_text().replace('"""The discretised', '"""A discretised', 1))
    append(project / "src/walklab/geometry/curves.py", "\nEXTRA = 1\n")
    assert digest(project) == before
