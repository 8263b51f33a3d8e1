"""The dependency blending space: suitability maps at their dependency vectors (section 4.4).

Its sparse regions are filled with blends of nearby maps, after Kovar & Gleicher 2004.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from walklab.errors import InputError
from walklab.steering.arguments import as_numbers, check_values
from walklab.steering.scaling import Scaling, fit_scaling
from walklab.steering.search import DEEPEST, SearchTree, gap_to_box, search_tree
from walklab.steering.weighting import Weighting, weights

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Tree = tuple[Array, Indices, Array]

MAP_RANGE = (0.0, 1.0)  # suitability
ROUNDING = 1e-9  # a blend of zeros may come out this far below zero
BATCH = 4096  # candidates drawn at once, which bounds the memory


@dataclass(frozen=True)
class BlendingSpace:
    """Maps at their dependency vectors, searchable.

    Attributes
    ----------
    names, units : of the D dependencies
    vectors : (N, D) dependency vectors, originals first
    scaling : to the coordinates in which neighbours are searched
    maps : (N, C) suitability
    parents : (N, S) originals of which each entry is blended; -1 where unused; an original is its own parent
    parent_weights : (N, S) weights of the parents, each row sums to 1
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    vectors: Array
    scaling: Scaling
    maps: Array
    parents: Indices
    parent_weights: Array

    def __len__(self) -> int:
        return len(self.vectors)

    @property
    def is_blend(self) -> NDArray[np.bool_]:
        """(N,) whether an entry was blended rather than captured."""
        return self.parents[:, 0] != np.arange(len(self.vectors))

    @cached_property
    def tree(self) -> SearchTree:
        """Search tree over the scaled vectors."""
        return search_tree(self.scaling.apply(self.vectors))

    def nearest(self, vectors: ArrayLike, k: int) -> tuple[Indices, Array]:
        """Indices and scaled distances of the k nearest entries, each (W, k), nearest first.

        Without dependencies (D = 0) every entry is equally near, and all come back.

        Raises
        ------
        InputError
            If k is not between 1 and the number of entries, or a vector has not D values.
        """
        asked = self.checked(vectors)
        if not 1 <= k <= len(self):
            raise InputError(f"k = {k}: must lie between 1 and the blending space's {len(self)} entries")
        if not self.names:
            return np.tile(np.arange(len(self)), (len(asked), 1)), np.zeros((len(asked), len(self)))
        return self.tree.nearest(self.scaling.apply(asked), k)

    def shaped(self, vectors: ArrayLike) -> Array:
        """(W, D) dependency vectors; InputError if they have another number of values, or one is no number."""
        asked = np.array(as_numbers(vectors, self.names), ndmin=2, order="C")
        if asked.ndim != 2 or asked.shape[1] != len(self.names):
            raise InputError(f"dependency vectors have {asked.shape[-1]} values; needed are {', '.join(self.names) or 'none'}")
        return asked

    def checked(self, vectors: ArrayLike) -> Array:
        """The same, and InputError if a value is not finite, or negative where that means nothing."""
        asked = self.shaped(vectors)
        check_values(asked, self.names)
        return asked

    def neighbours(self, vectors: ArrayLike, k: int, how: Weighting = "linear") -> tuple[Indices, Array]:
        """Indices and blend weights of the k nearest entries, each (W, k); weights sum to 1."""
        if not self.names or k >= len(self) or how != "linear":
            indices, distances = self.nearest(vectors, k)
            return indices, weights(distances, how)
        indices, distances = self.nearest(vectors, k + 1)
        return indices[:, :k], weights(distances[:, :k], how, beyond=distances[:, k])


def blending_space(
    names: Sequence[str], units: Sequence[str], vectors: ArrayLike, maps: ArrayLike, scaling: Scaling
) -> BlendingSpace:
    """A blending space of captured walks only.

    Raises
    ------
    InputError
        If the shapes do not fit, or a value is not finite.
    """
    points, suitability = np.asarray(vectors, dtype=float), np.asarray(maps, dtype=float)
    if points.shape != (len(suitability), len(names)) or len(units) != len(names) or suitability.ndim != 2:
        raise InputError(
            f"blending space: vectors {points.shape} and maps {suitability.shape} do not fit dependencies {', '.join(names)}"
        )
    if not (np.all(np.isfinite(points)) and np.all(np.isfinite(suitability))):
        raise InputError("blending space: a vector or a map holds a value that is not finite; leave that walk out")
    own = np.arange(len(points), dtype=np.int64)[:, None]
    return BlendingSpace(tuple(names), tuple(units), points, scaling, suitability, own, np.ones((len(points), 1)))


