"""Ask a public advisory service about every package of every lock file (pip-audit); nothing is installed for it.

Exit code 1: a package has a known hole. 3: nothing found, but some packages could not be asked about. 0: all were asked about.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PIP_AUDIT = ROOT / ".venv/docs/bin/pip-audit"
LOCKS = ("requirements.lock", "requirements-tracking.lock", "docs/tools.lock", "tests/validator.lock", "benchmarks/peers.lock")
HOLES, NOT_ASKED = 1, 3
PATIENCE_S = 60  # for a lock file; a service that is slower holds up whoever waits for the audit
TOO_SLOW = "no answer in time"


def audit(lock, program=PIP_AUDIT, patience_s=PATIENCE_S):
    """Known holes of a lock file's packages, and why packages were not asked about; each a line."""
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.json"
        options = ("--disable-pip", "--require-hashes", "--progress-spinner", "off", "--format", "json", "--output", str(answer))
        command = [str(program), *options, "-r", str(lock)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=patience_s)
        except subprocess.TimeoutExpired:
            return [], [TOO_SLOW]
        # pip-audit ends with 1 for a hole and for a service that it cannot reach; only the first leaves an answer.
        if not answer.exists() or not answer.read_text().strip():
            return [], [(done.stderr.strip().splitlines() or ["no answer"])[-1]]
        packages = json.loads(answer.read_text())["dependencies"]
    holes = [f"{package['name']} {package['version']}: {hole['id']}" for package in packages for hole in package.get("vulns", [])]
    return holes, [package["skip_reason"] for package in packages if "skip_reason" in package]


def main(locks, program=PIP_AUDIT, patience_s=PATIENCE_S):
    """Audit lock files one after the other, until the service is too slow; the exit code."""
    code, slow = 0, False
    for lock in locks:
        holes, unasked = ([], [TOO_SLOW]) if slow else audit(lock, program, patience_s)
        slow = slow or TOO_SLOW in unasked
        name = Path(lock).relative_to(ROOT) if Path(lock).is_relative_to(ROOT) else lock
        for hole in holes:
            print(f"{name}: known hole in {hole}")
        if unasked:
            print(f"{name}: not audited: {unasked[0]}{f' (and {len(unasked) - 1} more)' if len(unasked) > 1 else ''}")
        if not holes and not unasked:
            print(f"{name}: no known hole")
        code = HOLES if holes or code == HOLES else NOT_ASKED if unasked else code
    return code


if __name__ == "__main__":
    sys.exit(main([ROOT / name for name in LOCKS]))
