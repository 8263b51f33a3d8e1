import numpy as np
import pytest

from walklab.capture.constants import WalkerConstants
from walklab.capture.sensor import coloured_noise, short_dropouts
from walklab.randomness import generator


@pytest.mark.parametrize("step_s", [1 / 120, 1 / 60])
def test_sway_has_its_size_and_its_speed_at_any_rate(step_s):
    sway = coloured_noise(400_000, 2, 0.003, 1.5, 0.3, step_s, generator(1))
    assert sway.std() == pytest.approx(0.003, rel=0.1)
    assert (np.diff(sway, axis=0) / step_s).std() == pytest.approx(0.003 / np.sqrt(1.5 * 0.3), rel=0.1)


def test_dropouts_come_at_the_stated_rate_and_length():
    constants = WalkerConstants()
    lost = short_dropouts(120 * 60 * 500, 1 / 120, constants, generator(2))
    gaps = np.flatnonzero(np.diff(lost.astype(int)) == 1).size
    assert gaps / 500 == pytest.approx(constants.dropouts_per_min, rel=0.15)
    assert lost.sum() / gaps / 120 == pytest.approx(np.mean(constants.dropout_s), rel=0.1)
