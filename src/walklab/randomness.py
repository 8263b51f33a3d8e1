"""Random numbers that depend on what they are for, never on the order of the work."""

from __future__ import annotations

import zlib

import numpy as np


def seed_sequence(seed: int, *names: str | int) -> np.random.SeedSequence:
    """The child of the run's seed that belongs to the given names.

    A walk named in this way draws the same numbers whichever core, shard or order it
    is handled in. Strings enter by their CRC-32, which unlike ``hash`` is the same in
    every process.
    """
    keys = [zlib.crc32(name.encode()) if isinstance(name, str) else int(name) for name in names]
    return np.random.SeedSequence(seed, spawn_key=tuple(keys))


def generator(seed: int, *names: str | int) -> np.random.Generator:
    """A generator for the given names, e.g. ``generator(seed, replicate, "trial", walk)``."""
    return np.random.default_rng(seed_sequence(seed, *names))
