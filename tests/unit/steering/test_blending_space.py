import numpy as np
import pytest

from walklab.errors import InputError
from walklab.steering.blending_space import _farthest_first, blending_space, homogenise
from walklab.steering.density import density
from walklab.steering.scaling import fit_scaling
from walklab.steering.weighting import weights

NAMES = ("length", "curvature", "height")


@pytest.fixture(scope="module")
def captured():
    """Walks as clustered as the paper's: eight lengths, straight or bent, fifteen heights."""
    rng = np.random.default_rng(3)
    length = np.repeat(np.arange(0.5, 4.1, 0.5), 30) + rng.normal(0, 0.01, 240)
    curvature = np.where(length > 2.8, rng.choice([0, 0.25, 0.5, 1.0], 240), 0.0)
    height = np.tile(np.linspace(1.65, 1.9, 15), 16)
    return np.column_stack([length, curvature, height]), rng.random((240, 50))


@pytest.fixture(scope="module")
def filled(captured):
    return homogenise(*captured, 900, 30, 4, 0.1, np.random.default_rng(0), names=NAMES)


def test_captured_entries_are_kept(captured, filled):
    assert len(filled) == 900
    assert np.array_equal(filled.vectors[:240], captured[0])
    assert np.array_equal(filled.maps[:240], captured[1])
    assert filled.is_blend.tolist() == [False] * 240 + [True] * 660
    assert filled.units == ("m", "1/m", "m")


def test_every_entry_is_the_blend_that_its_bookkeeping_says(filled):
    for entry in range(len(filled)):
        used = filled.parents[entry] >= 0
        parents, shares = filled.parents[entry][used], filled.parent_weights[entry][used]
        assert parents.max() < 240
        assert len(set(parents)) == len(parents)
        assert filled.vectors[entry] == pytest.approx(shares @ filled.vectors[parents], abs=2e-9)
        assert filled.maps[entry] == pytest.approx(np.clip(shares @ filled.maps[parents], 0, 1), abs=1e-12)


def test_blend_weights_sum_to_one_and_extrapolate_by_delta_at_most(filled):
    shares = filled.parent_weights[filled.is_blend]
    assert shares.sum(axis=1) == pytest.approx(np.ones(660))
    assert shares.min() >= -0.1 - 1e-12
    assert shares.max() <= 1.1 + 1e-12
    assert (shares < 0).any()
    assert (shares > 1).any()


def test_blends_stay_physically_possible(filled):
    assert filled.vectors.min() >= 0
    assert filled.maps.min() >= 0
    assert filled.maps.max() <= 1


def test_parents_are_near_each_other(filled):
    scaled = filled.scaling.apply(filled.vectors)
    strangers = np.random.default_rng(0).integers(0, 240, (660, 4))
    spread, by_chance = (np.ptp(scaled[rows], axis=1).mean() for rows in (filled.parents[filled.is_blend], strangers))
    assert spread < 0.75 * by_chance


def test_the_density_becomes_more_even(captured, filled):
    before, after = density(captured[0], filled.scaling, 20), density(filled.vectors, filled.scaling, 20)
    assert after["entries"] == 900
    assert after["nearest_cv"] < 0.7 * before["nearest_cv"]
    assert after["kth_median"] < before["kth_median"]
    # As many random blends, without choosing the farthest, do not get there.
    random = homogenise(*captured, 900, 30, 4, 0.1, np.random.default_rng(0), names=NAMES, candidates_per_entry=1)
    assert after["nearest_cv"] < 0.7 * density(random.vectors, filled.scaling, 20)["nearest_cv"]


def test_each_chosen_blend_is_the_farthest_candidate():
    # One dependency, walks at 0 and 1: the chosen blends must spread over the interval, not pile up.
    vectors, maps = np.array([[0.0], [1.0]]), np.array([[0.0, 1.0], [1.0, 0.0]])
    space = homogenise(
        vectors, maps, 9, 2, 2, 0.0, np.random.default_rng(0), names=("x",), units=("m",), candidates_per_entry=500
    )
    # Halving the widest gap each time gives eighths.
    assert np.sort(space.vectors[:, 0]) == pytest.approx(np.arange(9) / 8, abs=0.01)


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_pruned_choices_equal_brute_force_with_ties(dimensions):
    rng = np.random.default_rng(dimensions)
    existing, candidates = (rng.normal(size=(n, dimensions)).round(1) for n in (20, 700))
    gaps = np.min([np.sum((candidates - point) ** 2, axis=1) for point in existing], axis=0)
    expected = []
    for _ in range(690):
        expected.append(int(np.argmax(gaps)))
        gaps = np.minimum(gaps, np.sum((candidates - candidates[expected[-1]]) ** 2, axis=1))
        gaps[expected[-1]] = -1.0
    assert _farthest_first(existing, candidates, 690).tolist() == expected


