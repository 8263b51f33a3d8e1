import dataclasses

import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator

from walklab.errors import InputError
from walklab.geometry import curves
from walklab.steering.dependencies import dependency_vectors
from walklab.steering.models import AdaptiveModel, MotionModel, StaticModel, probabilistic_model
from walklab.steering.training import TrainingSettings, train

ASKED = np.array([[0.8, 1.7], [2.2, 1.8], [3.6, 1.65]])


def generators(count, seed=0):
    return [np.random.default_rng([seed, i]) for i in range(count)]


def test_the_three_models_follow_the_protocol(model):
    static = StaticModel(("v", "a"), (0.9, 1.5))
    for each in (static, model, AdaptiveModel(model)):
        assert isinstance(each, MotionModel)
        assert each.names == ("v", "a")
        assert each.parameters(ASKED, generators(3)).shape == (3, 2)
    assert static.parameters(ASKED).tolist() == [[0.9, 1.5]] * 3


def test_the_adaptive_model_recovers_how_speed_depends_on_length(model):
    lengths = np.linspace(0.8, 3.8, 7)
    found = AdaptiveModel(model).parameters(np.column_stack([lengths, np.full(7, 1.75)]))
    # Walks were made with v = 0.5 + 0.3 l (which 1.3 m do not give the room to reach at a = 1.5); a grid step is 0.3 m/s.
    assert found[2:, 0] == pytest.approx(0.5 + 0.3 * lengths[2:], abs=0.3)
    assert np.all(np.diff(found[2:, 0]) > 0)


def test_sharpening_leads_from_the_probabilistic_to_the_adaptive_model(model):
    for vector in ASKED:
        highest = model.density(vector, model.mode(vector))[0]
        shares = []
        for exponent in (1.0, 8.0, 50.0):
            sharpened = dataclasses.replace(model, exponent=exponent)
            samples = sharpened.sample(vector, 40, np.random.default_rng(0))
            shares.append((model.density(vector, samples).mean() / highest) ** (1 / model.exponent))
        assert shares == sorted(shares)
        assert shares[-1] > 0.96


def test_the_density_is_blend_then_interpolate_then_clip_then_sharpen(model):
    points = np.random.default_rng(0).uniform(*model.space.bounds.T, (100, 2))
    for vector in ASKED:
        gaps = np.linalg.norm(model.blending.scaling.apply(model.blending.vectors) - model.blending.scaling.apply(vector), axis=1)
        near = np.argsort(gaps)[: model.k + 1]
        shares = gaps[near[-1]] - gaps[near[:-1]]
        blended = shares / shares.sum() @ model.blending.maps[near[:-1]]
        assert model.blend(vector)[0] == pytest.approx(blended, abs=1e-12)
        surface = RBFInterpolator(model.space.to_unit(model.space.cells), blended, kernel="multiquadric", epsilon=1.0)
        expected = np.maximum(surface(model.space.to_unit(points)), 0) ** 4
        assert model.density(vector, points) == pytest.approx(expected, abs=4e-5)  # coefficients are kept in single precision


def test_the_bound_covers_the_density_everywhere(model):
    points = np.random.default_rng(1).uniform(*model.space.bounds.T, (5000, 2))
    literal, sharp = (dataclasses.replace(model, exponent=exponent) for exponent in (1.0, 20.0))
    for variant in (literal, sharp, dataclasses.replace(literal, k=3), dataclasses.replace(sharp, fixed={"v": 0.85})):
        at = points.copy()
        if variant.fixed:
            at[:, 0] = 0.85
        for vector in ASKED:
            highest = variant.density(vector, np.concatenate([at, variant.mode(vector)])).max() ** (1 / variant.exponent)
            assert highest <= variant.upper_bound(vector) < 1.5 * highest


def test_a_walk_draws_from_its_own_generator_only(model):
    together = model.parameters(ASKED, generators(3))
    alone = [model.parameters(ASKED[[i]], [generators(3)[i]])[0] for i in (2, 0, 1)]
    assert np.array_equal(together[[2, 0, 1]], alone)
    assert np.array_equal(together, [model.sample(v, 1, g)[0] for v, g in zip(ASKED, generators(3), strict=True)])
    with pytest.raises(ValueError, match="one random generator per walk"):
        model.parameters(ASKED)


def test_modes_and_blends_do_not_depend_on_the_company(model):
    assert np.array_equal(model.mode(ASKED)[::-1], model.mode(ASKED[::-1]))
    assert np.array_equal(model.blend(ASKED)[[1]], model.blend(ASKED[[1]]))


def test_a_fixed_parameter_is_the_slice_of_the_map(model):
    held = dataclasses.replace(model, fixed={"a": 0.7})
    assert np.all(held.parameters(ASKED, generators(3))[:, 1] == 0.7)
    found = held.mode(ASKED)
    assert np.all(found[:, 1] == 0.7)
    line = np.column_stack([np.linspace(*model.space.bounds[0], 3001), np.full(3001, 0.7)])
    for vector, at in zip(ASKED, found, strict=True):
        assert line[np.argmax(model.density(vector, line)), 0] == pytest.approx(at[0], abs=2e-3)
    assert not np.allclose(found[:, 0], model.mode(ASKED)[:, 0], atol=1e-3)


def test_settings_that_cannot_be_are_refused(model):
    for settings, words in (
        ({"k": 201}, "model.k = 201"),
        ({"exponent": 0.0}, "exponent"),
        ({"fixed": {"omega": 1.0}}, "omega"),
        ({"fixed": {"v": 9.0}}, "outside the parameter space"),
    ):
        with pytest.raises(InputError, match=words):
            dataclasses.replace(model, **settings)


