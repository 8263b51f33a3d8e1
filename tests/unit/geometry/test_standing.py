import numpy as np
import pytest

from walklab.geometry.standing import moving_span, speeds, travel_time_s


def test_speed_of_uniform_motion_is_exact():
    points = np.outer(np.arange(50) / 60, [3.0, 4.0])
    np.testing.assert_allclose(speeds(points, 1 / 60), 5.0)
    assert speeds(points[:1], 1 / 60).tolist() == [0.0]


def test_span_runs_from_last_to_first_standing_frame():
    speed = np.array([0.0, 0.01, 0.06, 1.0, 0.0, 0.7, 0.05, 0.049, 0.0])
    assert moving_span(speed, 0.05) == (1, 7)
    assert moving_span(speed[3:6], 0.05) == (0, 2)
    assert moving_span(np.zeros(5), 0.05) == (0, 0)


@pytest.mark.parametrize("step_s", [1 / 120, 1 / 60])
def test_travel_time_of_a_triangular_speed_profile(step_s):
    """Acceleration of 1 m/s2 for 1 s and back: above 0.05 m/s for 1.9 s, counted from standing frame to standing frame."""
    time_s = np.arange(-1, 4, step_s)
    inner = np.clip(time_s, 0, 2)
    along = np.where(inner < 1, inner**2 / 2, 1 - (2 - inner) ** 2 / 2)
    measured = travel_time_s(np.column_stack([along, np.zeros_like(along)]), step_s, 0.05)
    assert 1.9 < measured < 1.9 + 2.5 * step_s


def test_standing_still_takes_no_time():
    assert travel_time_s(np.ones((100, 2)), 1 / 60, 0.05) == 0.0
