import numpy as np
import pytest
from scipy import stats

from walklab.steering.bounds import block_bounds
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.sampling import draw, to_steps
from walklab.steering.space import space_from_config


@pytest.fixture(scope="module")
def known():
    """A two-peaked map over an even and an uneven axis, its values up to zero so that clipping matters."""
    space = space_from_config(
        [
            {"name": "v", "unit": "m/s", "start": 0.1, "step": 0.3, "count": 6},
            {"name": "a", "unit": "m/s2", "values": [0.2, 0.5, 1, 3]},
        ]
    )
    v, a = space.cells.T
    values = np.exp(-((v - 0.5) ** 2) / 0.1) + 0.7 * np.exp(-((v - 1.4) ** 2) / 0.2 - (a - 2.5) ** 2)
    values[values < 0.2] = 0.0
    interpolant = GridInterpolant(space.shape)
    c = interpolant.coefficients(values / values.max())[0]
    return space, interpolant, c, float(block_bounds(interpolant, c[None]).max())


def mass_of_bins(space, interpolant, c, exponent, bins, per_bin=20):
    """Probability of each of bins x bins equal parts of the box of parameters, by the midpoint rule."""
    low, high = space.bounds.T
    n = bins * per_bin
    middles = [low[i] + (high[i] - low[i]) * (np.arange(n) + 0.5) / n for i in (0, 1)]
    points = np.stack(np.meshgrid(*middles, indexing="ij"), -1)
    density = np.maximum(interpolant.evaluate(c, space.to_unit(points).reshape(-1, 2)), 0).reshape(n, n) ** exponent
    mass = density.reshape(bins, per_bin, bins, per_bin).sum((1, 3))
    return mass / mass.sum()


@pytest.mark.parametrize("exponent", [1.0, 30.0])
def test_samples_follow_the_density(known, exponent):
    space, interpolant, c, bound = known
    size = 20_000
    samples = draw(interpolant, space, c, bound, exponent, space.bounds, size, np.random.default_rng(0))
    edges = [np.linspace(*space.bounds[i], 13) for i in (0, 1)]
    counts = np.histogram2d(*samples.T, bins=edges)[0].ravel()
    expected = mass_of_bins(space, interpolant, c, exponent, 12).ravel() * size
    assert counts.sum() == size
    rare = expected < 5  # pooled, as the chi-square test asks for
    observed, wanted = np.append(counts[~rare], counts[rare].sum()), np.append(expected[~rare], expected[rare].sum())
    if wanted[-1] < 5:
        assert observed[-1] < 20
        observed, wanted = observed[:-1], wanted[:-1] * observed[:-1].sum() / wanted[:-1].sum()
    assert stats.chisquare(observed, wanted).pvalue > 0.001
    # The test can tell: the density of another exponent is refused.
    other = mass_of_bins(space, interpolant, c, exponent * 1.15, 12).ravel()[~rare]
    shown = observed[: other.size]
    assert stats.chisquare(shown, other * shown.sum() / other.sum()).pvalue < 0.001


def test_one_parameter_passes_kolmogorov_smirnov(known):
    space, interpolant, c, bound = known
    box = space.bounds.copy()
    box[0] = 1.3  # held: what is drawn is the slice
    samples = draw(interpolant, space, c, bound, 2.0, box, 5000, np.random.default_rng(1))
    assert np.all(samples[:, 0] == 1.3)
    at = np.linspace(*space.bounds[1], 20_001)
    density = np.maximum(interpolant.evaluate(c, space.to_unit(np.column_stack([np.full_like(at, 1.3), at]))), 0) ** 2
    cumulative = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2)])
    assert stats.kstest(samples[:, 1], lambda a: np.interp(a, at, cumulative / cumulative[-1])).pvalue > 0.001


def test_nothing_is_drawn_where_the_surface_is_not_positive(known):
    space, interpolant, c, bound = known
    samples = draw(interpolant, space, c, bound, 1.0, space.bounds, 3000, np.random.default_rng(2))
    assert interpolant.evaluate(c, space.to_unit(samples)).min() > 0
    assert (interpolant.evaluate(c, space.to_unit(np.random.default_rng(3).uniform(*space.bounds.T, (3000, 2)))) < 0).any()


def test_a_bound_that_is_too_low_is_an_internal_error(known):
    space, interpolant, c, bound = known
    with pytest.raises(RuntimeError, match="above its bound"):
        draw(interpolant, space, c, 0.5 * bound, 1.0, space.bounds, 1000, np.random.default_rng(0))
    with pytest.raises(RuntimeError, match="not positive"):
        draw(interpolant, space, 0 * c, 0.0, 1.0, space.bounds, 1, np.random.default_rng(0))


def test_a_tighter_bound_draws_the_same_distribution_with_fewer_numbers(known):
    space, interpolant, c, bound = known
    loose, tight = (draw(interpolant, space, c, b, 1.0, space.bounds, 4000, np.random.default_rng(5)) for b in (3 * bound, bound))
    for axis in (0, 1):
        assert stats.ks_2samp(loose[:, axis], tight[:, axis]).pvalue > 0.001


def test_compiled_grid_steps_equal_the_spaces(known):
    space = known[0]
    values = np.array(space.axes[1].values)
    for value in [*values, 0.3, 0.75, 2.9]:
        assert to_steps(value, values, 0, len(values)) == pytest.approx(space.to_unit(np.array([0.1, value]))[1])
