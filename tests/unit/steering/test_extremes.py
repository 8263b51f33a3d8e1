"""Bounds and modes of interpolated maps, against optimisers that try to do better."""

import numpy as np
import pytest
from scipy.optimize import minimize

from walklab.steering.bounds import block_bounds
from walklab.steering.interpolation import KERNELS, GridInterpolant
from walklab.steering.modes import modes

SHAPES = [(9,), (6, 5), (4, 5, 4), (3, 3, 2, 3)]


def highest(interpolant, c, lower, upper, seed, points=400, starts=12):
    """Best of many local searches from the best of many random points."""
    rng = np.random.default_rng(seed)
    tried = lower + (upper - lower) * rng.random((points, len(lower)))
    tried = np.concatenate(
        [tried, interpolant.nodes[np.all((interpolant.nodes >= lower) & (interpolant.nodes <= upper), axis=1)]]
    )
    order = np.argsort(-interpolant.evaluate(c, tried))[:starts]
    bounds = list(zip(lower, upper, strict=True))
    searches = [minimize(lambda x: -interpolant.evaluate(c, x)[0], tried[i], bounds=bounds, method="L-BFGS-B") for i in order]
    return max(-search.fun for search in searches)


def rough_and_smooth_maps(interpolant, count, seed):
    """Independent noise, which is the roughest map there is, and peaks as real maps have them."""
    rng = np.random.default_rng(seed)
    centre = rng.random((count, 1, len(interpolant.shape))) * (np.array(interpolant.shape) - 1)
    distance = np.linalg.norm(interpolant.nodes - centre, axis=2)
    return np.concatenate([rng.random((count, interpolant.cells)), 1 - distance / distance.max(axis=1, keepdims=True)])


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("shape", SHAPES)
def test_no_optimiser_beats_the_bound_of_a_block(kernel, shape):
    interpolant = GridInterpolant(shape, kernel)
    c = interpolant.coefficients(rough_and_smooth_maps(interpolant, 3, 1))
    bounds = block_bounds(interpolant, c)
    blocks = np.array(shape) - 1
    assert bounds.shape == (6, blocks.prod())
    for block in np.random.default_rng(0).choice(blocks.prod(), min(4, blocks.prod()), replace=False):
        corner = np.array(np.unravel_index(block, blocks), dtype=float)
        for row in range(6):
            assert highest(interpolant, c[row], corner, corner + 1, seed=row, points=60, starts=2) <= bounds[row, block]


@pytest.mark.parametrize("kernel", ["multiquadric", "thin_plate_spline"])
def test_the_weighted_bounds_cover_the_blend(kernel):
    interpolant = GridInterpolant((5, 5, 4), kernel)
    c = interpolant.coefficients(rough_and_smooth_maps(interpolant, 30, 2))
    bounds = block_bounds(interpolant, c)
    overshoots = 0
    for seed in range(8):
        shares = np.random.default_rng(seed).dirichlet(np.full(60, 0.05))
        best = highest(interpolant, shares @ c, np.zeros(3), np.array([4.0, 4.0, 3.0]), seed)
        coarse = shares @ bounds
        bound = coarse.max()
        nodes = interpolant.evaluate(shares @ c, interpolant.nodes).max()
        overshoots += best > nodes * 1.001
        assert best <= bound
    smooth = np.random.default_rng(0).dirichlet(np.full(30, 0.05))
    best = highest(interpolant, smooth @ c[30:], np.zeros(3), np.array([4.0, 4.0, 3.0]), 0)
    coarse = smooth @ bounds[30:]
    assert best <= coarse.max() < 1.3 * best  # not so loose that proposals are wasted
    assert overshoots > 0  # else the grid's own maximum would have been bound enough


