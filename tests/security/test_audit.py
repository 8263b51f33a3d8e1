"""What the audit makes of the answers of pip-audit, and that it asks about every lock file."""

import json
import subprocess
from pathlib import Path

import pytest
from loading import module_at

ROOT = Path(__file__).parents[2]

audit = module_at(ROOT / "workflow/audit.py")

SAFE = {"name": "a", "version": "1", "vulns": []}
HOLE = {"name": "b", "version": "2", "vulns": [{"id": "ADVISORY-1"}]}
UNKNOWN = {"name": "c", "skip_reason": "not found"}


def answering(folder: Path, answer, code: int) -> Path:
    """A program that answers like pip-audit; None: it reaches nobody."""
    program = folder / "pip-audit"
    written = "" if answer is None else json.dumps({"dependencies": answer, "fixes": []})
    program.write_text(f"""#!/bin/sh
while [ "$1" != --output ]; do shift; done
{f"echo '{written}' >$2" if written else ""}
echo "the service cannot be reached" >&2
exit {code}
""")
    program.chmod(0o755)
    return program


@pytest.mark.parametrize(
    ("answer", "code", "expected", "told"),
    [
        ([SAFE], 0, 0, "no known hole"),
        ([SAFE, HOLE], 1, audit.HOLES, "known hole in b 2: ADVISORY-1"),
        ([SAFE, UNKNOWN], 0, audit.NOT_ASKED, "not audited: not found"),
        ([UNKNOWN, HOLE], 1, audit.HOLES, "known hole in b 2"),
        (None, 1, audit.NOT_ASKED, "not audited: the service cannot be reached"),
    ],
)
def test_a_hole_is_told_from_a_service_that_cannot_be_reached(answer, code, expected, told, tmp_path, capsys):
    assert audit.main(["some.lock"], answering(tmp_path, answer, code)) == expected
    assert f"some.lock: {told}" in capsys.readouterr().out


def test_a_service_that_is_too_slow_is_asked_once(tmp_path, capsys):
    program = tmp_path / "pip-audit"
    program.write_text(f"#!/bin/sh\necho asked >>{tmp_path}/asked\nexec sleep 60\n")
    program.chmod(0o755)
    assert audit.main(["a.lock", "b.lock"], program, patience_s=2) == audit.NOT_ASKED
    assert capsys.readouterr().out.count("not audited: no answer in time") == 2
    assert (tmp_path / "asked").read_text() == "asked\n"


def test_every_lock_file_is_audited():
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "*.lock"], capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        pytest.skip("not a git checkout")
    assert set(audit.LOCKS) == set(listed.stdout.split())