def test_a_dependency_can_be_left_out(world):
    settings = TrainingSettings("min_max", count=120, neighbours=20, subset=3, k=20)
    bare = train(world.scores, world.vectors[["height"]], world.participants, world.space, settings, np.random.default_rng(0))
    assert bare.dependencies == ("height",)
    assert bare.dependency_units == ("m",)
    assert bare.inside([[1.7], [2.0]]).tolist() == [True, False]
    # Without the length, walks of all lengths are blended alike and the speeds no longer differ.
    speeds = bare.mode([[1.65], [1.7], [1.8]])[:, 0]
    assert np.ptp(speeds) < 0.2


def test_a_model_without_dependencies_blends_all_walks(world):
    settings = TrainingSettings("min_max", count=None, k=5)
    none = train(world.scores, world.vectors[[]], world.participants, world.space, settings, np.random.default_rng(0))
    assert none.blend(np.zeros((2, 0))) == pytest.approx(np.tile(none.blending.maps.mean(axis=0), (2, 1)))
    assert none.parameters(np.zeros((4, 0)), generators(4)).shape == (4, 2)
    assert none.inside(np.zeros((4, 0))).all()


def test_inside_is_the_hull_of_the_captured_walks_not_of_their_blends(world, model):
    assert model.inside(world.vectors.to_numpy()).all()
    assert not model.inside([[4.3, 1.7]])[0]
    assert len(model.blending) == 200


def test_an_edge_optimum_is_reported_by_the_space(model):
    # Braking and speeding up at 4 m/s2 at most: where that is the best, the space says so.
    found = model.mode(ASKED)
    edges = model.space.on_edge(found)
    assert np.array_equal(edges, (found <= model.space.bounds[:, 0] + 1e-9) | (found >= model.space.bounds[:, 1] - 1e-9))


def test_the_prediction_does_not_read_the_walk_that_is_predicted(world, model):
    import pandas as pd

    routes = {"w0": np.array([[0.0, 0.0], [2.0, 0.5]]), "w1": np.array([[0.0, 0.0], [3.0, 0.0]])}
    walks = pd.DataFrame({"walk": ["w0", "w1"], "height_m": [1.7, 1.8], "start_speed_m_s": 0.0})

    def predict(samples):
        table = walks.assign(
            length_m=[curves.length(s) for s in samples.values()],
            curvature_1_m=[curves.mean_curvature(s, 0.1) for s in samples.values()],
            duration_s=[0.1 * len(s) for s in samples.values()],
        )
        vectors = dependency_vectors(table, routes, model.dependencies, samples=samples)
        return model.parameters(vectors, generators(2))

    straight = {name: np.linspace(route[0], route[-1], 50) for name, route in routes.items()}
    wild = {name: np.random.default_rng(0).random((80, 2)) for name in routes}
    assert np.array_equal(predict(straight), predict(wild))


@pytest.mark.parametrize("axes", [1, 3, 4])
def test_any_number_of_parameters(axes):
    from walklab.steering.blending_space import blending_space
    from walklab.steering.scaling import fit_scaling
    from walklab.steering.space import space_from_config

    space = space_from_config(
        [{"name": f"p{i}", "unit": "", "start": 0.0, "step": 0.5 + i, "count": 3 + i % 2} for i in range(axes)]
    )
    rng = np.random.default_rng(0)
    vectors = rng.random((12, 2))
    maps = rng.random((12, len(space.cells)))
    blending = blending_space(("x", "y"), ("", ""), vectors, maps, fit_scaling(vectors))
    model = probabilistic_model(blending, space, k=4)
    samples, modes = model.sample([0.5, 0.5], 200, rng), model.mode([[0.5, 0.5]])
    low, high = space.bounds.T
    assert samples.shape == (200, axes)
    assert np.all((samples >= low) & (samples <= high))
    assert model.density([0.5, 0.5], modes)[0] >= model.density([0.5, 0.5], samples).max()
    assert all(np.unique(column).size == 200 for column in samples.T)


def test_where_nothing_is_drawn_the_density_is_zero(model):
    low, high = model.space.bounds.T
    inside, outside = (low + high) / 2, high + np.array([0.1, 0.0])
    held = dataclasses.replace(model, fixed={"v": float(inside[0])})
    assert model.density(ASKED[0], [inside, high, outside, low - 0.1]) == pytest.approx(
        [*model.density(ASKED[0], [inside, high]), 0.0, 0.0]
    )
    assert model.density(ASKED[0], inside)[0] > 0
    assert held.density(ASKED[0], [inside, inside + np.array([0.2, 0.0])])[1] == 0.0
    assert held.density(ASKED[0], inside)[0] == model.density(ASKED[0], inside)[0]


@pytest.mark.parametrize(
    ("vector", "point"), [(ASKED[0], [1.0]), (ASKED[0], [1.0, np.nan]), (ASKED[0], [1.0, 1.0, 1.0]), (ASKED, [1.0, 1.0])]
)
def test_a_density_of_something_else_is_refused(model, vector, point):
    with pytest.raises(InputError, match="density: "):
        model.density(vector, point)


@pytest.mark.parametrize("vector", [[2.5], [2.5, 1.78, 9.0]])
def test_the_domain_is_asked_with_all_dependencies_and_no_more(model, vector):
    with pytest.raises(InputError, match="needed are"):
        model.inside(vector)
