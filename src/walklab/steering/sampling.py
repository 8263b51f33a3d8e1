"""Drawing steering parameters from blended maps by acceptance and rejection (section 5), compiled from search to sample.

Both functions draw for W walks, ``size`` vectors each, from one seed per walk, and write them into ``samples``
(W, size, P). They return an outcome, and where it is not DONE, the walk in question.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from walklab.steering import blending, kernels, multilinear
from walklab.steering.blending import blend, blend_up, parents_of
from walklab.steering.bounds import bound_of_block
from walklab.steering.interpolation import Interpolant
from walklab.steering.multilinear import MultilinearInterpolant
from walklab.steering.proposals import Blocks, envelope, pick, propose
from walklab.steering.uniforms import start, uniform

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Indices = NDArray[np.int64]
Rungs = NDArray[np.uint8]
Tree = tuple[Array, Array, Array, Indices, Array]  # offset, scale, points, order, boxes
Places = tuple[Array, Array, Array, Array]  # Blocks.compiled

Sampler = Callable[[Array, Array, Array], tuple[int, int]]  # dependency vectors, seeds, samples -> outcome, walk

DONE, ABOVE_BOUND, EXHAUSTED, NOWHERE = range(4)
REASONS = {
    ABOVE_BOUND: "the interpolated map is above its bound or no number: the model is damaged; train it again",
    EXHAUSTED: "no sample was accepted in the longest search",
    NOWHERE: "the interpolated map is not positive anywhere: the model is damaged, or a parameter is held where it is 0",
}
LONGEST_SEARCH = 20_000  # proposals per sample; after that :mod:`walklab.steering.sharp` takes over
SUSPICIOUS = 10_000  # proposals after which it is worth looking whether the map is positive anywhere
SLACK = 1e-9  # rounding of sums in different orders
FEW = 32  # samples of one walk up to which single points are blended instead of whole maps
LOOSE = (32, 256)  # refusals in one block after which its bound is taken from a finer lattice
FINER = (4, 8)  # lattice points per grid step
FAINT = 64  # units; maps lower than this are blended exactly, since one unit would be a loose bound for them
SINGLE = 1e-4  # relative; more than what rounding up in single precision adds to a blend of bounds


def sampler(
    basis: Interpolant,
    tree: Tree,
    k: int,
    how: int,
    coefficients: NDArray,
    rungs: Rungs,
    unit: float,
    blocks: Blocks,
    exponent: float,
) -> Sampler:
    """The compiled way of drawing that fits an interpolant and an exponent, with all but its last arguments given."""
    shape, places, exponent = np.array(basis.shape, dtype=np.int64), blocks.compiled, float(exponent)
    compiled: Any
    given: tuple[Any, ...]
    if not isinstance(basis, MultilinearInterpolant):
        compiled = draw_radial
        given = (coefficients, rungs, unit, blocks.volumes, places, exponent, *basis.compiled)
    elif exponent == 1.0:
        compiled, given = draw_mixture, (coefficients, unit, blocks.volumes, places, basis.corners, shape)
    else:
        compiled = draw_multilinear
        given = (coefficients, rungs, unit, blocks.nodes, blocks.volumes, places, basis.corners, exponent, shape)
    return partial(compiled, tree, k, how, *given)


@njit(cache=True, nogil=True)
def draw_radial(
    tree: Tree, k: int, how: int, coefficients: NDArray, rungs: Rungs, unit: float, volumes: Array,
    places: Places, exponent: float, shape: Indices, kind: int, epsilon: float, degree: int, vectors: Array,
    seeds: Array, samples: Array,
) -> tuple[int, int]:  # fmt: skip
    """Draw from ``max(f, 0)^exponent``, f the radial basis functions of the blend.

    A block that refuses many proposals has a loose bound, or only a small part of it is high. It gets a tighter one, from the
    blend itself; every proposal is accepted or refused under bounds that hold, so the density stays the same.

    Parameters
    ----------
    coefficients : (N, terms)
    rungs, unit : (N, b) bounds of every map in every block
    volumes : (b,) of the blocks
    """
    offset, scale, points, order, boxes = tree
    steps, free, origins, extents = places
    shares, cumulative, refused = np.empty(len(volumes)), np.empty(len(volumes)), np.empty(len(volumes), np.int64)
    cells = 1
    for n in shape:
        cells *= n
    s, at, proposal, state = np.empty(cells), np.empty(len(shape)), np.empty(len(shape)), np.empty(1, np.uint64)
    for walk in range(len(vectors)):
        start(state, seeds[walk])
        indices, weights = parents_of(vectors[walk], offset, scale, points, order, boxes, k, how)
        heights = blend_up(rungs, unit, indices, weights)
        top = envelope(heights, volumes, exponent, shares, cumulative)
        if not top > 0.0:
            return NOWHERE, walk
        surface = blend(coefficients, indices, weights)
        refused[:] = 0
        for row in range(samples.shape[1]):
            tries = 0
            while True:
                block = pick(cumulative, uniform(state))
                propose(block, steps, free, origins, extents, state, at, proposal)
                height = kernels.value(surface, at, shape, kind, epsilon, degree, s)
                if not height <= heights[block] + SLACK:
                    return ABOVE_BOUND, walk
                if height > 0.0 and uniform(state) * shares[block] < sharpened(height / top, exponent):
                    break
                refused[block] += 1
                for step in range(len(LOOSE)):
                    if refused[block] == LOOSE[step]:
                        finer = bound_of_block(surface, steps[block], free, FINER[step], shape, kind, epsilon, degree, s)
                        heights[block] = min(heights[block], np.float32(finer) * blending.ROUNDING)
                        top = envelope(heights, volumes, exponent, shares, cumulative)
                tries += 1
                if tries == LONGEST_SEARCH:
                    return EXHAUSTED, walk
            for axis in range(len(proposal)):
                samples[walk, row, axis] = proposal[axis]
    return DONE, 0


@njit(cache=True, nogil=True)
def sharpened(share: float, exponent: float) -> float:
    """``share^exponent``."""
    return share if exponent == 1.0 else share**exponent


@njit(cache=True, nogil=True)
def draw_mixture(
    tree: Tree, k: int, how: int, maps: Array, unit: float, volumes: Array, places: Places, corners: Indices,
    shape: Indices, vectors: Array, seeds: Array, samples: Array,
) -> tuple[int, int]:  # fmt: skip
    """Draw from a multilinear blend at exponent 1: pick a map by its weight, then accept a uniform point by its height.

    Point and map are accepted together, so that a map counts by its weight times its integral, as in the blend.
    Nothing is summed over maps.
    """
    offset, scale, points, order, boxes = tree
    steps, free, origins, extents = places
    top = 255.0 * unit  # no map is higher
    spread = np.cumsum(volumes)
    at, proposal, state = np.empty(len(shape)), np.empty(len(shape)), np.empty(1, np.uint64)
    parts = np.empty(len(corners))
    for walk in range(len(vectors)):
        start(state, seeds[walk])
        indices, weights = parents_of(vectors[walk], offset, scale, points, order, boxes, k, how)
        chance = np.cumsum(weights)
        for row in range(samples.shape[1]):
            tries = 0
            while True:
                chosen = indices[pick(chance, uniform(state))]
                propose(pick(spread, uniform(state)), steps, free, origins, extents, state, at, proposal)
                lowest = multilinear.locate(at, shape, parts)
                height = multilinear.value(maps[chosen], lowest, corners, parts)
                if not height <= top + SLACK:
                    return ABOVE_BOUND, walk
                if uniform(state) * top < height:
                    break
                tries += 1
                if tries == SUSPICIOUS and not blend(maps, indices, weights).max() > 0.0:
                    return NOWHERE, walk
                if tries == LONGEST_SEARCH:
                    return EXHAUSTED, walk
            for axis in range(len(proposal)):
                samples[walk, row, axis] = proposal[axis]
    return DONE, 0


@njit(cache=True, nogil=True)
def draw_multilinear(
    tree: Tree, k: int, how: int, maps: Array, rungs: Rungs, unit: float, nodes: Indices, volumes: Array,
    places: Places, corners: Indices, exponent: float, shape: Indices, vectors: Array, seeds: Array, samples: Array,
) -> tuple[int, int]:  # fmt: skip
    """Draw from ``f^exponent``, f the multilinear blend.

    The maps rounded up to whole ``unit`` in one byte a node are blended first. Their corners bound each block, and
    the blend lies at most one unit below them: what is refused under the upper or accepted under the lower
    of these bounds is decided. Only for the rest are the maps themselves blended, at that point alone unless
    many samples are wanted.

    Parameters
    ----------
    rungs, unit : (N, C) maps rounded up
    nodes : (b,) lowest node of each open block
    """
    offset, scale, points, order, boxes = tree
    steps, free, origins, extents = places
    heights, shares, cumulative = np.empty(len(nodes), np.float32), np.empty(len(nodes)), np.empty(len(nodes))
    at, proposal, state = np.empty(len(shape)), np.empty(len(shape)), np.empty(1, np.uint64)
    parts = np.empty(len(corners))
    many = samples.shape[1] > FEW
    for walk in range(len(vectors)):
        start(state, seeds[walk])
        indices, weights = parents_of(vectors[walk], offset, scale, points, order, boxes, k, how)
        ceiling = blend_up(rungs, unit, indices, weights)
        _highest_corner(ceiling, nodes, shape, heights)
        top = envelope(heights, volumes, exponent, shares, cumulative)
        if not top > 0.0:
            return NOWHERE, walk
        faint = top < FAINT * unit
        surface = blend(maps, indices, weights) if many or faint else np.empty(0)
        if faint:
            ceiling = surface.astype(np.float32) * blending.ROUNDING
            _highest_corner(ceiling, nodes, shape, heights)
            top = envelope(heights, volumes, exponent, shares, cumulative)
            if not top > 0.0:
                return NOWHERE, walk
        for row in range(samples.shape[1]):
            tries = 0
            while True:
                block = pick(cumulative, uniform(state))
                propose(block, steps, free, origins, extents, state, at, proposal)
                lowest = multilinear.locate(at, shape, parts)
                threshold = uniform(state) * shares[block]
                highest = multilinear.value(ceiling, lowest, corners, parts)
                if threshold < sharpened(highest / top, exponent):
                    if threshold < sharpened(max(highest * (1.0 - SINGLE) - unit, 0.0) / top, exponent):
                        break
                    if many or faint:
                        height = multilinear.value(surface, lowest, corners, parts)
                    else:
                        height = _blended_value(maps, indices, weights, lowest, corners, parts)
                    if not height <= highest + SLACK:
                        return ABOVE_BOUND, walk
                    if threshold < sharpened(height / top, exponent):
                        break
                tries += 1
                if tries == LONGEST_SEARCH:
                    return EXHAUSTED, walk
            for axis in range(len(proposal)):
                samples[walk, row, axis] = proposal[axis]
    return DONE, 0


@njit(cache=True, nogil=True)
def _highest_corner(ceiling: Single, nodes: Indices, shape: Indices, heights: Single) -> None:
    """Fill ``heights`` (b,) with the highest corner of the block above each of the nodes."""
    highest = ceiling.copy()
    stride = 1
    for axis in range(len(shape) - 1, -1, -1):
        # Along one axis after the other. At an axis's last node this looks into the next line; no block begins there.
        lower, upper = highest, highest[stride:].copy()
        for i in range(len(upper)):
            lower[i] = lower[i] if lower[i] > upper[i] else upper[i]
        stride *= shape[axis]
    for b in range(len(nodes)):
        heights[b] = highest[nodes[b]]


@njit(cache=True, nogil=True)
def _blended_value(maps: Array, indices: Indices, weights: Array, lowest: int, corners: Indices, parts: Array) -> float:
    total = 0.0
    for j in range(len(indices)):
        total += weights[j] * multilinear.value(maps[indices[j]], lowest, corners, parts)
    return total
