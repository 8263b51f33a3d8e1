import numpy as np
import pandas as pd
import pytest
from scipy.spatial import Delaunay

from walklab.errors import InputError
from walklab.geometry import curves
from walklab.steering.dependencies import DEPENDENCIES, dependency_vectors, fit_domain, fit_scaling, smoothed_route

NAMES = ("length", "curvature", "height", "start_speed")


@pytest.fixture
def walks():
    rng = np.random.default_rng(0)
    columns = {d.column: rng.uniform(1, 2, 3) for d in DEPENDENCIES.values()}
    return pd.DataFrame({"walk": ["w0", "w1", "w2"], "duration_s": rng.random(3), "end_speed_m_s": rng.random(3), **columns})


@pytest.fixture
def routes():
    corner = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    return {"w0": np.array([[0.0, 0.0], [3.0, 4.0]]), "w1": corner, "w2": corner * 0.5}


def test_planned_vectors_of_a_straight_and_a_bent_route(walks, routes):
    vectors = dependency_vectors(walks, routes, NAMES, curvature_scale_m=0.1)
    assert list(vectors.columns) == list(NAMES)
    assert list(vectors.index) == ["w0", "w1", "w2"]
    assert vectors.loc["w0", "length"] == pytest.approx(5.0, abs=1e-9)
    assert vectors.loc["w0", "curvature"] == pytest.approx(0.0, abs=1e-9)
    # A right angle in 4 m, cut a little by the smoothing.
    assert vectors.loc["w1", "length"] == pytest.approx(4.0, abs=0.03)
    assert vectors.loc["w1", "curvature"] == pytest.approx(np.pi / 2 / 4, rel=0.03)
    assert vectors.loc["w2", "curvature"] == pytest.approx(np.pi / 2 / 2, rel=0.05)
    assert vectors["height"].tolist() == walks["height_m"].tolist()


def test_run_time_vectors_do_not_read_how_the_walk_was_walked(walks, routes):
    before = dependency_vectors(walks, routes, NAMES)
    changed = walks.assign(duration_s=9.0, length_m=99.0, curvature_1_m=99.0, end_speed_m_s=9.0)
    samples = {walk: np.random.default_rng(1).random((50, 2)) for walk in routes}
    assert dependency_vectors(changed, routes, NAMES, samples=samples).equals(before)
    bare = walks[["walk", "height_m", "start_speed_m_s"]]
    assert dependency_vectors(bare, routes, NAMES, samples=samples).equals(before)
    # The same change does alter the captured index, so that this test can fail.
    captured = dependency_vectors(walks, routes, NAMES, "captured")
    assert not dependency_vectors(changed, routes, NAMES, "captured").equals(captured)


def test_captured_vectors_are_those_of_the_walks_table(walks):
    vectors = dependency_vectors(walks, None, NAMES, "captured")
    assert np.array_equal(vectors.to_numpy(), walks[[DEPENDENCIES[name].column for name in NAMES]].to_numpy())


def test_sample_sum_curvature_is_offered_for_both(walks, routes):
    planned = dependency_vectors(walks, routes, ("curvature",), curvature="sample_sum")
    assert planned.loc["w1", "curvature"] == pytest.approx(curves.sample_sum_curvature(smoothed_route(routes["w1"])))
    arc = np.linspace(0, np.pi / 2, 100)
    samples = dict.fromkeys(routes, np.column_stack([np.cos(arc), np.sin(arc)]))
    captured = dependency_vectors(walks, None, ("curvature",), "captured", curvature="sample_sum", samples=samples)
    # 100 samples of curvature 1 / 1 m over a length of pi / 2.
    assert captured["curvature"].to_numpy() == pytest.approx(100 / (np.pi / 2), rel=0.01)


def test_what_is_missing_is_named(walks, routes):
    with pytest.raises(InputError, match="age"):
        dependency_vectors(walks, routes, ("age",))
    with pytest.raises(InputError, match="w1"):
        dependency_vectors(walks, {"w0": routes["w0"]}, ("length",))
    with pytest.raises(InputError, match="height_m"):
        dependency_vectors(walks.drop(columns="height_m"), routes, ("height",))


def test_scaling_weighs_participants_the_same():
    rng = np.random.default_rng(0)
    people = {"A": rng.normal(0, 1, (10, 2)), "B": rng.normal(3, 2, (10, 2))}
    once = fit_scaling(np.concatenate(list(people.values())), ["A"] * 10 + ["B"] * 10)
    # Five times the walks of A, the same walks: nothing changes.
    often = fit_scaling(np.concatenate([np.tile(people["A"], (5, 1)), people["B"]]), ["A"] * 50 + ["B"] * 10)
    assert often.scale == pytest.approx(once.scale)
    assert often.offset == pytest.approx(once.offset)
    assert once.apply(np.concatenate(list(people.values()))).std(axis=0) == pytest.approx([1, 1])


def test_a_dependency_without_spread_is_left_unscaled():
    assert fit_scaling(np.column_stack([np.full(5, 1.7), np.arange(5.0)])).scale[0] == 1.0


@pytest.mark.parametrize("dimensions", [2, 3, 4])
def test_inside_is_inside_the_convex_hull(dimensions):
    rng = np.random.default_rng(dimensions)
    training = rng.normal(size=(60, dimensions)) * [1, 100, 0.01, 1][:dimensions]
    asked = rng.normal(size=(500, dimensions)) * [1, 100, 0.01, 1][:dimensions]
    scaling = fit_scaling(training)
    expected = Delaunay(scaling.apply(training)).find_simplex(scaling.apply(asked)) >= 0
    found = fit_domain(training, scaling).inside(asked)
    assert np.array_equal(found, expected)
    assert 0 < expected.sum() < 500
    assert fit_domain(training, scaling).inside(training).all()


def test_one_dependency_gives_an_interval():
    training = np.array([[2.0], [0.5], [4.0]])
    domain = fit_domain(training, fit_scaling(training))
    assert domain.inside([[0.5], [4.0], [3.0], [0.49], [4.01]]).tolist() == [True, True, True, False, False]


def test_directions_without_spread_are_projected_out():
    # Curvature is zero throughout, height is tied to length: the cloud is a line in three dimensions.
    along = np.linspace(0, 1, 20)
    training = np.column_stack([1 + 3 * along, np.zeros(20), 1.6 + 0.3 * along])
    domain = fit_domain(training, fit_scaling(training))
    asked = [[2.5, 0, 1.75], [2.5, 0.1, 1.75], [2.5, 0, 1.9], [5.5, 0, 2.05]]
    assert domain.inside(asked).tolist() == [True, False, False, False]


def test_a_single_vector_and_no_dependency_at_all():
    one = np.array([[1.0, 2.0]])
    assert fit_domain(one, fit_scaling(one)).inside([[1.0, 2.0], [1.0, 2.1]]).tolist() == [True, False]
    none = np.zeros((4, 0))
    assert fit_domain(none, fit_scaling(none)).inside(np.zeros((2, 0))).tolist() == [True, True]


def test_scaling_by_the_range_and_by_nothing():
    vectors = np.array([[1.0, 0.2, 1.7], [3.0, 0.8, 1.7], [2.0, 0.2, 1.7]])
    assert fit_scaling(vectors, how="range").scale == pytest.approx([2.0, 0.6, 1.0])
    assert fit_scaling(vectors, how="none").scale == pytest.approx([1.0, 1.0, 1.0])
    with pytest.raises(InputError, match="'log'; choose standard_deviation, range or none"):
        fit_scaling(vectors, how="log")
