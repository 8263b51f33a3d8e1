import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator

from walklab.errors import InputError
from walklab.steering import kernels
from walklab.steering.interpolation import KERNELS, GridInterpolant
from walklab.steering.space import space_from_config

SHAPES = [(4,), (5, 3), (3, 4, 2), (2, 3, 2, 3)]


def inner_points(shape, count, seed=0):
    return np.random.default_rng(seed).random((count, len(shape))) * (np.array(shape) - 1)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("shape", [*SHAPES, (10, 10, 10)])
def test_equals_scipy(kernel, shape):
    interpolant = GridInterpolant(shape, kernel)
    maps = np.random.default_rng(1).random((3, interpolant.cells))
    points = inner_points(shape, 60)
    expected = RBFInterpolator(interpolant.nodes, maps[1], kernel=kernel, epsilon=1.0)(points)
    solved = interpolant.coefficients(maps)[1]
    assert np.abs(interpolant.evaluate(solved, points) - expected).max() < 1e-8
    assert np.abs(interpolant.basis(points) @ solved - expected).max() < 1e-8


@pytest.mark.parametrize("epsilon", [0.5, 2.0])
@pytest.mark.parametrize("kernel", ["multiquadric", "gaussian"])
def test_the_width_of_the_kernel_is_scipys(kernel, epsilon):
    interpolant = GridInterpolant((5, 6), kernel, epsilon)
    values = np.random.default_rng(1).random(30)
    points = inner_points((5, 6), 60)
    expected = RBFInterpolator(interpolant.nodes, values, kernel=kernel, epsilon=epsilon)(points)
    assert interpolant.evaluate(interpolant.coefficients(values)[0], points) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("kernel", KERNELS)
def test_the_surface_goes_through_the_nodes(kernel):
    interpolant = GridInterpolant((4, 3, 5), kernel)
    values = np.random.default_rng(1).random(60)
    assert interpolant.evaluate(interpolant.coefficients(values)[0], interpolant.nodes) == pytest.approx(values, abs=1e-9)


def test_blending_coefficients_equals_blending_maps():
    interpolant = GridInterpolant((6, 6, 6))
    rng = np.random.default_rng(2)
    maps, shares = rng.random((40, 216)), rng.dirichlet(np.ones(40))
    points = inner_points((6, 6, 6), 50)
    blended_after = interpolant.evaluate(shares @ interpolant.coefficients(maps), points)
    solved_after = interpolant.evaluate(interpolant.coefficients(shares @ maps)[0], points)
    assert np.abs(blended_after - solved_after).max() < 1e-11


def test_uneven_axes_enter_in_grid_steps():
    space = space_from_config(
        [{"name": "v", "unit": "m/s", "values": [0.1, 0.2, 0.9, 4.0]}, {"name": "a", "unit": "m/s2", "values": [1, 5, 6]}]
    )
    interpolant = GridInterpolant(space.shape)
    assert np.array_equal(space.to_unit(space.cells), interpolant.nodes)
    values = np.random.default_rng(0).random(12)
    at = interpolant.evaluate(interpolant.coefficients(values)[0], space.to_unit(space.cells[[7]]))
    assert at[0] == pytest.approx(values[7])


@pytest.mark.parametrize("kernel", ["multiquadric", "thin_plate_spline"])
def test_inverse_diagonal_gives_leave_one_out_errors(kernel):
    interpolant = GridInterpolant((4, 5), kernel)
    values = np.random.default_rng(3).random(20)
    closed_form = interpolant.coefficients(values)[0, :20] / interpolant.inverse_diagonal
    for node in (0, 7, 19):
        rest = np.arange(20) != node
        without = RBFInterpolator(interpolant.nodes[rest], values[rest], kernel=kernel, epsilon=1.0)
        assert closed_form[node] == pytest.approx(values[node] - without(interpolant.nodes[[node]])[0], abs=1e-9)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("shape", SHAPES)
def test_derivatives_equal_finite_differences(kernel, shape):
    interpolant = GridInterpolant(shape, kernel)
    c = interpolant.coefficients(np.random.default_rng(1).random(interpolant.cells))[0]
    at, axes, step = inner_points(shape, 1, seed=8)[0], len(shape), 1e-4
    gradient, hessian = np.empty(axes), np.empty((axes, axes))
    kernels.expand(c, at, *interpolant.compiled, np.empty(interpolant.cells), gradient, hessian)

    def f(*moves):
        return interpolant.evaluate(c, at + step * sum(moves))[0]

    unit = np.eye(axes)
    for a in range(axes):
        assert gradient[a] == pytest.approx((f(unit[a]) - f(-unit[a])) / (2 * step), abs=1e-5)
        for b in range(axes):
            mixed = f(unit[a], unit[b]) - f(unit[a], -unit[b]) - f(-unit[a], unit[b]) + f(-unit[a], -unit[b])
            assert hessian[a, b] == pytest.approx(mixed / (4 * step**2), abs=2e-4)


def test_what_does_not_fit_is_refused():
    with pytest.raises(InputError, match="quintic"):
        GridInterpolant((3, 3), "quintic")
    with pytest.raises(InputError, match="epsilon"):
        GridInterpolant((3, 3), epsilon=0.0)
    with pytest.raises(InputError, match="8 cells"):
        GridInterpolant((3, 3)).coefficients(np.zeros((2, 8)))