def homogenise(
    vectors: ArrayLike,
    maps: ArrayLike,
    count: int,
    neighbours: int,
    subset: int,
    delta: float,
    rng: np.random.Generator,
    *,
    names: Sequence[str],
    units: Sequence[str] | None = None,
    scaling: Scaling | None = None,
    minimum: Sequence[float] | None = None,
    candidates_per_entry: int = 8,
) -> BlendingSpace:
    """Blend captured maps until the blending space holds ``count`` entries, sparse regions first.

    A candidate is a blend of ``subset`` random maps out of the ``neighbours`` nearest to a point
    drawn uniformly in the bounding box of the scaled dependencies; its weights are uniform over
    ``{w : sum w = 1, -delta <= w_j <= 1 + delta}``, and its dependency vector is blended alike.
    Of ``candidates_per_entry`` times as many candidates as are needed, the one farthest from
    every entry chosen so far is chosen next.

    Parameters
    ----------
    vectors : (N, D) dependency vectors
    maps : (N, C) suitability in [0, 1]
    count : entries wanted in all, at least N
    neighbours, subset : size of a neighbourhood and of a blend, ``2 <= subset <= neighbours``
    delta : how far blends may extrapolate
    names, units : of the dependencies
    scaling : default :func:`fit_scaling` of the vectors
    minimum : (D,) physically smallest values; default that of the registered dependencies, else none

    Returns
    -------
    BlendingSpace, the captured entries first, unchanged; without dependencies or with ``count == N``
    nothing is added

    Raises
    ------
    InputError
        If a setting is out of range, or the walks are too alike to blend that many.
    """
    # ASSUME: The paper does not say whether its 5000 entries contain the 1848 captured ones; they are kept, since a
    # measured map is worth more than a blend of its neighbours.
    # ASSUME: Kovar & Gleicher keep whatever random blends come; here the farthest of many candidates is taken each
    # time, because the stated purpose is a homogeneous density and random blends would only thicken the dense places.
    from walklab.steering.dependencies import DEPENDENCIES  # late: a process that only samples needs no tables

    scale = fit_scaling(vectors) if scaling is None else scaling
    labels = units if units is not None else [DEPENDENCIES[n].unit if n in DEPENDENCIES else "" for n in names]
    original = blending_space(names, labels, vectors, maps, scale)
    missing = count - len(original)
    if missing < 0:
        raise InputError(f"blending_space.count = {count}: there are {len(original)} captured maps already; raise it")
    if missing == 0 or len(names) == 0:
        return original
    if not 2 <= subset <= neighbours or delta < 0:
        raise InputError(f"blending_space: needs 2 <= subset ({subset}) <= neighbours ({neighbours}) and delta ({delta}) >= 0")
    floor = [DEPENDENCIES[n].minimum if n in DEPENDENCIES else -np.inf for n in names] if minimum is None else minimum
    parents, shares, blended = _candidates(
        original, candidates_per_entry * missing, min(neighbours, len(original)), subset, delta, np.asarray(floor), rng
    )
    # Walks that are alike in all dependencies are one place.
    places = np.unique(scale.apply(original.vectors), axis=0)
    chosen = _farthest_first(places, scale.apply(blended), missing)
    return _extend(original, parents[chosen], shares[chosen], blended[chosen])


