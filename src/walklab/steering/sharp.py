"""Drawing from densities so sharp, or so narrow, that proposals from whole blocks of the grid hardly ever hit them.

Adaptive rejection in boxes: a proposal is drawn under the bounds of the boxes, and a box that refuses one is cut into halves
with bounds of their own. Whatever the bounds are, an accepted proposal has the density; the boxes only close in on where it
is high. Bounds are as in :mod:`walklab.steering.bounds`; a multilinear surface is bounded by the corners of a box exactly.
Everything is in logarithms, since a share of 0.5 to the exponent 2000 is no double any more.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from walklab.steering.bounds import SAFETY, points_of
from walklab.steering.interpolation import Interpolant
from walklab.steering.multilinear import MultilinearInterpolant
from walklab.steering.proposals import Blocks
from walklab.steering.sampling import ABOVE_BOUND, EXHAUSTED, FINER, NOWHERE, REASONS, SLACK

Array = NDArray[np.float64]

CUTS = 100_000  # per walk; each halves a box, and a few hundred close in on a maximum up to rounding


def draw_sharp(
    interpolant: Interpolant,
    surface: Array,
    tops: Array | None,
    blocks: Blocks,
    exponent: float,
    size: int,
    rng: np.random.Generator,
) -> Array:
    """Draw (size, P) parameter vectors from ``max(f, 0)^exponent`` in the blocks.

    Parameters
    ----------
    surface : (terms,) coefficients of f
    tops : (b,) upper bound of f in each block; None finds them
    blocks : of the box of parameters, see :func:`walklab.steering.proposals.blocks_of`

    Raises
    ------
    RuntimeError
        If f is above a bound, or not positive anywhere.
    """
    low, edges = blocks.steps, np.tile(blocks.free, (len(blocks.steps), 1))
    origins, scale = blocks.origins, blocks.extents
    sizes = np.log(blocks.volumes)
    tops = bounds_of_boxes(interpolant, surface, low, edges) if tops is None else tops
    samples = np.empty((size, low.shape[1]))
    row = cuts = 0
    while row < size:
        if not tops.max() > 0.0:
            raise RuntimeError(REASONS[NOWHERE])
        with np.errstate(divide="ignore"):
            chances = sizes + exponent * np.log(np.maximum(tops, 0.0) / tops.max())
        cumulative = np.cumsum(np.exp(chances - chances.max()))
        box = int(np.searchsorted(cumulative, rng.random() * cumulative[-1], side="right"))
        within = rng.random(low.shape[1]) * edges[box]
        height = float(interpolant.evaluate(surface, low[box] + within)[0])
        if not height <= tops[box] + SLACK:
            raise RuntimeError(REASONS[ABOVE_BOUND])
        if height > 0.0 and np.log1p(-rng.random()) < exponent * np.log(height / tops[box]):
            samples[row] = origins[box] + within * scale[box]
            row += 1
            continue
        cuts += 1
        if cuts > CUTS:
            raise RuntimeError(REASONS[EXHAUSTED])
        axis = int(np.argmax(edges[box]))
        low, edges, origins, scale, sizes = (
            np.concatenate([values, values[box : box + 1]]) for values in (low, edges, origins, scale, sizes)
        )
        halves = [box, len(low) - 1]
        sizes[halves] -= np.log(2.0)
        edges[halves, axis] /= 2.0
        low[-1, axis] += edges[box, axis]
        origins[-1, axis] += edges[box, axis] * scale[box, axis]
        tops = np.append(tops, 0.0)
        tops[halves] = np.minimum(tops[box], bounds_of_boxes(interpolant, surface, low[halves], edges[halves]))
    return samples


def bounds_of_boxes(interpolant: Interpolant, surface: Array, low: Array, edges: Array) -> Array:
    """Upper bound of the surface in each of (b, P) boxes in grid steps, (b,); an axis without extent is held."""
    exact = isinstance(interpolant, MultilinearInterpolant)
    across = np.linspace(0.0, 1.0, 2 if exact else FINER[0] + 1)
    free = np.flatnonzero(edges.max(axis=0) > 0.0)
    lattice = np.zeros((len(across) ** len(free), low.shape[1]))
    lattice[:, free] = points_of([across] * len(free))
    points = low[:, None, :] + lattice * edges[:, None, :]
    flat = interpolant.evaluate(surface, points.reshape(-1, low.shape[1])).reshape(len(low), -1)
    if exact:
        return np.asarray(flat.max(axis=1))
    heights = flat.reshape(len(low), *[len(across)] * len(free))
    bends = [np.abs(np.diff(heights, 2, axis=1 + i)).reshape(len(low), -1).max(axis=1) for i in range(len(free))]
    return np.asarray(flat.max(axis=1) + SAFETY / 8 * np.sum(bends, axis=0))
