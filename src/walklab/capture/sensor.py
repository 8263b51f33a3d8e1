"""What stands between a person and a recording: standing sway, measurement noise and dropouts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from walklab.capture.constants import WalkerConstants

Array = NDArray[np.float64]


def coloured_noise(
    count: int, columns: int, sd: float, slow_s: float, fast_s: float, step_s: float, rng: np.random.Generator
) -> Array:
    """Two cascaded first-order low passes of white noise, scaled to a standard deviation, (count, columns) array.

    The result has a velocity of about ``sd / sqrt(slow_s * fast_s)``, as smooth sway has.
    """
    warm_up = int(np.ceil(8 * slow_s / step_s))
    white = rng.standard_normal((count + warm_up, columns))
    if sd == 0:
        return np.zeros((count, columns))
    poles = np.exp(-step_s / np.array([slow_s, fast_s]))
    shaped = lfilter([1.0], np.convolve([1, -poles[0]], [1, -poles[1]]), white, axis=0)[warm_up:]
    a, b = poles
    gain = np.sqrt((1 + a * b) / ((1 - a**2) * (1 - b**2) * (1 - a * b)))
    return shaped * (sd / gain)


def standing_sway(count: int, step_s: float, constants: WalkerConstants, rng: np.random.Generator) -> Array:
    """Sway of the centre of mass of a standing person, (count, 2) array, metres."""
    slow, fast = constants.standing_sway_slow_s, constants.standing_sway_fast_s
    return coloured_noise(count, 2, constants.standing_sway_m, slow, fast, step_s, rng)


def short_dropouts(count: int, step_s: float, constants: WalkerConstants, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Frames that the sensor misses here and there, (count,) mask."""
    lost = np.zeros(count, dtype=bool)
    for _ in range(rng.poisson(constants.dropouts_per_min * count * step_s / 60)):
        first = int(rng.integers(count))
        lost[first : first + max(1, round(rng.uniform(*constants.dropout_s) / step_s))] = True
    lost[0] = False
    return lost
