import numpy as np
import pytest

from walklab.errors import InputError
from walklab.geometry.standing import Standing
from walklab.steering.metrics import METRICS, euclid, frechet, metric_named, travel_time


def straight(speed_m_s, step_s, frames):
    return np.column_stack([speed_m_s * step_s * np.arange(frames), np.zeros(frames)])


def test_every_metric_is_zero_for_the_same_walk_and_gives_one_value_per_simulation():
    walk = straight(1.0, 1 / 60, 121)
    for metric in METRICS.values():
        scores = metric(walk, np.stack([walk, walk + np.array([0.0, 0.5]), walk * [0.5, 1]]), 1 / 60, 2.0)
        assert scores.shape == (3,)
        assert scores[0] == 0
        assert np.all(scores >= 0)


def test_euclid_of_a_sidestep_is_its_width_times_the_duration_over_the_length():
    walk = straight(1.0, 0.1, 20)
    assert euclid(walk, (walk + np.array([0.0, 0.3]))[None], 0.1, 1.9) == pytest.approx(0.3 * 20 * 0.1 / 1.9)


@pytest.mark.parametrize("rate", [30, 60, 120, 240])
def test_euclid_does_not_depend_on_the_rate(rate):
    # Two walks at 1.0 and 1.2 m/s for 2 s: integral of 0.2 t dt = 0.4 m s, over 2 m.
    frames = 2 * rate + 1
    score = euclid(straight(1.0, 1 / rate, frames), straight(1.2, 1 / rate, frames)[None], 1 / rate, 2.0)
    assert score[0] == pytest.approx(0.2, rel=1.1 / rate)


def recursive_frechet(first, second):
    gap = np.hypot(*(first[:, None] - second[None]).transpose(2, 0, 1))

    def reach(i, j):
        if i == 0 and j == 0:
            return gap[0, 0]
        before = [reach(*p) for p in ((i - 1, j), (i, j - 1), (i - 1, j - 1)) if min(p) >= 0]
        return max(gap[i, j], min(before))

    return reach(len(first) - 1, len(second) - 1)


def test_frechet_equals_its_recursive_definition():
    rng = np.random.default_rng(0)
    captured, simulated = rng.random((6, 2)), rng.random((4, 5, 2))
    assert frechet(captured, simulated, 1.0, 1.0) == pytest.approx([recursive_frechet(captured, walk) for walk in simulated])


def test_travel_time_sees_only_the_moving_part():
    def standing_before_and_after(frames):
        return np.concatenate(
            [np.zeros((30, 2)), straight(1.0, 0.01, frames), np.repeat(straight(1.0, 0.01, frames)[-1:], 200, 0)]
        )

    captured, simulated = standing_before_and_after(200)[:400], standing_before_and_after(150)[:400]
    assert travel_time(captured, simulated[None], 0.01, 1.0)[0] == pytest.approx(0.5)


def test_travel_time_is_measured_by_the_given_standing_speed():
    # Ten seconds of creeping at 0.1 m/s before one of walking: creeping is standing only above that speed.
    creep = np.concatenate([straight(0.1, 0.01, 1000), 1.0 + straight(1.0, 0.01, 101) * [1, 0] - [0, 1.0]])
    still = np.repeat(creep[-1:] * 0, len(creep), axis=0)
    low, high = (metric_named("travel_time", Standing(speed))(still, creep[None], 0.01, 1.0)[0] for speed in (0.05, 0.2))
    assert low == pytest.approx(11.0, abs=0.1)
    assert high == pytest.approx(1.0, abs=0.1)
    assert metric_named("travel_time", Standing(0.2)).name == "travel_time"
    assert metric_named("euclid", Standing(0.2)) is METRICS["euclid"]


def test_an_unknown_metric_is_named():
    with pytest.raises(InputError, match="hausdorff"):
        metric_named("hausdorff")
