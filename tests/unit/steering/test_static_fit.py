import numpy as np
import pytest

from walklab.errors import InputError
from walklab.steering.space import space_from_config
from walklab.steering.static_fit import fit_static
from walklab.steering.suitability import score_walks

SPACE = space_from_config(
    [
        {"name": "v", "unit": "m/s", "start": 0.2, "step": 0.4, "count": 5},
        {"name": "a", "unit": "m/s2", "start": 0.2, "step": 0.6, "count": 5},
    ]
)


@pytest.fixture(scope="module")
def routes():
    return [np.array([[0.0, 0.0], [length, 0.0], [length, 1.0]]) for length in (1.0, 2.0, 3.0)]


def test_the_parameters_of_the_walks_are_recovered(point_mass, packer, routes):
    # Every walk made with the same parameters, between the cells of the grid.
    batch = packer(point_mass, routes, [(1.13, 0.71)] * 3)
    fit = fit_static(point_mass, batch, SPACE, np.random.default_rng(0), maxfun=1500)
    assert fit.names == ("v", "a")
    assert fit.optimum == pytest.approx((1.13, 0.71), abs=0.01)
    assert fit.value < 0.005
    assert fit.on_edge == ()
    scores = score_walks(point_mass, batch, SPACE.cells).mean(axis=0)
    assert fit.grid_value == pytest.approx(scores.min())
    assert fit.grid_optimum == tuple(SPACE.cells[scores.argmin()])
    assert fit.value < fit.grid_value


def test_the_value_is_the_mean_over_walks_and_weights_shift_it(point_mass, packer, routes):
    batch = packer(point_mass, routes, [(0.6, 1.0), (1.5, 1.0), (1.5, 1.0)])
    rng = np.random.default_rng
    even = fit_static(point_mass, batch, SPACE, rng(0), maxfun=400)
    assert even.value == pytest.approx(score_walks(point_mass, batch, np.array([even.optimum])).mean())
    slow = fit_static(point_mass, batch, SPACE, rng(0), weights=[20.0, 1.0, 1.0], maxfun=400)
    assert slow.optimum[0] < even.optimum[0] - 0.3


def test_an_optimum_on_the_border_is_reported(point_mass, packer, routes):
    batch = packer(point_mass, routes, [(3.0, 1.0)] * 3)
    fit = fit_static(point_mass, batch, SPACE, np.random.default_rng(1), maxfun=600)
    assert "v" in fit.on_edge
    assert fit.optimum[0] == pytest.approx(1.8)


def test_same_generator_same_fit_and_the_best_start_counts(point_mass, packer, routes):
    batch = packer(point_mass, routes, [(0.9, 1.1), (1.2, 1.4), (1.0, 0.8)])
    scores = score_walks(point_mass, batch, SPACE.cells)
    first, second = (
        fit_static(point_mass, batch, SPACE, np.random.default_rng(3), scores=scores, starts=3, maxfun=100) for _ in range(2)
    )
    assert first == second
    assert len(first.start_values) == 3
    assert first.value == min(first.start_values)
    assert first.check_values == ()


def test_differential_evolution_cross_checks_the_annealing(point_mass, packer, routes):
    batch = packer(point_mass, routes, [(0.9, 1.1), (1.2, 1.4), (1.0, 0.8)])
    alone, checked = (
        fit_static(point_mass, batch, SPACE, np.random.default_rng(3), starts=2, maxfun=600, checks=checks) for checks in (0, 2)
    )
    assert checked.optimum == alone.optimum  # a check changes nothing
    assert checked.check_values == pytest.approx([checked.value] * 2, rel=1e-3)
    assert max(checked.spread) < 0.02
    poor = fit_static(point_mass, batch, SPACE, np.random.default_rng(3), maxfun=3, checks=1)  # what it is there to tell
    assert poor.check_values[0] < poor.value * 0.99
    assert max(poor.spread) > 0.05


def test_parameters_that_the_planner_does_not_know_are_refused(point_mass, packer, routes):
    batch = packer(point_mass, routes, [(1.0, 1.0)] * 3)
    with pytest.raises(InputError, match="not the planner's parameters v, a"):
        fit_static(point_mass, batch, SPACE.without("a"), np.random.default_rng(0))
    with pytest.raises(InputError, match="do not fit 3 walks"):
        fit_static(point_mass, batch, SPACE, np.random.default_rng(0), scores=np.zeros((2, 25)))
