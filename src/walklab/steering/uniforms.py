"""Uniform random numbers inside compiled loops.

Handing a numpy generator to compiled code costs more than drawing a sample. So the caller's generator gives one
seed per walk, and the numbers of that walk come from SplitMix64 (Steele, Lea & Flood 2014, "Fast splittable
pseudorandom number generators"): what a walk draws depends on its own generator and nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

State = NDArray[np.uint64]  # of length 1, changed in place

LARGEST_SEED = 1 << 63

_STRIDE = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_SCALE = 2.0**-53


def seeds_from(generators: Sequence[np.random.Generator]) -> State:
    """One seed from each generator, (W,)."""
    return np.array([generator.integers(LARGEST_SEED) for generator in generators], dtype=np.uint64)


@njit(cache=True, nogil=True)
def uniform(state: State) -> float:
    """The next number, uniform in [0, 1)."""
    state[0] += _STRIDE
    z = state[0]
    z = (z ^ (z >> _30)) * _FIRST
    z = (z ^ (z >> _27)) * _SECOND
    return np.float64((z ^ (z >> _31)) >> _11) * _SCALE
