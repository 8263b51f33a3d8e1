"""Samples against the densities they are drawn from, for both bases, literal and sharpened."""

import dataclasses

import numpy as np
import pytest
from scipy import stats

from walklab.errors import InputError
from walklab.steering import sampling
from walklab.steering.blending_space import blending_space
from walklab.steering.interpolation import interpolant_named
from walklab.steering.models import probabilistic_model
from walklab.steering.proposals import pick
from walklab.steering.scaling import fit_scaling
from walklab.steering.space import space_from_config
from walklab.steering.uniforms import start, uniform

BASES = ["rbf", "multilinear"]
EXPONENTS = [1.0, 30.0]
ASKED = np.array([0.4, 0.6])

pytestmark = pytest.mark.filterwarnings("ignore::walklab.OutsideTrainingRange")
AXES = [
    {"name": "v", "unit": "m/s", "start": 0.1, "step": 0.3, "count": 6},
    {"name": "a", "unit": "m/s2", "values": [0.2, 0.5, 1, 3]},  # uneven: steps are not the parameter's units
]


def two_peaks(space, shifts):
    """Maps with two peaks, cut to zero below 0.2 so that the radial basis functions undershoot and are clipped."""
    v, a = space.cells.T
    values = np.array(
        [np.exp(-((v - 0.5 - s) ** 2) / 0.1) + 0.7 * np.exp(-((v - 1.4) ** 2) / 0.2 - (a - 2.5 + s) ** 2) for s in shifts]
    )
    values[values < 0.2] = 0.0
    return values / values.max(axis=1, keepdims=True)


def known(basis, exponent, **settings):
    """A model of 40 entries that blends 12 maps."""
    space = space_from_config(AXES)
    rng = np.random.default_rng(8)
    vectors = rng.random((40, 2))
    blending = blending_space(("x", "y"), ("", ""), vectors, two_peaks(space, 0.5 * vectors[:, 0]), fit_scaling(vectors))
    model = probabilistic_model(blending, space, interpolant_named(basis, space.shape), k=12)
    return dataclasses.replace(model, exponent=exponent, **settings)


def mass_of_bins(model, bins, per_bin=20):
    """Probability of each of bins x bins equal parts of the box of parameters, by the midpoint rule."""
    low, high = model.space.bounds.T
    n = bins * per_bin
    middles = [low[i] + (high[i] - low[i]) * (np.arange(n) + 0.5) / n for i in (0, 1)]
    points = np.stack(np.meshgrid(*middles, indexing="ij"), -1).reshape(-1, 2)
    mass = model.density(ASKED, points).reshape(bins, per_bin, bins, per_bin).sum((1, 3))
    return mass / mass.sum()


def chi_square(model, samples, bins=12):
    """p-value of the samples being from the model's density; bins where fewer than 5 are expected are pooled."""
    edges = [np.linspace(*model.space.bounds[i], bins + 1) for i in (0, 1)]
    counts = np.histogram2d(*samples.T, bins=edges)[0].ravel()
    assert counts.sum() == len(samples)
    expected = mass_of_bins(model, bins).ravel() * len(samples)
    rare = expected < 5
    observed, wanted = np.append(counts[~rare], counts[rare].sum()), np.append(expected[~rare], expected[rare].sum())
    if wanted[-1] < 5:
        assert observed[-1] < 20
        observed, wanted = observed[:-1], wanted[:-1] * observed[:-1].sum() / wanted[:-1].sum()
    return stats.chisquare(observed, wanted).pvalue


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("basis", BASES)
def test_samples_follow_the_density(basis, exponent):
    model = known(basis, exponent)
    rng = np.random.default_rng(0)
    at_once = model.sample(ASKED, 20_000, rng)  # many of one walk
    singly = model.parameters(np.tile(ASKED, (20_000, 1)), [rng] * 20_000)  # one of each of many walks
    batch = model.sample_batch(np.tile(ASKED, (2_000, 1)), 10, rng).reshape(-1, 2)
    for samples in (at_once, singly, batch):
        assert chi_square(model, samples) > 0.001
    # The test can tell: the density of another exponent is refused.
    assert chi_square(dataclasses.replace(model, exponent=exponent * 1.15), at_once) < 0.001


