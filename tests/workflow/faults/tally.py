"""How often each fault was tried and survived, and of which commit these counts are."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from walklab.storage import read_json, write_json

Counts = dict[str, dict[str, int]]
COMMIT = "commit"


@dataclass
class Tally:
    """Counts of faults; a fault that is tried and never survived has made its test fail."""

    counts: Counts = field(default_factory=dict)

    def tried(self, fault: str) -> None:
        """Count an attempt, before it is known how it ends."""
        self.counts.setdefault(fault, {"tried": 0, "survived": 0})["tried"] += 1

    def survived(self, fault: str, times: int = 1) -> None:
        """Count attempts after which everything was as it should be."""
        self.counts[fault]["survived"] += times

    @contextmanager
    def attempt(self, fault: str) -> Iterator[None]:
        """One attempt; it is survived if the block ends without an exception."""
        self.tried(fault)
        yield
        self.survived(fault)


def keep(counts: Counts, path: Path, commit: Mapping[str, Any]) -> None:
    """Write counts to a file; faults that were not tried this time keep their count if it is of the same commit.

    The file has an entry per fault, ``{"tried": ..., "survived": ...}``, and ``commit``: its id and whether files differed
    from it.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path.with_suffix(".lock"), "w") as lock:  # other workers may write at the same time
        fcntl.flock(lock, fcntl.LOCK_EX)
        known = read_json(path) if path.exists() else {}
        same = COMMIT in known and known.pop(COMMIT) == commit
        faults = (known if same else {}) | counts
        write_json({COMMIT: dict(commit), **dict(sorted(faults.items()))}, path)
