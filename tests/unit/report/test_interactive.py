"""What the page's view of maps and its players are given: the model's own answers and the trials' own walks."""

import base64

import figure_inputs
import numpy as np
import pytest
from report_contents import constant, scene, small_model, trials_of, walk

from walklab.report.map_lattice import DRAWS, POINTS, drawn, lattice_axes, map_lattice, shown_grid, steps_of
from walklab.report.shown_walks import FRAME_S, chosen
from walklab.steering.space import Axis, ParameterSpace


def decoded(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype=np.uint8)


def space_of(axes: int) -> ParameterSpace:
    return ParameterSpace(tuple(Axis(name, "1", (0.1, 0.5, 0.9)) for name in "abcd"[:axes]))


def test_each_lattice_point_holds_the_models_own_map():
    model = small_model()
    data = map_lattice(model, {"P_Prob": constant(model.exponent)}, np.random.default_rng(0))
    values = [axis["values"] for axis in data["dependencies"]]
    maps = decoded(data["maps"]).reshape(*map(len, values), -1)
    for at in ((0, 0, 0), (5, 3, 2), (11, 9, 4)):
        vector = [lattice_axes(model.blending.vectors)[axis][index] for axis, index in enumerate(at)]
        assert maps[at] / 255 == pytest.approx(model.blend(vector)[0], abs=0.5 / 255 + 1e-9)


def test_draws_and_modes_are_the_models_own():
    model = small_model(exponent=4.0)
    data = map_lattice(model, {"P_Prob": constant(model.exponent)}, np.random.default_rng(7))
    points = np.stack(np.meshgrid(*lattice_axes(model.blending.vectors), indexing="ij"), axis=-1).reshape(-1, 3)
    low, high = model.space.bounds.T
    expected = model.sample_batch(points, DRAWS, np.random.default_rng(7))
    found = low + decoded(data["models"][0]["draws"]).reshape(expected.shape) / 255 * (high - low)
    assert found == pytest.approx(expected, abs=(high - low).max() * 0.5 / 255 + 1e-9)
    modes = low + decoded(data["modes"]).reshape(-1, 3) / 255 * (high - low)
    assert modes == pytest.approx(model.mode(points), abs=(high - low).max() * 0.5 / 255 + 1e-9)
    assert data["inside"] == "".join("01"[bool(each)] for each in model.domain.inside(points))


def test_each_point_is_drawn_with_its_own_exponent():
    model = small_model()
    points = np.repeat(figure_inputs.vectors()[:2], 2, axis=0)
    draws = drawn(model, points, np.array([1.0, 200.0, 1.0, 200.0]), np.random.default_rng(0))
    blunt, sharp, blunt_too, sharp_too = (model.density(point, own).mean() for point, own in zip(points, draws, strict=True))
    assert sharp > 1.2 * blunt
    assert sharp_too > 1.2 * blunt_too


@pytest.mark.parametrize("count", range(7))
def test_the_lattice_stays_small_for_any_number_of_dependencies(count):
    assert np.prod(steps_of(count), dtype=float) <= POINTS


def test_a_dependency_without_spread_has_one_value():
    vectors = figure_inputs.vectors()
    vectors[:, 1] = 0.0
    assert [len(axis) for axis in lattice_axes(vectors)] == [12, 1, 5]


@pytest.mark.parametrize("axes", [1, 2, 4])
def test_spaces_of_other_dimensions_are_shown_over_three(axes):
    space = space_of(axes)
    maps = np.random.default_rng(0).random((2, len(space.cells)))
    shown = shown_grid(maps, space)
    assert shown.shape[0] == 2
    assert shown.ndim == 4
    if axes == 4:
        assert shown == pytest.approx(maps.reshape(2, 3, 3, 3, 3).max(axis=-1))
    else:
        assert sorted(shown[0].ravel()) == sorted(maps[0])


def test_walks_stand_where_they_were_captured_and_simulated():
    data = scene("scenario_1")
    walks = [walk(number) for number in range(4)]
    assert [each["walk"] for each in data["walks"]] == [str(each.row["walk"]) for each in walks]
    for shown, original in zip(data["walks"], walks, strict=True):
        places = np.array(shown["captured"]).reshape(-1, 2) / 100
        times = np.minimum(np.arange(len(places)) * FRAME_S, original.time_s[-1])
        assert places[:, 0] == pytest.approx(np.interp(times, original.time_s, original.position_m[:, 0]), abs=0.0051)
        assert places[-1] == pytest.approx(original.position_m[-1], abs=0.0051)
        for trial in shown["trials"]:
            # The planner of these tests walks 2 m at v; the player must last as long as the trial says.
            assert (len(trial["path"]) / 2 - 1) * FRAME_S == pytest.approx(trial["simulated_s"], abs=FRAME_S + 1 / 60)
    assert [trial["collided"] for trial in data["walks"][0]["trials"]] == trials_of(walks)["collided"].tolist()[:4]


def test_walks_of_every_kind_are_chosen_evenly():
    walks = [walk(number, configuration="a" if number % 2 else "b") for number in range(100)]
    picked = chosen(walks, per_kind=5)
    assert len(picked) == len(set(picked)) == 10
    kinds = [walks[index].row["configuration"] for index in picked]
    assert kinds.count("a") == kinds.count("b") == 5
    assert {0, 1, 98, 99} <= set(picked)
    assert chosen(walks[:3], per_kind=5) == [0, 2, 1]
