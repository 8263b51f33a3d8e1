"""Resampling in time and packing."""

from __future__ import annotations

import numpy as np
import pytest

from walklab.errors import InputError
from walklab.planning.batch import pack_walks, resample_time


def test_resampling_is_exact_for_linear_motion_and_keeps_the_first_frame() -> None:
    time = 3.0 + np.array([0.0, 0.013, 0.4, 0.71, 1.2])
    position = np.column_stack([1 + 2 * (time - 3), -0.5 * (time - 3)])
    out = resample_time(time, position, 1 / 60)
    assert len(out) == 73  # 1.2 s is 72 steps
    expected = np.arange(73) / 60
    assert np.allclose(out, np.column_stack([1 + 2 * expected, -0.5 * expected]), atol=1e-9)


@pytest.mark.parametrize("rate_hz", [60, 120, 100])
def test_resampling_halves_drops_and_keeps(rate_hz: int) -> None:
    frames = np.arange(rate_hz * 2 + 1)
    position = np.random.default_rng(0).normal(size=(len(frames), 2))
    out = resample_time(frames / rate_hz, position, 1 / 60)
    assert len(out) == 121
    assert np.allclose(out[60], position[rate_hz], atol=1e-9)
    if rate_hz == 60:
        assert np.allclose(out, position, atol=1e-9)
    if rate_hz == 120:
        assert np.allclose(out, position[::2], atol=1e-9)


def test_a_rest_shorter_than_a_step_is_dropped() -> None:
    assert len(resample_time(np.array([0.0, 0.109]), np.zeros((2, 2)), 0.01)) == 11


def test_packed_walks_come_out_as_they_went_in() -> None:
    rng = np.random.default_rng(1)
    positions = [rng.normal(size=(n, 2)) for n in (5, 1, 9)]
    routes = [rng.normal(size=(n, 2)) for n in (2, 4, 3)]
    batch = pack_walks(positions, routes, [0, 0.1, 0.2], [0, 0, 0.3], [1.0, 2.0, 3.0], 1 / 60)
    assert len(batch) == 3
    for i in range(3):
        assert np.array_equal(batch.captured_m[batch.captured_offsets[i] : batch.captured_offsets[i + 1]], positions[i])
        assert np.array_equal(batch.routes_m[batch.route_offsets[i] : batch.route_offsets[i + 1]], routes[i])
    assert len(pack_walks([], [], [], [], [], 1 / 60)) == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"lengths": [1.0, 0.0]}, "walk 1 of the batch: its length is 0.0 m"),
        ({"lengths": [1.0]}, "differ in number"),
        ({"routes": [np.zeros((2, 2)), np.zeros((1, 2))]}, r"walk 1 of the batch: route of shape \(1, 2\)"),
        ({"positions": [np.zeros((2, 3)), np.zeros((2, 2))]}, r"walk 0 of the batch: positions of shape \(2, 3\)"),
    ],
)
def test_bad_walks_are_named(change: dict, message: str) -> None:
    good = {"positions": [np.zeros((2, 2))] * 2, "routes": [np.zeros((2, 2))] * 2, "lengths": [1.0, 1.0]}
    speeds = {"start_speeds": [0, 0], "end_speeds": [0, 0]}
    with pytest.raises(InputError, match=message):
        pack_walks(**{**good, **speeds, **change}, step_s=1 / 60)