def _candidates(
    space: BlendingSpace, wanted: int, neighbours: int, subset: int, delta: float, floor: Array, rng: np.random.Generator
) -> tuple[Indices, Array, Array]:
    size = min(subset, neighbours)
    low, high = space.vectors.min(axis=0), space.vectors.max(axis=0)
    found: list[tuple[Indices, Array, Array]] = []
    count = 0
    for _ in range(100 * (1 + wanted // BATCH)):
        anchors = rng.uniform(low, high, (BATCH, len(space.names)))
        near = space.nearest(anchors, neighbours)[0]
        picked = np.argsort(rng.random(near.shape), axis=1)[:, :size]
        parents = np.take_along_axis(near, picked, axis=1)
        shares = _blend_weights(BATCH, size, delta, rng)
        blended = np.einsum("ws,wsd->wd", shares, space.vectors[parents])
        possible = np.all(blended >= floor - ROUNDING, axis=1)
        found.append((parents[possible], shares[possible], np.maximum(blended[possible], floor)))
        count += int(possible.sum())
        if count >= wanted:
            parents, shares, blended = (np.concatenate(part) for part in zip(*found, strict=True))
            return parents[:wanted], shares[:wanted], blended[:wanted]
    raise InputError("blending_space: hardly any blend of these walks is physically possible; lower delta")


def _blend_weights(rows: int, size: int, delta: float, rng: np.random.Generator) -> Array:
    """Uniform over ``{w : sum w = 1, -delta <= w_j <= 1 + delta}``: a stretched simplex, its far corners cut off."""
    drawn = np.empty((rows, size))
    open_rows = np.arange(rows)
    while open_rows.size:
        drawn[open_rows] = rng.dirichlet(np.ones(size), open_rows.size) * (1 + size * delta) - delta
        open_rows = open_rows[drawn[open_rows].max(axis=1) > 1 + delta]
    return drawn


@njit(cache=True)
def _lower_gaps(tree: Tree, at: Array, gaps: Array, highest: Array, place: Indices) -> None:
    """Lower the squared distance of each candidate to its nearest entry, now that there is one ``at`` this place.

    Parameters
    ----------
    tree : points, order and boxes of a search tree over the candidates; branches that are too far away are left alone
    gaps : (N,) squared distances, in the order of the leaves
    highest, place : of each node, its largest gap and the leaf position of the candidate that has it (lowest index on ties)
    """
    points, order, boxes = tree
    inner = len(boxes) // 2
    waiting = np.empty((DEEPEST, 3), np.int64)  # node and the range of its points
    waiting[0] = 0, 0, len(points)
    parents = np.empty(inner, np.int64)
    depth, passed = 1, 0
    while depth:
        depth -= 1
        node, first, last = waiting[depth]
        if gap_to_box(boxes[node], at) > highest[node]:
            continue
        if node < inner:
            parents[passed] = node
            passed += 1
            middle = (first + last) // 2
            waiting[depth] = 2 * node + 1, first, middle
            waiting[depth + 1] = 2 * node + 2, middle, last
            depth += 2
            continue
        highest[node], place[node] = -np.inf, first
        for i in range(first, last):
            square = 0.0
            for axis in range(len(at)):
                square += (points[i, axis] - at[axis]) ** 2
            gaps[i] = min(gaps[i], square)
            if gaps[i] > highest[node] or (gaps[i] == highest[node] and order[i] < order[place[node]]):
                highest[node], place[node] = gaps[i], i
    for j in range(passed - 1, -1, -1):
        left, right = 2 * parents[j] + 1, 2 * parents[j] + 2
        tied = highest[left] == highest[right]
        better = order[place[right]] < order[place[left]] if tied else highest[right] > highest[left]
        chosen = right if better else left
        highest[parents[j]], place[parents[j]] = highest[chosen], place[chosen]


@njit(cache=True)
def _chosen(tree: Tree, existing: Array, count: int) -> Indices:
    points, order, boxes = tree
    gaps, highest, place = np.full(len(points), np.inf), np.full(len(boxes), np.inf), np.zeros(len(boxes), np.int64)
    for i in range(len(existing)):
        _lower_gaps(tree, existing[i], gaps, highest, place)
    chosen = np.empty(count, np.int64)
    for step in range(count):
        best = place[0]
        chosen[step] = order[best]
        gaps[best] = -1.0  # never twice
        _lower_gaps(tree, points[best], gaps, highest, place)
    return chosen


def _farthest_first(existing: Array, candidates: Array, count: int) -> Indices:
    """Indices of ``count`` of (N, D) candidates, each the farthest from all entries chosen before it (lowest index on ties)."""
    tree = search_tree(candidates)
    return _chosen((tree.points, tree.order, tree.boxes), existing, count)


def _extend(space: BlendingSpace, parents: Indices, shares: Array, vectors: Array) -> BlendingSpace:
    from scipy.sparse import csr_array  # late, as above

    blends, size = parents.shape
    mixing = csr_array((shares.ravel(), parents.ravel(), np.arange(0, blends * size + 1, size)), shape=(blends, len(space)))
    maps = np.clip(mixing @ space.maps, *MAP_RANGE)
    own = np.full((len(space), size), -1, dtype=np.int64)
    own[:, 0] = np.arange(len(space))
    own_shares = np.zeros((len(space), size))
    own_shares[:, 0] = 1.0
    return replace(
        space,
        vectors=np.concatenate([space.vectors, vectors]),
        maps=np.concatenate([space.maps, maps]),
        parents=np.concatenate([own, parents]),
        parent_weights=np.concatenate([own_shares, shares]),
    )