@pytest.mark.parametrize("exponent", [0.5, 2.5])
@pytest.mark.parametrize("basis", BASES)
def test_exponents_between_whole_numbers(basis, exponent):
    model = known(basis, exponent)
    assert chi_square(model, model.sample(ASKED, 20_000, np.random.default_rng(0))) > 0.001


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("basis", BASES)
def test_moments(basis, exponent):
    model = known(basis, exponent)
    samples = model.sample(ASKED, 20_000, np.random.default_rng(1))
    for axis, name in enumerate(model.names):
        marginal = model.marginal(ASKED, name, points_per_step=30)
        weights = marginal.density * marginal.widths[0]
        mean = weights @ marginal.values[0]
        spread = np.sqrt(weights @ (marginal.values[0] - mean) ** 2)
        assert weights.sum() == pytest.approx(1)
        assert samples[:, axis].mean() == pytest.approx(mean, abs=4 * spread / np.sqrt(20_000) + 2e-3)
        assert samples[:, axis].std() == pytest.approx(spread, rel=0.03)


@pytest.mark.parametrize("exponent", [1.0, 2.0, 30.0])
@pytest.mark.parametrize("basis", BASES)
def test_a_held_parameter_draws_from_the_slice(basis, exponent):
    for v in (1.3, 0.7, 0.45, 1.6):  # between nodes, on a node, at the end
        model = known(basis, exponent, fixed={"v": v})
        samples = model.sample(ASKED, 3000, np.random.default_rng(1))
        assert np.all(samples[:, 0] == v)
        at = np.linspace(*model.space.bounds[1], 20_001)
        density = model.density(ASKED, np.column_stack([np.full_like(at, v), at]))
        cumulative = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2)])
        assert stats.kstest(samples[:, 1], lambda a: np.interp(a, at, cumulative / cumulative[-1])).pvalue > 1e-4  # noqa: B023


@pytest.mark.parametrize("exponent", [1.0, 30.0])
@pytest.mark.parametrize("basis", BASES)
@pytest.mark.parametrize("weights", ["linear", "inverse", "uniform"])
def test_every_weighting(basis, exponent, weights):
    model = known(basis, exponent, weights=weights)
    assert chi_square(model, model.sample(ASKED, 8_000, np.random.default_rng(3)), 8) > 0.001
    everything = dataclasses.replace(model, k=40)
    assert chi_square(everything, everything.sample(ASKED, 8_000, np.random.default_rng(3)), 8) > 0.001


def test_nothing_is_drawn_where_the_surface_is_not_positive():
    model = known("rbf", 1.0)
    samples = model.sample(ASKED, 3000, np.random.default_rng(2))
    assert model.density(ASKED, samples).min() > 0
    somewhere = np.random.default_rng(3).uniform(*model.space.bounds.T, (3000, 2))
    surface = model.interpolant.evaluate(model.blended_coefficients(ASKED)[0], model.space.to_unit(somewhere))
    assert (surface < 0).any()


@pytest.mark.parametrize("exponent", [1.0, 30.0])
@pytest.mark.parametrize("basis", BASES)
def test_bounds_that_do_not_hold_are_told(basis, exponent):
    model = known(basis, exponent)
    low = dataclasses.replace(model, rung=0.3 * model.rung)
    with pytest.raises(InputError, match="above its bound"):
        low.sample(ASKED, 1000, np.random.default_rng(0))
    if basis == "multilinear":  # whose maps are zero at the lowest speed
        with pytest.raises(InputError, match="not positive"):
            dataclasses.replace(model, fixed={"v": 0.1}).sample(ASKED, 1, np.random.default_rng(0))


@pytest.mark.parametrize("basis", BASES)
def test_looser_bounds_draw_the_same_distribution(basis):
    model = known(basis, 8.0)
    samples = dataclasses.replace(model, rung=1.2 * model.rung).sample(ASKED, 10_000, np.random.default_rng(5))
    assert chi_square(model, samples) > 0.001


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("basis", BASES)
def test_a_walk_draws_from_its_own_generator_whatever_its_company(basis, exponent):
    model = known(basis, exponent)
    vectors = np.random.default_rng(0).random((30, 2))

    def generators(rows):
        return [np.random.default_rng([7, row]) for row in rows]

    together = model.parameters(vectors, generators(range(30)))
    order = np.random.default_rng(1).permutation(30)
    assert np.array_equal(model.parameters(vectors[order], generators(order)), together[order])
    singly = [model.sample(vectors[row], 1, rng)[0] for row, rng in enumerate(generators(range(30)))]
    assert np.array_equal(together, singly)
    batch = model.sample_batch(vectors[order[:7]], 1, generators(order[:7]))[:, 0]
    assert np.array_equal(batch, together[order[:7]])


def test_few_and_many_samples_agree_to_the_last_decision():
    # Up to FEW samples the maps are blended at single points only; the numbers must not depend on that.
    model = known("multilinear", 30.0)
    few, many = (model.sample(ASKED, size, np.random.default_rng(4)) for size in (sampling.FEW, sampling.FEW + 1))
    assert np.array_equal(few, many[: sampling.FEW])


