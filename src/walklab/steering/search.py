"""Nearest neighbours in a balanced tree of boxes, compiled: microseconds among thousands of entries.

The tree is implicit: node i has the children 2i + 1 and 2i + 2, which share its entries half and half,
split across its longest side; all leaves are at the same depth. Searching keeps a short list of
candidates; whenever it is full, only the nearest are kept and the search radius shrinks to the last of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

LEAF = 32  # entries of a leaf, at most
DEEPEST = 64  # levels a search can remember; 2^64 leaves


@dataclass(frozen=True)
class SearchTree:
    """A tree over N points of D coordinates.

    Attributes
    ----------
    points : (N, D) in the order of the leaves
    order : (N,) which point of the original array each one is
    boxes : (nodes, 2, D) lowest and highest coordinates of each node
    """

    points: Array
    order: Indices
    boxes: Array

    def nearest(self, asked: Array, count: int) -> tuple[Indices, Array]:
        """Indices and distances of the ``count`` nearest points of each (W, D) asked point, nearest first.

        Points at exactly the same distance come in the order of their indices.
        """
        indices = np.empty((len(asked), count), dtype=np.int64)
        squares = np.empty((len(asked), count))
        _nearest_of_all(self.points, self.order, self.boxes, np.ascontiguousarray(asked, dtype=float), indices, squares)
        order = np.argsort(squares, axis=1)
        indices, squares = np.take_along_axis(indices, order, 1), np.take_along_axis(squares, order, 1)
        tied = np.any(np.diff(squares, axis=1) == 0, axis=1)
        if tied.any():
            order = np.lexsort((indices[tied], squares[tied]))
            indices[tied] = np.take_along_axis(indices[tied], order, 1)
        return indices, np.sqrt(squares)


def search_tree(points: Array) -> SearchTree:
    """The tree over (N, D) points."""
    coordinates = np.ascontiguousarray(points, dtype=float)
    order, boxes = _build(coordinates, LEAF)
    return SearchTree(coordinates[order], order, boxes)


@njit(cache=True, nogil=True)
def _build(points: Array, leaf: int) -> tuple[Indices, Array]:
    count, axes = points.shape
    levels = 0
    while count > leaf << levels:
        levels += 1
    order = np.arange(count)
    nodes = (2 << levels) - 1
    boxes = np.empty((nodes, 2, axes))
    begin = np.zeros(nodes, np.int64)
    end = np.zeros(nodes, np.int64)
    end[0] = count
    keys = np.empty(count)
    for node in range(nodes):
        first, last = begin[node], end[node]
        for axis in range(axes):
            low, high = np.inf, -np.inf
            for i in range(first, last):
                low, high = min(low, points[order[i], axis]), max(high, points[order[i], axis])
            boxes[node, 0, axis], boxes[node, 1, axis] = low, high
        if 2 * node + 2 >= nodes:
            continue
        longest = 0
        for axis in range(axes):
            if boxes[node, 1, axis] - boxes[node, 0, axis] > boxes[node, 1, longest] - boxes[node, 0, longest]:
                longest = axis
        middle = (first + last) // 2
        for i in range(first, last):
            keys[i] = points[order[i], longest]
        select(keys[first:last], order[first:last], middle - first)
        begin[2 * node + 1], end[2 * node + 1] = first, middle
        begin[2 * node + 2], end[2 * node + 2] = middle, last
    return order, boxes


@njit(cache=True, nogil=True)
def select(keys: Array, values: Indices, place: int) -> None:
    """Reorder so that ``keys[place]`` is what sorting would put there, nothing before it larger, nothing after smaller.

    Quickselect; the partition moves every element and counts instead of branching, since its branches cannot be predicted.
    """
    low, high = 0, len(keys)
    while high - low > 1:
        first, centre, last = keys[low], keys[(low + high) // 2], keys[high - 1]
        pivot = max(min(first, centre), min(max(first, centre), last))
        smaller = low
        for i in range(low, high):
            key, value = keys[i], values[i]
            keys[i], values[i] = keys[smaller], values[smaller]
            keys[smaller], values[smaller] = key, value
            smaller += key < pivot
        if place < smaller:
            high = smaller
            continue
        equal = smaller
        for i in range(smaller, high):
            key, value = keys[i], values[i]
            keys[i], values[i] = keys[equal], values[equal]
            keys[equal], values[equal] = key, value
            equal += key == pivot
        if place < equal:
            return
        low = equal


@njit(cache=True, nogil=True)
def gap_to_box(box: Array, at: Array) -> float:
    """Squared distance from a point to a box, 0 inside."""
    total = 0.0
    for axis in range(len(at)):
        outside = max(box[0, axis] - at[axis], at[axis] - box[1, axis], 0.0)
        total += outside * outside
    return total


@njit(cache=True, nogil=True)
def nearest(points: Array, order: Indices, boxes: Array, at: Array, count: int, indices: Indices, squares: Array) -> None:
    """The ``count`` nearest points in no particular order, except that the farthest of them comes last.

    Parameters
    ----------
    at : (D,) asked point
    indices, squares : at least ``room(count)`` long; the first ``count`` are filled with original indices and squared distances
    """
    inner = len(boxes) // 2
    full = room(count) - LEAF
    waiting = np.empty((DEEPEST, 3), np.int64)  # node and the range of its points
    gaps = np.empty(DEEPEST)
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = 0, 0, len(points)
    gaps[0] = 0.0
    depth, found, radius = 1, 0, np.inf
    while depth > 0:
        depth -= 1
        node, first, last = waiting[depth]
        if gaps[depth] > radius:
            continue
        while node < inner:  # down into the nearer half; the other one waits
            near, far = 2 * node + 1, 2 * node + 2
            middle = (first + last) // 2
            to_near, to_far = gap_to_box(boxes[near], at), gap_to_box(boxes[far], at)
            if to_far < to_near:
                near, far, to_near, to_far = far, near, to_far, to_near
            lower_is_near = near < far
            if to_far <= radius:
                waiting[depth, 0] = far
                waiting[depth, 1], waiting[depth, 2] = (middle, last) if lower_is_near else (first, middle)
                gaps[depth] = to_far
                depth += 1
            node = near
            first, last = (first, middle) if lower_is_near else (middle, last)
        for i in range(first, last):
            square = 0.0
            for axis in range(len(at)):
                gap = points[i, axis] - at[axis]
                square += gap * gap
            squares[found], indices[found] = square, order[i]
            found += square <= radius
        if found > full:
            select(squares[:found], indices[:found], count - 1)
            found, radius = count, squares[count - 1]
    select(squares[:found], indices[:found], count - 1)


@njit(cache=True, nogil=True)
def room(count: int) -> int:
    """Length of the list of candidates for the ``count`` nearest."""
    return count + count // 2 + 2 * LEAF


@njit(cache=True, nogil=True)
def _nearest_of_all(points: Array, order: Indices, boxes: Array, asked: Array, indices: Indices, squares: Array) -> None:
    count = indices.shape[1]
    some, gaps = np.empty(room(count), np.int64), np.empty(room(count))
    for row in range(len(asked)):
        nearest(points, order, boxes, asked[row], count, some, gaps)
        indices[row], squares[row] = some[:count], gaps[:count]
