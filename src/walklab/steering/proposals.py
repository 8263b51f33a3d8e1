"""Proposals for rejection sampling: blocks of the parameter grid, drawn by a bound of the density in each.

The box of parameters is cut along the grid lines. With an upper bound ``h_b`` of the map in block b, a proposal is
a block drawn in proportion to ``volume_b (h_b / max h)^n``, n being the exponent rounded down, and a point uniform in it
(in the parameters' units, not in grid steps). Accepting a point x of block b with probability
``(f(x) / max h)^exponent / (h_b / max h)^n`` leaves the density ``f^exponent`` whatever the bounds are, as long as they hold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.steering.space import ParameterSpace
from walklab.steering.uniforms import State, uniform

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Blocks:
    """The blocks of a box of parameters, last axis fastest; a parameter that is held has no extent.

    Attributes
    ----------
    nodes : (b,) flat number of the lowest grid node of each block
    volumes : (b,) in the units of the free parameters
    steps, free : (b, P) lowest corner in grid steps; (P,) 1.0 where a parameter is free and 0.0 where it is held
    origins, extents : (b, P) lowest corner and edges in the parameters' units
    """

    nodes: Indices
    volumes: Array
    steps: Array
    free: Array
    origins: Array
    extents: Array

    @property
    def compiled(self) -> tuple[Array, Array, Array, Array]:
        """What :func:`propose` needs."""
        return self.steps, self.free, self.origins, self.extents


def blocks_of(space: ParameterSpace, box: Array) -> Blocks:
    """The blocks of a (P, 2) box; each parameter is free or held, which is where lowest and highest are equal."""
    held = box[:, 0] == box[:, 1]
    at = space.to_unit(box[:, 0])
    shape = np.array(space.shape)
    lowest = np.minimum(at.astype(np.int64), shape - 2)
    ranges = [lowest[a : a + 1] if held[a] else np.arange(shape[a] - 1) for a in range(len(shape))]
    places = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, len(shape))
    values = [np.array(axis.values) for axis in space.axes]
    origins = np.column_stack([v[p] for v, p in zip(values, places.T, strict=True)])
    extents = np.column_stack([np.diff(v)[p] for v, p in zip(values, places.T, strict=True)])
    extents[:, held] = 0.0
    return Blocks(
        np.ravel_multi_index(tuple(places.T), tuple(shape)).astype(np.int64),
        np.prod(np.where(held, 1.0, extents), axis=1),
        np.where(held, at, places.astype(float)),
        np.where(held, 0.0, 1.0),
        np.where(held, box[:, 0], origins),
        extents,
    )


@njit(cache=True, nogil=True)
def envelope(heights: NDArray[np.float32], volumes: Array, exponent: float, shares: Array, cumulative: Array) -> float:
    """Fill ``shares`` (b,) with ``(h_b / max h)^n`` and ``cumulative`` (b,) with the running sum of volume times that.

    Returns max h; nothing is filled unless it is positive.
    """
    top = 0.0
    for b in range(len(heights)):
        top = max(top, float(heights[b]))
    if not top > 0.0:
        return top
    ratios = np.empty(len(heights))
    for b in range(len(heights)):
        ratios[b] = max(float(heights[b]), 0.0) / top
        shares[b] = 1.0
    power = int(min(exponent, 1e9))
    while power > 0:  # by squaring, all blocks at once
        if power & 1:
            for b in range(len(shares)):
                shares[b] *= ratios[b]
        for b in range(len(ratios)):
            ratios[b] *= ratios[b]
        power >>= 1
    total = 0.0
    for b in range(len(shares)):
        total += volumes[b] * shares[b]
        cumulative[b] = total
    return top


@njit(cache=True, nogil=True)
def pick(cumulative: Array, u: float) -> int:
    """Index drawn in proportion to the increments of ``cumulative``, by a uniform number."""
    wanted = u * cumulative[-1]
    low, high = 0, len(cumulative) - 1
    while low < high:
        middle = (low + high) // 2
        if cumulative[middle] > wanted:
            high = middle
        else:
            low = middle + 1
    return low


@njit(cache=True, nogil=True)
def propose(
    block: int, steps: Array, free: Array, origins: Array, extents: Array, state: State, at: Array, proposal: Array
) -> None:
    """Fill a point uniform in a block: ``at`` in grid steps, ``proposal`` in the parameters' units."""
    for axis in range(len(at)):
        if free[axis] > 0.0:
            u = uniform(state)
            at[axis] = steps[block, axis] + u
            proposal[axis] = origins[block, axis] + u * extents[block, axis]
        else:
            at[axis] = steps[block, axis]
            proposal[axis] = origins[block, axis]