def test_same_generator_same_blends(captured):
    first, second = (homogenise(*captured, 300, 30, 4, 0.1, np.random.default_rng(7), names=NAMES) for _ in range(2))
    assert np.array_equal(first.vectors, second.vectors)
    assert np.array_equal(first.maps, second.maps)


def test_nothing_is_added_without_need_or_without_dependencies(captured):
    vectors, maps = captured
    rng = np.random.default_rng(0)
    assert not homogenise(vectors, maps, 240, 30, 4, 0.1, rng, names=NAMES).is_blend.any()
    assert len(homogenise(np.zeros((240, 0)), maps, 900, 30, 4, 0.1, rng, names=())) == 240
    with pytest.raises(InputError, match="count = 100"):
        homogenise(vectors, maps, 100, 30, 4, 0.1, rng, names=NAMES)
    with pytest.raises(InputError, match="subset"):
        homogenise(vectors, maps, 300, 3, 4, 0.1, rng, names=NAMES)


def test_nearest_equals_brute_force(filled):
    asked = np.random.default_rng(2).uniform([0.5, 0, 1.6], [4, 1, 2.0], (40, 3))
    indices, distances = filled.nearest(asked, 25)
    gaps = np.linalg.norm(filled.scaling.apply(asked)[:, None] - filled.scaling.apply(filled.vectors)[None], axis=2)
    assert distances == pytest.approx(np.sort(gaps, axis=1)[:, :25])
    assert np.take_along_axis(gaps, indices, 1) == pytest.approx(distances)


def test_neighbours_weigh_by_the_distance_to_the_next_one(filled):
    asked = np.array([[2.2, 0.1, 1.77]])
    indices, shares = filled.neighbours(asked, 10)
    near, distances = filled.nearest(asked, 11)
    expected = distances[0, 10] - distances[0, :10]
    assert np.array_equal(indices, near[:, :10])
    assert shares[0] == pytest.approx(expected / expected.sum())


def test_weights():
    near = np.array([[0.0, 1.0, 3.0], [2.0, 2.0, 2.0]])
    assert weights(near, "linear", beyond=[5.0, 2.0]) == pytest.approx(np.array([[5 / 11, 4 / 11, 2 / 11], [1 / 3] * 3]))
    assert weights(near, "linear")[0] == pytest.approx([0.5, 0.375, 0.125])  # d_max = 3 (1 + 1/3)
    assert weights(near, "uniform") == pytest.approx(np.full((2, 3), 1 / 3))
    assert weights(near[:, 1:], "inverse")[0] == pytest.approx([0.75, 0.25])
    assert weights(near, "inverse")[0] == pytest.approx([1, 0, 0], abs=1e-9)
    assert weights([[0.7]], "linear") == pytest.approx(np.array([[1.0]]))
    with pytest.raises(InputError, match="cubic"):
        weights(near, "cubic")


def test_a_map_enters_a_blend_without_a_jump(filled):
    # Walking through the space, the blend must change continuously although neighbours come and go.
    path = np.linspace([0.8, 0.0, 1.7], [3.5, 0.3, 1.8], 4001)
    indices, shares = filled.neighbours(path, 12)
    blends = np.array([share @ filled.maps[index] for index, share in zip(indices, shares, strict=True)])
    assert np.abs(np.diff(blends, axis=0)).max() < 0.03


def test_without_dependencies_all_maps_count_the_same(captured):
    space = blending_space((), (), np.zeros((240, 0)), captured[1], fit_scaling(np.zeros((240, 0))))
    indices, shares = space.neighbours(np.zeros((2, 0)), 10)
    assert shares @ space.maps[indices[0]] == pytest.approx(np.tile(captured[1].mean(axis=0), (2, 1)))


def test_questions_that_do_not_fit_are_refused(filled):
    with pytest.raises(InputError, match="k = 901"):
        filled.nearest([[1, 0, 1.7]], 901)
    with pytest.raises(InputError, match="2 values"):
        filled.nearest([[1, 0]], 5)
    with pytest.raises(InputError, match="row 0, height is nan"):
        filled.nearest([[1, 0, np.nan]], 5)
    with pytest.raises(InputError, match="do not fit"):
        blending_space(("length",), ("m",), np.zeros((4, 1)), np.zeros((5, 9)), fit_scaling(np.zeros((4, 1))))
