"""Plane curves: arc length, resampling, smoothing and curvature.

Captured and planned paths pass through the same functions, so that a difference
between their curvatures is a difference between the paths.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

Array = NDArray[np.float64]

RESAMPLING_M = 0.01


def arc_length(points_m: Array) -> Array:
    """Cumulative length along a polyline.

    Parameters
    ----------
    points_m : (n, 2) array, metres

    Returns
    -------
    (n,) array, metres, starting at 0
    """
    steps = np.hypot(*np.diff(points_m, axis=0).T)
    return np.concatenate([[0.0], np.cumsum(steps)])


def length(points_m: Array) -> float:
    """Length of a polyline in metres."""
    return float(arc_length(points_m)[-1])


def resample(points_m: Array, spacing_m: float = RESAMPLING_M) -> Array:
    """Points at equal arc length, both ends kept; the spacing is shrunk to divide the length.

    A curve without extent (all points equal) comes back as its two ends.
    """
    travelled = arc_length(points_m)
    total = travelled[-1]
    if total == 0.0:
        return points_m[[0, -1]]
    keep = np.concatenate([[True], np.diff(travelled) > 0])
    count = max(2, int(np.ceil(total / spacing_m)) + 1)
    at = np.linspace(0.0, total, count)
    return np.column_stack([np.interp(at, travelled[keep], points_m[keep, axis]) for axis in (0, 1)])


def smooth(points_m: Array, sigma_samples: float) -> Array:
    """Gaussian smoothing along the first axis with both ends held.

    The curve is continued by point reflection at its ends, so that a straight
    line stays exactly itself.
    """
    if sigma_samples <= 0 or len(points_m) < 3:
        return points_m.copy()
    pad = min(len(points_m) - 1, int(np.ceil(4 * sigma_samples)))
    head = 2 * points_m[0] - points_m[pad:0:-1]
    tail = 2 * points_m[-1] - points_m[-2 : -pad - 2 : -1]
    padded = np.concatenate([head, points_m, tail])
    return gaussian_filter1d(padded, sigma_samples, axis=0, mode="nearest")[pad : pad + len(points_m)]


def turning_angles(points_m: Array) -> Array:
    """Signed change of direction at each inner point, radians, in (-pi, pi]."""
    steps = np.diff(points_m, axis=0)
    steps = steps[np.hypot(*steps.T) > 0]
    if len(steps) < 2:
        return np.zeros(0)
    cross = steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0]
    dot = np.einsum("ij,ij->i", steps[:-1], steps[1:])
    return np.arctan2(cross, dot)


def mean_curvature(points_m: Array, scale_m: float, spacing_m: float = RESAMPLING_M) -> float:
    """Mean absolute curvature of a path, ``c = (1/l) * integral |kappa| ds`` (1/m).

    The path is resampled by arc length and smoothed by a Gaussian of ``scale_m``;
    the integral of ``|kappa|`` is then the sum of the absolute turning angles. The
    value does not depend on the sampling rate of the recording.

    Parameters
    ----------
    points_m : (n, 2) array, metres
    scale_m : standard deviation of the smoothing, metres

    Returns
    -------
    float, 1/m; 0 for a path without extent

    Notes
    -----
    Agethen et al. 2017, section 4.4, define ``sum |c_i| / l`` over samples; see
    :func:`sample_sum_curvature` for that reading and why it is not the default.
    """
    path = resample(np.asarray(points_m, dtype=float), spacing_m)
    total = length(path)
    if total == 0.0:
        return 0.0
    curve = smooth(path, scale_m * (len(path) - 1) / total)
    extent = length(curve)
    return float(np.abs(turning_angles(curve)).sum() / extent) if extent > 0 else 0.0


def sample_sum_curvature(points_m: Array) -> float:
    """Agethen et al. 2017, section 4.4, to the letter: ``c = sum_i |c_i| / l`` (1/m^2).

    Fifth-degree interpolating splines (``UnivariateSpline``) over the sample index
    give ``kappa = (x' y'' - y' x'') / (x'^2 + y'^2)^(3/2)`` at each sample.
    The sum grows with the sampling rate and explodes where a person stands still.

    Raises
    ------
    ValueError
        If there are fewer than 6 points, which a fifth-degree spline needs.
    """
    from scipy.interpolate import UnivariateSpline  # late: half a second of imports

    if len(points_m) < 6:
        raise ValueError(f"a fifth-degree spline needs at least 6 points, not {len(points_m)}")
    at = np.arange(len(points_m), dtype=float)
    x, y = (UnivariateSpline(at, points_m[:, axis], k=5, s=0) for axis in (0, 1))
    dx, dy, ddx, ddy = x.derivative(1)(at), y.derivative(1)(at), x.derivative(2)(at), y.derivative(2)(at)
    speed_squared = np.maximum(dx**2 + dy**2, np.finfo(float).tiny ** 0.5)
    curvature = np.abs(dx * ddy - dy * ddx) / speed_squared**1.5
    return float(curvature.sum() / length(points_m))