@pytest.mark.parametrize("kernel", ["multiquadric", "thin_plate_spline", "cubic", "gaussian"])
@pytest.mark.parametrize("shape", SHAPES)
def test_no_optimiser_beats_the_mode(kernel, shape):
    interpolant = GridInterpolant(shape, kernel)
    c = interpolant.coefficients(rough_and_smooth_maps(interpolant, 4, 3))
    lower, upper = np.zeros(len(shape)), np.array(shape) - 1.0
    found, heights = modes(interpolant, c, lower, upper)
    for row in range(8):
        assert np.all((found[row] >= lower) & (found[row] <= upper))
        assert heights[row] == pytest.approx(interpolant.evaluate(c[row], found[row])[0], abs=1e-12)
        assert highest(interpolant, c[row], lower, upper, row) <= heights[row] + 1e-8


def test_the_mode_of_a_known_peak():
    # A smooth bump away from every node; the interpolant of a fine map must put its mode there.
    interpolant = GridInterpolant((12, 11))
    peak = np.array([5.37, 6.81])
    bump = np.exp(-((interpolant.nodes - peak) ** 2).sum(axis=1) / 18)
    found, heights = modes(interpolant, interpolant.coefficients(bump), np.zeros(2), np.array([11.0, 10.0]))
    assert found[0] == pytest.approx(peak, abs=0.02)
    assert heights[0] == pytest.approx(1.0, abs=1e-3)


def test_a_mode_on_the_border_is_found_there():
    interpolant = GridInterpolant((6, 6))
    rising = interpolant.nodes[:, 0] - (interpolant.nodes[:, 1] - 2.4) ** 2
    found, _ = modes(interpolant, interpolant.coefficients(rising), np.zeros(2), np.full(2, 5.0))
    assert found[0, 0] == 5.0
    assert found[0, 1] == pytest.approx(2.4, abs=0.05)


def test_a_held_parameter_stays_and_the_rest_is_optimal():
    interpolant = GridInterpolant((6, 5, 4))
    c = interpolant.coefficients(np.random.default_rng(0).random((3, 120)))
    lower, upper = np.array([0.0, 1.3, 0.0]), np.array([5.0, 1.3, 3.0])
    found, heights = modes(interpolant, c, lower, upper)
    assert np.all(found[:, 1] == 1.3)
    grid = np.stack(np.meshgrid(np.linspace(0, 5, 61), [1.3], np.linspace(0, 3, 41), indexing="ij"), -1).reshape(-1, 3)
    for row in range(3):
        assert heights[row] >= interpolant.evaluate(c[row], grid).max()


def test_a_parameter_without_effect_takes_its_lowest_optimum():
    # The map is symmetric in the second axis: two equal peaks, told apart by rounding alone.
    interpolant = GridInterpolant((7, 7))
    first, second = interpolant.nodes.T
    symmetric = -((first - 3.2) ** 2) + 0.1 * np.abs(second - 3)
    c = interpolant.coefficients(symmetric)
    box = np.zeros(2), np.full(2, 6.0)
    found, heights = modes(interpolant, c, *box)
    assert found[0, 1] < 1
    mirrored = [[found[0, 0], 6 - found[0, 1]]]
    assert interpolant.evaluate(c[0], mirrored)[0] == pytest.approx(heights[0], abs=1e-12)
    for tilt in (-1e-12, 1e-12):
        tilted = interpolant.coefficients(symmetric + tilt * second)
        assert modes(interpolant, tilted, *box)[0] == pytest.approx(found, abs=1e-6)


def test_a_mode_does_not_depend_on_its_company():
    interpolant = GridInterpolant((6, 5, 4))
    c = interpolant.coefficients(np.random.default_rng(4).random((300, 120)))
    box = np.zeros(3), np.array([5.0, 4.0, 3.0])
    together = modes(interpolant, c, *box)[0]
    assert np.array_equal(together[[0, 131, 299]], np.concatenate([modes(interpolant, c[[i]], *box)[0] for i in (0, 131, 299)]))
    assert np.array_equal(together[::-1], modes(interpolant, c[::-1], *box)[0])
