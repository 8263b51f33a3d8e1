import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from walklab.geometry.curves import arc_length, length, mean_curvature, resample, sample_sum_curvature, smooth, turning_angles


def arc(radius_m: float, angle_rad: float, count: int) -> np.ndarray:
    at = np.linspace(0, angle_rad, count)
    return radius_m * np.column_stack([np.cos(at), np.sin(at)])


@given(st.floats(-3, 3), st.floats(0.1, 10), st.integers(2, 300))
def test_a_straight_line_has_its_length_and_no_curvature(direction, total, count):
    line = np.linspace(0, total, count)[:, None] * np.array([np.cos(direction), np.sin(direction)])
    assert length(line) == pytest.approx(total, rel=1e-9)
    assert mean_curvature(line, 0.1) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("radius_m", [0.5, 1.0, 3.0])
def test_a_circle_has_the_curvature_of_its_radius(radius_m):
    assert mean_curvature(arc(radius_m, 2 * np.pi, 4001), 0.01) == pytest.approx(1 / radius_m, rel=0.03)


@pytest.mark.parametrize("scale_m", [0.05, 0.2])
def test_curvature_does_not_depend_on_the_sampling_rate(scale_m):
    """The same walk with standing at both ends, sampled at 60 and 120 Hz."""

    def walk(rate_hz: float) -> np.ndarray:
        along = np.clip(np.arange(0, 5, 1 / rate_hz) - 1, 0, 3)
        return np.column_stack([along, 0.3 * np.sin(along)])

    slow, fast = (mean_curvature(walk(rate_hz), scale_m) for rate_hz in (60, 120))
    assert slow == pytest.approx(fast, rel=0.01)
    assert slow > 0.05


def test_smoothing_takes_the_curvature_of_sway_but_not_of_a_turn():
    along = np.linspace(0, 4, 2000)
    swaying = np.column_stack([along, 0.01 * np.sin(2 * np.pi * along / 0.7)])
    assert mean_curvature(swaying, 0.3) < 0.1 * mean_curvature(swaying, 0.01)
    turn = np.vstack([[0, 0], [2, 0], [2, 2]]).astype(float)
    assert mean_curvature(turn, 0.1) * 4 == pytest.approx(np.pi / 2, rel=0.05)


def test_the_sample_sum_grows_with_the_sampling_rate():
    """Agethen et al. 2017, section 4.4: on a circle of radius r with n samples the sum is n / r over the length."""
    for count in (100, 200):
        points = arc(2.0, np.pi, count)
        assert sample_sum_curvature(points) == pytest.approx(count / 2.0 / length(points), rel=0.02)


def test_the_sample_sum_explodes_at_a_standstill():
    rng = np.random.default_rng(1)
    walking = np.column_stack([np.linspace(0, 2, 200), np.zeros(200)])
    standing = np.repeat(walking[-1:], 100, axis=0)
    noisy = np.vstack([walking, standing]) + 0.0005 * rng.standard_normal((300, 2))
    assert sample_sum_curvature(noisy) > 1e4
    assert mean_curvature(noisy, 0.2) < 0.1


def test_the_sample_sum_needs_six_points():
    with pytest.raises(ValueError, match="at least 6"):
        sample_sum_curvature(np.zeros((5, 2)))


@given(st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), min_size=2, max_size=20), st.sampled_from([0.01, 0.1]))
def test_resampling_is_even_and_keeps_the_ends(corners, spacing_m):
    points = np.array(corners)
    even = resample(points, spacing_m)
    np.testing.assert_allclose(even[[0, -1]], points[[0, -1]], atol=1e-9)
    assert length(even) <= length(points) + 1e-9
    assert np.hypot(*np.diff(even, axis=0).T).max() <= spacing_m + 1e-9 or length(points) == 0


def test_smoothing_holds_the_ends_and_leaves_straight_lines():
    line = np.column_stack([np.linspace(0, 1, 50), np.linspace(0, 3, 50)])
    np.testing.assert_allclose(smooth(line, 4), line, atol=1e-12)
    bent = np.vstack([line, line[-1] + line[:0:-1] * [1, -1]])
    np.testing.assert_allclose(smooth(bent, 4)[[0, -1]], bent[[0, -1]], atol=1e-12)
    assert length(smooth(bent, 4)) < length(bent)


def test_turning_angles_of_a_square_are_right_angles_and_skip_repeated_points():
    square = np.array([[0, 0], [1, 0], [1, 0], [1, 1], [0, 1], [0, 0]], dtype=float)
    np.testing.assert_allclose(turning_angles(square), np.pi / 2)
    assert turning_angles(square[:2]).size == 0
    np.testing.assert_allclose(arc_length(square), [0, 1, 1, 2, 3, 4])


def test_a_path_without_extent_has_no_curvature():
    assert mean_curvature(np.zeros((10, 2)), 0.1) == 0.0
