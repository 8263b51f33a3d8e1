"""Models with learned sharpness and a learned pace: draws follow their law, walkers their time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from walklab.errors import InputError
from walklab.geometry.scene import State, Task
from walklab.planning.path_following import PathFollowing
from walklab.steering.blending_space import blending_space
from walklab.steering.building import probabilistic_model
from walklab.steering.learned import CalibratedModel, ExtendedModel, Pace, ignoring
from walklab.steering.models import MotionModel
from walklab.steering.pace import PaceEffect, Trend
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.scaling import fit_scaling
from walklab.steering.sharpness import LADDER, SharpnessLaw
from walklab.steering.space import space_from_config

FLAT = Trend((0,), (False,), (0.0,), (1.0,), (-9.0,), (9.0,), 1, (0.0, 0.0))


def model(speed_unit: str = "m/s", acceleration_unit: str = "m/s²") -> ProbabilisticModel:
    axes = [
        {"name": "v", "unit": speed_unit, "start": 0.5, "step": 0.1, "count": 11},
        {"name": "a", "unit": acceleration_unit, "start": 0.4, "step": 0.2, "count": 6},
    ]
    space = space_from_config(axes)
    rng = np.random.default_rng(0)
    vectors = np.column_stack([rng.uniform(1, 4, 40), rng.uniform(1.6, 1.9, 40)])
    best = 0.7 + 0.15 * vectors[:, :1] + (vectors[:, 1:] - 1.75)
    maps = 1 - 0.5 * np.abs(space.cells[:, 0] - best)
    return probabilistic_model(blending_space(("length", "height"), ("m", "m"), vectors, maps, fit_scaling(vectors)), space, k=5)


def rngs(count: int) -> list[np.random.Generator]:
    return [np.random.default_rng(i) for i in range(count)]


def pace(effect: PaceEffect, trend: Trend = FLAT, rest_sd: float = 0.0) -> Pace:
    return Pace(40.0, (1,), trend, effect, rest_sd)


def test_law_gives_each_walk_the_exponent_of_its_dependencies() -> None:
    law = SharpnessLaw(8.0, 0, np.log(2), 2.0, 1.0)
    np.testing.assert_allclose(law.exponents([[2.0, 0], [3.0, 9], [0.0, 0], [99.0, 0]]), [8, 16, 2, LADDER[-1]])
    calibrated = CalibratedModel(model(), law)
    assert isinstance(calibrated, MotionModel)
    vectors = np.array([[1.5, 1.7], [3.0, 1.7], [1.5, 1.8]])
    drawn = calibrated.parameters(vectors, rngs(3))
    for row, exponent in enumerate(law.exponents(vectors)):
        alone = replace(calibrated.model, exponent=float(exponent)).parameters(vectors[row : row + 1], rngs(3)[row : row + 1])
        np.testing.assert_array_equal(drawn[row], alone[0])
    assert calibrated.sample([1.5, 1.7], 7, np.random.default_rng(0)).shape == (7, 2)
    with pytest.raises(ValueError, match="one random generator per walk"):
        calibrated.parameters(vectors)


def test_drawn_at_a_persons_pace_the_same_path_takes_exactly_so_much_longer() -> None:
    """(v / s, a / s^2, omega) walks the path of (v, a, omega) s times as slowly, turns included."""
    planner = PathFollowing(("v", "a", "omega"), 1 / 600)
    route = np.array([[0.0, 0.0], [2.0, 0.0], [2.5, 1.5]])
    task = Task(State((0.0, 0.0)), State((2.5, 1.5)))
    plain = planner.follow(route, task, np.array([1.2, 0.8, 3.0]), 60.0)
    for s in (0.8, 1.3):
        slow = planner.follow(route, task, np.array([1.2 / s, 0.8 / s**2, 3.0]), 60.0)
        assert slow.duration_s == pytest.approx(s * plain.duration_s, abs=0.02)
        middle = slow.positions_m[round(s * 1.0 * 600)]
        np.testing.assert_allclose(middle, plain.positions_m[600], atol=0.02)


def test_extended_draws_are_those_of_the_density_at_the_pace() -> None:
    known = ExtendedModel(model(), pace(PaceEffect(0.0, 0.1, 0.0)))
    assert isinstance(known, MotionModel)
    vector, draws = np.array([2.0, 1.7]), 4000
    fixed = known.sample(vector, draws, np.random.default_rng(1), (np.log(1.25), 0.0))
    bare = known.density_model().sample(vector, draws, np.random.default_rng(1))
    np.testing.assert_allclose(fixed, bare / [1.25, 1.25**2])
    # Somebody new: the logarithm of the pace is normal, or Student's t where few people told it.
    for people, law in ((None, stats.norm(0, 0.1)), (4, stats.t(3, 0, 0.1 * np.sqrt(5 / 4)))):
        new = replace(known, pace=pace(PaceEffect(0.0, 0.1, 0.0, people)))
        logs = np.log(bare[:, 0] / new.sample(vector, draws, np.random.default_rng(1))[:, 0])
        assert stats.kstest(logs, law.cdf).pvalue > 1e-3
    assert known.parameters([vector, vector], rngs(2)).shape == (2, 2)


def test_trend_slows_where_it_says() -> None:
    rising = replace(FLAT, coefficients=(0.1, 0.2))
    slow = ExtendedModel(model(), pace(PaceEffect(0.0, 0.0, 0.0), rising))
    drawn = slow.sample_batch(np.array([[2.0, 1.7]]), 5, rngs(1))
    bare = slow.density_model().sample_batch(np.array([[2.0, 1.7]]), 5, rngs(1))
    np.testing.assert_allclose(drawn[..., 0], bare[..., 0] / np.exp(0.5))


def test_ignored_dependency_changes_nothing() -> None:
    known = model()
    blind = ignoring(known, (1,))
    tall, short = blind.blend([[2.0, 1.9], [2.0, 1.6]])
    np.testing.assert_array_equal(tall, short)
    assert np.any(np.diff(known.blend([[2.0, 1.9], [2.0, 1.6]]), axis=0) != 0)
    np.testing.assert_array_equal(ignoring(known, ()).blend([[2.0, 1.9]]), known.blend([[2.0, 1.9]]))


def test_without_a_speed_there_is_no_pace() -> None:
    with pytest.raises(InputError, match="a pace means nothing"):
        ExtendedModel(model("1/m"), pace(PaceEffect(0.0, 0.1, 0.0))).sample([2.0, 1.7], 1)


@pytest.mark.parametrize("unit", ["m/s2", "m/s^2", "m s-2", " m/s² ", "m·s⁻²"])
def test_acceleration_follows_the_pace_however_its_unit_is_spelt(unit: str) -> None:
    known = ExtendedModel(model(acceleration_unit=unit), pace(PaceEffect(0.0, 0.1, 0.0)))
    assert known.model.units == ("m/s", "m/s²")
    drawn = known.sample([2.0, 1.7], 50, np.random.default_rng(1), (np.log(1.25), 0.0))
    bare = known.density_model().sample([2.0, 1.7], 50, np.random.default_rng(1))
    np.testing.assert_allclose(drawn, bare / [1.25, 1.25**2])


def test_a_relaxation_time_grows_with_the_time_of_the_walk() -> None:
    known = ExtendedModel(model(acceleration_unit="s"), pace(PaceEffect(0.0, 0.1, 0.0)))
    drawn = known.sample([2.0, 1.7], 50, np.random.default_rng(1), (np.log(1.25), 0.0))
    bare = known.density_model().sample([2.0, 1.7], 50, np.random.default_rng(1))
    np.testing.assert_allclose(drawn, bare / [1.25, 1 / 1.25])


@pytest.mark.parametrize("unit", ["furlong/fortnight2", "", "m/s³"])
def test_a_unit_that_is_not_known_is_refused_where_the_pace_needs_it(unit: str) -> None:
    known = ExtendedModel(model(acceleration_unit=unit), pace(PaceEffect(0.0, 0.1, 0.0)))
    known.density_model().sample([2.0, 1.7], 2)
    with pytest.raises(InputError, match=r"how a changes with the pace is unknown for its unit '.*'; give it in one of m/s"):
        known.sample([2.0, 1.7], 1)
