"""Uniform random numbers inside compiled loops.

Handing a numpy generator to compiled code costs as much as drawing a sample. So the caller's generator gives one
number per walk as its seed, and the numbers of that walk come from SplitMix64 (Steele, Lea & Flood 2014, "Fast splittable
pseudorandom number generators"): what a walk draws depends on its own generator and nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
State = NDArray[np.uint64]  # of length 1, changed in place

_STRIDE = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_SCALE = 2.0**-53


def seeds_from(generators: Sequence[np.random.Generator]) -> Array:
    """One seed from each generator, (W,), uniform in [0, 1)."""
    return np.array([generator.random() for generator in generators], dtype=float)


@njit(cache=True, nogil=True)
def start(state: State, seed: float) -> None:
    """Begin the numbers of a seed: all of its 53 bits count."""
    state[0] = np.uint64(seed * 2.0**53)


@njit(cache=True, nogil=True)
def uniform(state: State) -> float:
    """The next number, uniform in [0, 1)."""
    state[0] += _STRIDE
    z = state[0]
    z = (z ^ (z >> _30)) * _FIRST
    z = (z ^ (z >> _27)) * _SECOND
    return np.float64((z ^ (z >> _31)) >> _11) * _SCALE