def test_the_two_bases_differ_and_by_how_much():
    """Where maps have corners, radial basis functions round them off and swing over; the multilinear basis does neither."""
    rbf, multilinear = (known(basis, 1.0) for basis in BASES)
    points = np.random.default_rng(0).uniform(*rbf.space.bounds.T, (4000, 2))
    highest = rbf.blend(ASKED).max()
    surface = [m.interpolant.evaluate(m.blended_coefficients(ASKED)[0], m.space.to_unit(points)) for m in (rbf, multilinear)]
    assert surface[0].min() < -0.01
    assert surface[1].min() >= 0
    assert surface[1].max() <= highest + 1e-12
    assert 0.05 < np.abs(surface[0] - surface[1]).max() < 0.3
    total_variation = 0.5 * np.abs(mass_of_bins(rbf, 12) - mass_of_bins(multilinear, 12)).sum()
    assert 0.01 < total_variation < 0.1  # the difference of two densities, 1 at most
    nodes = rbf.space.cells
    assert rbf.density(ASKED, nodes) == pytest.approx(multilinear.density(ASKED, nodes), abs=1e-4)


def test_uniform_numbers_are_uniform_and_independent():
    numbers = []
    for seed in range(200):
        state = np.empty(1, dtype=np.uint64)
        start(state, seed / 2**53)
        numbers.append([uniform(state) for _ in range(100)])
    numbers = np.array(numbers)
    assert stats.kstest(numbers.ravel(), "uniform").pvalue > 0.001
    assert stats.kstest(numbers[:, 0], "uniform").pvalue > 0.001  # across seeds that follow each other
    assert abs(np.corrcoef(numbers[:, :-1].ravel(), numbers[:, 1:].ravel())[0, 1]) < 0.03


def test_picking_follows_the_increments():
    cumulative = np.cumsum([0.0, 1.0, 0.0, 3.0])
    found = np.array([pick(cumulative, u) for u in np.linspace(0, 0.999999, 4001)])
    assert set(found) == {1, 3}
    assert (found == 1).mean() == pytest.approx(0.25, abs=1e-3)


@pytest.mark.parametrize("exponent", [300.0, 3000.0, 1e5])
@pytest.mark.parametrize("basis", BASES)
def test_very_sharp_densities_are_drawn_as_well(basis, exponent):
    """Around its maximum such a density is as narrow as a millionth of the box; the moments there are known by quadrature."""
    model = known(basis, exponent)
    samples = model.sample(ASKED, 2000, np.random.default_rng(6))
    mode, bounds = model.mode(ASKED)[0], model.space.bounds
    reach = 3 * np.abs(samples - mode).max(axis=0)
    axes = [np.linspace(max(m - r, low), min(m + r, high), 401) for m, r, (low, high) in zip(mode, reach, bounds, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    surface = model.interpolant.evaluate(model.blended_coefficients(ASKED)[0], model.space.to_unit(points.reshape(-1, 2)))
    density = np.exp(exponent * np.log(np.maximum(surface, 1e-9) / surface.max())).reshape(401, 401)
    for axis in range(2):
        weights = density.sum(axis=1 - axis)
        # By the trapezium rule: half of what is on the edge.
        weights[[0, -1]] /= 2
        cumulative = np.cumsum(weights) - weights / 2
        assert stats.kstest(samples[:, axis], lambda x: np.interp(x, axes[axis], cumulative / weights.sum())).pvalue > 1e-3  # noqa: B023
    # The test can tell: the density of another exponent is refused.
    wider = np.sum(density**0.6, axis=1)
    cumulative = np.cumsum(wider) / wider.sum()
    assert stats.kstest(samples[:, 0], lambda x: np.interp(x, axes[0], cumulative)).pvalue < 1e-3


@pytest.mark.parametrize("basis", BASES)
def test_both_ways_of_drawing_have_the_same_density(basis, monkeypatch):
    model = known(basis, 30.0)
    monkeypatch.setattr(type(model), "_sampler", lambda *_: (sampling.EXHAUSTED, 0))
    assert chi_square(model, model.sample(ASKED, 5000, np.random.default_rng(0))) > 0.001
    slice_ = dataclasses.replace(model, fixed={"v": 0.7})
    assert np.all(slice_.sample(ASKED, 20, np.random.default_rng(0))[:, 0] == 0.7)


def test_an_exponent_beyond_rounding_is_refused():
    for exponent in (np.inf, np.nan, 0.0, 1e7):
        with pytest.raises(InputError, match="at most 1e"):
            known("rbf", exponent)
