"""What a row of the table of speeds consists of: our work, and a baseline that is measured in the same run."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

Action = Callable[[], object]


@dataclass(frozen=True)
class Work:
    """Work that is ready to be timed.

    Attributes
    ----------
    ours : one round of our work
    units : agent-steps, samples or queries that one round does
    unit : of the row
    baseline_s : measures one unit of the baseline, seconds; None where the row has no baseline
    baseline_name : what it is
    factor : from seconds to the unit of the row
    rounds : of our work, the fastest of which counts
    """

    ours: Action
    units: float
    unit: str
    baseline_s: Callable[[], float] | None = None
    baseline_name: str = ""
    factor: float = 1.0
    rounds: int = 15


@dataclass(frozen=True)
class Case:
    """A benchmark: the key of its row, its variant (the slowest of which counts), and how its work is made ready.

    CPU time counts, which the load of the machine hardly changes; wall time (``wall``) where several cores work.
    """

    key: str
    prepare: Callable[[], Work]
    variant: str = ""
    wall: bool = False


def least_s(action: Action, units: float = 1, rounds: int = 5) -> float:
    """Least CPU seconds a unit of some rounds; the first, which may compile, does not count."""
    action()
    times = []
    for _ in range(rounds):
        start = time.process_time()
        action()
        times.append((time.process_time() - start) / units)
    return min(times)
