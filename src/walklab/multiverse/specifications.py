"""The specifications of the multiverse: the default, one change at a time, and random combinations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from walklab.capture.ranges import RANGES
from walklab.errors import InputError
from walklab.multiverse.choices import READINGS, Choices

DEFAULT, CHOICE, CONSTANT, COMBINATION = "default", "choice", "constant", "combination"
ENDS = {"low": 0.0, "high": 1.0}


@dataclass(frozen=True)
class Specification:
    """One way to run the study.

    Attributes
    ----------
    name, kind : unique name; default, choice, constant or combination
    choices : what the paper leaves open
    positions : uncertainty of the generator -> place in its range, 0 to 1; what is not named has the generator's own value
    """

    name: str
    kind: str
    choices: Choices
    positions: Mapping[str, float] = field(default_factory=dict)

    def changed(self, baseline: Choices) -> str:
        """In words what differs from the default."""
        words = [f"{name}: {value}" for name, value in self.choices.differences(baseline).items()]
        return "; ".join([*words, *(f"{name}: {place:.2f} of its range" for name, place in self.positions.items())])


def specifications(
    baseline: Choices, combinations: int, rng: np.random.Generator, vary: Sequence[str] | None = None
) -> list[Specification]:
    """All specifications, in the order of the tables.

    One at a time: every other reading of each ambiguity, both ends of the range of each uncertain constant. A combination
    draws a reading of each ambiguity and a place in each range, all uniformly.

    Parameters
    ----------
    vary : names of ambiguities and uncertainties; default all

    Raises
    ------
    InputError
        If a name is unknown.
    """
    names = [*READINGS, *RANGES] if vary is None else list(vary)
    if unknown := [name for name in names if name not in READINGS and name not in RANGES]:
        raise InputError(f"multiverse.vary: there is no {unknown[0]!r}; choose from {', '.join([*READINGS, *RANGES])}")
    found = [Specification("default", DEFAULT, baseline)]
    choices, ranges = [name for name in READINGS if name in names], [name for name in RANGES if name in names]
    for name in choices:
        for value in READINGS[name].values:
            if value != getattr(baseline, name):
                label = ("no", "yes")[value] if isinstance(value, bool) else value
                found.append(Specification(f"{name}-{label}", CHOICE, baseline.with_values({name: value})))
    found += [Specification(f"{name}-{end}", CONSTANT, baseline, {name: place}) for name in ranges for end, place in ENDS.items()]
    for number in range(combinations):
        drawn = {name: READINGS[name].combined[rng.integers(len(READINGS[name].combined))] for name in choices}
        places = {name: float(np.round(rng.random(), 6)) for name in ranges}
        found.append(Specification(f"combination-{number:02d}", COMBINATION, baseline.with_values(drawn), places))
    return found
