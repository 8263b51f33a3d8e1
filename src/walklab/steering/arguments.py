"""What callers ask a motion model for, checked: every mistake ends in one line."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError

Array = NDArray[np.float64]

# Dependencies that cannot be below zero. Not read from walklab.steering.dependencies: a process that only samples has no pandas.
NON_NEGATIVE = ("length", "curvature", "height", "start_speed")


LARGEST = 1e12  # of a dependency, far beyond any walk; squares of what is much larger overflow in the neighbour search


def as_numbers(vectors: ArrayLike, names: Sequence[str]) -> Array:
    """Dependencies as an array of numbers; InputError if one is something else."""
    try:
        return np.asarray(vectors, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"dependencies {', '.join(names)}: {vectors!r} is not all numbers ({error})") from None


def check_values(vectors: Array, names: Sequence[str]) -> None:
    """InputError if a value of (W, D) dependency vectors is not finite, or negative where that means nothing."""
    if not (np.abs(vectors) <= LARGEST).all():
        row, column = np.argwhere(~(np.abs(vectors) <= LARGEST))[0]
        raise InputError(
            f"dependency vectors: row {row}, {names[column]} is {vectors[row, column]}; give a finite number up to {LARGEST:g}"
        )
    for column, name in enumerate(names):
        if name in NON_NEGATIVE and (negative := np.flatnonzero(vectors[:, column] < 0)).size:
            row = negative[0]
            raise InputError(f"dependency vectors: row {row}, {name} is {vectors[row, column]:g}; it cannot be below 0")


def count_of(size: int) -> int:
    """How many to draw; InputError if that is no count."""
    if type(size) is int and size >= 0:  # nearly always, and the abstract class below takes a while
        return size
    if isinstance(size, bool) or not isinstance(size, Integral) or size < 0:
        raise InputError(f"size = {size!r}: give how many to draw, a whole number of at least 0")
    return int(size)


def generator_of(rng: np.random.Generator | None) -> np.random.Generator:
    """The generator given, or a fresh one; InputError if it is something else."""
    if rng is not None and not isinstance(rng, np.random.Generator):
        raise InputError(f"rng = {rng!r}: give a numpy generator, such as numpy.random.default_rng(1), or None")
    return np.random.default_rng() if rng is None else rng
