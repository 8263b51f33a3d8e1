"""Acceptance-rejection sampling of steering parameters from an interpolated map (section 5)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.steering import kernels
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.space import ParameterSpace

Array = NDArray[np.float64]
Shape = NDArray[np.int64]

DONE, ABOVE_BOUND, EXHAUSTED = range(3)
LONGEST_SEARCH = 10_000_000  # proposals per sample; a map this hostile is a mistake


def draw(
    interpolant: GridInterpolant,
    space: ParameterSpace,
    coefficients: Array,
    bound: float,
    exponent: float,
    box: Array,
    size: int,
    rng: np.random.Generator,
) -> Array:
    """Samples with density proportional to ``max(f, 0)^exponent``.

    Proposals are uniform in the box of parameters (in their units, not in grid steps); one is
    accepted if ``r < (max(f, 0) / bound)^exponent`` with r uniform in [0, 1).

    Parameters
    ----------
    coefficients : (terms,) of the map
    bound : at least the maximum of ``f`` in the box
    box : (P, 2) lowest and highest value of each parameter; equal where one is held
    size : number of samples, n

    Returns
    -------
    (n, P) parameter vectors

    Raises
    ------
    RuntimeError
        Internal: if ``f`` exceeds the bound somewhere, is positive nowhere, or nothing is accepted.
    """
    if not bound > 0:
        raise RuntimeError("internal error: the interpolated map is not positive anywhere, so that nothing can be drawn from it")
    values = np.concatenate([axis.values for axis in space.axes])
    samples = np.empty((size, len(space.axes)))
    outcome, at, height = _draw(coefficients, values, box, bound, exponent, samples, rng, *interpolant.compiled)
    if outcome == ABOVE_BOUND:
        raise RuntimeError(f"internal error: the interpolated map is {height} at {at}, above its bound {bound}")
    if outcome == EXHAUSTED:
        raise RuntimeError(
            f"internal error: no sample accepted in {LONGEST_SEARCH} proposals (bound {bound}, exponent {exponent})"
        )
    return samples


@njit(cache=True)
def to_steps(value: float, values: Array, first: int, count: int) -> float:
    """Grid steps of one parameter value, as :meth:`ParameterSpace.to_unit`."""
    j = 0
    while j < count - 2 and values[first + j + 1] <= value:
        j += 1
    low = values[first + j]
    return j + (value - low) / (values[first + j + 1] - low)


@njit(cache=True)
def _draw(
    c: Array, values: Array, box: Array, bound: float, exponent: float, samples: Array, rng: np.random.Generator,
    shape: Shape, kind: int, epsilon: float, degree: int,
) -> tuple[int, Array, float]:  # fmt: skip
    axes = len(shape)
    cells = 1
    for n in shape:
        cells *= n
    s = np.empty(cells)
    proposal = np.empty(axes)
    at = np.empty(axes)
    for row in range(len(samples)):
        accepted = False
        for _ in range(LONGEST_SEARCH):
            first = 0
            for axis in range(axes):
                low, high = box[axis]
                proposal[axis] = low + (high - low) * rng.random() if high > low else low
                at[axis] = to_steps(proposal[axis], values, first, shape[axis])
                first += shape[axis]
            threshold = rng.random()
            height = kernels.value(c, at, shape, kind, epsilon, degree, s)
            if height > bound:
                return ABOVE_BOUND, proposal, height
            share = max(height, 0.0) / bound
            if threshold < (share if exponent == 1.0 else share**exponent):
                accepted = True
                break
        if not accepted:
            return EXHAUSTED, proposal, 0.0
        samples[row] = proposal
    return DONE, proposal, 0.0
