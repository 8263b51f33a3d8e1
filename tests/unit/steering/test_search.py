"""The compiled neighbour search against brute force and against scikit-learn."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from sklearn.neighbors import KDTree

from walklab.steering.blending import WEIGHTINGS, blend, blend_up, parents_of
from walklab.steering.blending_space import blending_space
from walklab.steering.bounds import rungs_above
from walklab.steering.scaling import Scaling
from walklab.steering.search import search_tree, select


def brute_force(points, asked, count):
    gaps = np.linalg.norm(points - asked, axis=1)
    order = np.lexsort((np.arange(len(points)), gaps))[:count]
    return order, gaps[order]


@pytest.mark.parametrize("axes", [1, 2, 3, 5])
@pytest.mark.parametrize("entries", [1, 2, 24, 25, 333, 5000])
def test_equals_brute_force_and_scikit_learn(axes, entries):
    rng = np.random.default_rng(axes * entries)
    points = rng.normal(size=(entries, axes))
    tree = search_tree(points)
    asked = np.concatenate([rng.normal(size=(20, axes)), points[:5], 50 + rng.normal(size=(2, axes))])
    for count in {1, min(7, entries), min(101, entries), entries}:
        indices, distances = tree.nearest(asked, count)
        theirs, other = KDTree(points).query(asked, count)[::-1]
        assert np.array_equal(indices, theirs)
        assert distances == pytest.approx(other, abs=1e-12)
        for row, vector in enumerate(asked):
            assert np.array_equal(indices[row], brute_force(points, vector, count)[0])


@settings(max_examples=60, deadline=None)
@given(arrays(float, st.tuples(st.integers(1, 80), st.integers(1, 3)), elements=st.integers(0, 3).map(float)), st.data())
def test_distances_are_right_where_many_points_coincide(points, data):
    count = data.draw(st.integers(1, len(points)))
    asked = np.array([data.draw(st.lists(st.floats(-1, 4), min_size=points.shape[1], max_size=points.shape[1]))])
    indices, distances = search_tree(points).nearest(asked, count)
    assert len(set(indices[0])) == count
    assert distances[0] == pytest.approx(brute_force(points, asked[0], count)[1], abs=1e-12)
    assert distances[0] == pytest.approx(np.linalg.norm(points[indices[0]] - asked[0], axis=1), abs=1e-12)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.integers(0, 9), min_size=1, max_size=60), st.data())
def test_selection_puts_the_right_key_in_its_place(keys, data):
    place = data.draw(st.integers(0, len(keys) - 1))
    mixed, carried = np.array(keys, dtype=float), np.arange(len(keys))
    select(mixed, carried, place)
    assert mixed[place] == sorted(keys)[place]
    assert (mixed[:place] <= mixed[place]).all()
    assert (mixed[place:] >= mixed[place]).all()
    assert np.array_equal(np.array(keys)[carried], mixed)


@pytest.mark.parametrize("how", WEIGHTINGS)
@pytest.mark.parametrize("k", [1, 9, 200])
def test_compiled_parents_equal_the_blending_spaces(how, k):
    rng = np.random.default_rng(2)
    vectors = rng.random((200, 3))
    scaling = Scaling(np.array([0.5, 0.2, 0.0]), np.array([0.3, 2.0, 1.0]))
    space = blending_space(("x", "y", "z"), ("", "", ""), vectors, rng.random((200, 4)), scaling)
    tree = space.tree
    for vector in (*rng.random((5, 3)), vectors[3]):
        indices, shares = parents_of(
            vector, scaling.offset, scaling.scale, tree.points, tree.order, tree.boxes, k, WEIGHTINGS[how]
        )
        expected, weights = space.neighbours(vector, k, how)
        order = np.argsort(indices)
        again = np.argsort(expected[0])
        assert np.array_equal(indices[order], expected[0][again])
        assert shares[order] == pytest.approx(weights[0][again], abs=1e-9)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_blends_are_weighted_sums_and_blended_bounds_stay_above_them(dtype):
    rng = np.random.default_rng(0)
    for count in (1, 3, 4, 9, 100):
        rows = rng.random((120, 37)).astype(dtype)
        indices, shares = rng.choice(120, count, replace=False), rng.dirichlet(np.ones(count))
        exact = shares @ rows[indices].astype(float)
        assert blend(rows, indices, shares) == pytest.approx(exact, abs=1e-12)
        rungs, unit = rungs_above(rows)
        above = blend_up(rungs, unit, indices, shares)
        assert (above >= exact).all()
        assert (above <= exact * (1 + 1e-4) + unit).all()


def test_rungs_cover_what_they_round():
    values = np.concatenate([np.linspace(-0.3, 1.7, 1001), [0.0, 1e-12]])[None]
    rungs, unit = rungs_above(values)
    assert (rungs * unit >= values).all()
    assert (rungs * unit <= np.maximum(values, 0) + unit * 1.001).all()
    assert rungs_above(np.full((2, 3), -1.0))[0].max() == 0
