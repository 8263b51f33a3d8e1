"""Leave-one-out errors on constructed blending spaces and against brute force."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import RBFInterpolator

from walklab.errors import InputError
from walklab.evaluation.leave_one_out import (
    k_nearest_errors,
    left_out_cell_errors,
    left_out_participant_errors,
    rbf_errors,
    summarise_leave_one_out,
)
from walklab.steering.blending_space import BlendingSpace, blending_space, homogenise
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.scaling import Scaling
from walklab.steering.training import TrainingSettings
from walklab.steering.weighting import weights

ONE = Scaling(np.zeros(1), np.ones(1))


def line(count: int, cells: int = 7, slope: float = 0.01) -> BlendingSpace:
    """Maps that rise linearly along one dependency: the mean of two equally near neighbours is exact."""
    at = np.arange(count, dtype=float)[:, None]
    return blending_space(["length"], ["m"], at, 0.2 + slope * at + np.linspace(0, 0.1, cells), ONE)


def test_linear_maps_are_predicted_exactly_between_neighbours_and_missed_by_the_slope_at_the_ends() -> None:
    errors = k_nearest_errors(line(11), 2, "uniform")["error_percent"].to_numpy()
    np.testing.assert_allclose(errors[1:-1], 0.0, atol=1e-12)
    # At an end the two nearest are 1 and 2 steps inside: 1.5 steps of 1 % off, towards the inside.
    np.testing.assert_allclose(errors[[0, -1]], [1.5, -1.5], atol=1e-12)


@pytest.mark.parametrize(("k", "how"), [(1, "linear"), (5, "linear"), (5, "inverse"), (18, "linear"), (19, "linear")])
def test_errors_equal_those_of_spaces_built_without_each_map(k: int, how: str) -> None:
    rng = np.random.default_rng(0)
    vectors, maps = rng.uniform(1, 5, (20, 1)), rng.random((20, 9))
    found = k_nearest_errors(blending_space(["length"], ["m"], vectors, maps, ONE), k, how)["error_percent"]  # type: ignore[arg-type]
    for index, error in enumerate(found):
        rest = np.arange(20) != index
        smaller = blending_space(["length"], ["m"], vectors[rest], maps[rest], ONE)
        near, shares = smaller.neighbours(vectors[[index]], k, how)  # type: ignore[arg-type]
        assert error == pytest.approx(100 * np.median(shares[0] @ smaller.maps[near[0]] - maps[index]), abs=1e-9)


def test_a_map_is_never_its_own_neighbour_where_many_share_a_vector() -> None:
    maps = np.zeros((6, 4))
    maps[2] = 1.0
    space = blending_space(["length"], ["m"], np.ones((6, 1)), maps, ONE)
    errors = k_nearest_errors(space, 3, "uniform")["error_percent"].to_numpy()
    assert errors[2] == -100.0


def test_blends_count_to_the_participant_of_their_largest_parent() -> None:
    rng = np.random.default_rng(1)
    vectors, maps = rng.uniform(1, 5, (12, 1)), rng.random((12, 5))
    space = homogenise(vectors, maps, 20, 4, 2, 0.1, rng, names=("length",), scaling=ONE, minimum=[-np.inf])
    people = [f"P{i % 3}" for i in range(12)]
    table = k_nearest_errors(space, 3, participants=people)
    assert list(table["participant"][:12]) == people
    assert table["is_blend"].sum() == 8
    parent = space.parents[15, np.argmax(space.parent_weights[15])]
    assert table["participant"][15] == people[parent]


def test_too_many_neighbours_are_refused() -> None:
    with pytest.raises(InputError, match="k = 11 needs at least 12 maps"):
        k_nearest_errors(line(11), 11)


def test_leaving_a_participant_out_removes_the_leak_that_leaving_a_map_out_has() -> None:
    # Everybody walks the same lengths; P0 alone is worst where the others are best.
    lengths = np.tile(np.arange(1.0, 6.0), 4)
    people = np.repeat([f"P{i}" for i in range(4)], 5)
    one, other = np.linspace(0, 1, 9), np.linspace(1, 0, 9) ** 3
    scores = np.where((people == "P0")[:, None], other, one)
    settings = TrainingSettings(count=60, neighbours=4, subset=2, k=3)
    errors = left_out_participant_errors(scores, pd.DataFrame({"length": lengths}), people.tolist(), settings, 3, 0)
    assert list(errors["map"]) == list(range(20))
    # Nothing of P0 is left: the prediction is the others' map in every cell.
    expected = 100 * np.median((1 - one) - (1 - other))
    assert abs(expected) > 10
    np.testing.assert_allclose(errors.loc[errors["participant"] == "P0", "error_percent"], expected, atol=1e-9)
    with pytest.raises(InputError, match="1 participants are too few"):
        left_out_participant_errors(scores, pd.DataFrame({"length": lengths}), ["P0"] * 20, settings, 3, 0)


def test_nothing_of_a_left_out_participant_reaches_the_prediction() -> None:
    rng = np.random.default_rng(2)
    vectors = pd.DataFrame({"length": rng.uniform(1, 4, 30)})
    people = [f"P{i % 5}" for i in range(30)]
    own = np.array(people) == "P1"
    settings = TrainingSettings(normalisation="global_max", count=None, k=5)
    scores = np.column_stack([rng.random(30), np.ones(30)])  # the second cell is 1 for all: suitability 0
    changed = scores.copy()
    changed[own, 0] *= 0.5
    before, after = (
        left_out_participant_errors(table, vectors, people, settings, 3, 0)["error_percent"] for table in (scores, changed)
    )
    # The median of two cells is their mean, so halving P1's own scores moves P1's errors by half of what the truth moved.
    moved = 100 * (scores[:, 0] - changed[:, 0]) / 2
    np.testing.assert_allclose((before - after)[own], moved[own], atol=1e-9)


@pytest.mark.parametrize("kernel", ["multiquadric", "thin_plate_spline", "cubic"])
def test_rippas_closed_form_equals_solving_without_each_cell(kernel: str) -> None:
    interpolant = GridInterpolant((4, 3, 3), kernel)  # type: ignore[arg-type]
    maps = np.random.default_rng(3).random((2, 36))
    found = left_out_cell_errors(interpolant, maps)
    for cell in range(36):
        rest = np.arange(36) != cell
        nodes = interpolant.nodes
        solved = RBFInterpolator(nodes[rest], maps[:, rest].T, kernel=kernel, epsilon=1.0)(nodes[[cell]])[0]
        np.testing.assert_allclose(found[:, cell], solved - maps[:, cell], atol=1e-8)


def test_random_cells_are_of_each_map_and_all_cells_where_there_are_few() -> None:
    interpolant = GridInterpolant((3, 3))
    maps = np.random.default_rng(4).random((5, 9))
    every = 100 * np.median(left_out_cell_errors(interpolant, maps), axis=1)
    table = rbf_errors(interpolant, maps, np.random.default_rng(0), 100)
    np.testing.assert_allclose(table["error_percent"], every)
    some = rbf_errors(interpolant, maps, np.random.default_rng(0), 1)["error_percent"].to_numpy()
    possible = 100 * left_out_cell_errors(interpolant, maps)
    assert all(np.isclose(possible[row], error).any() for row, error in enumerate(some))


def test_summary_resamples_participants_where_there_are_some() -> None:
    rng = np.random.default_rng(5)
    people = np.repeat([f"P{i}" for i in range(8)], 50)
    errors = rng.normal(0, 2, 8)[np.repeat(np.arange(8), 50)] + rng.normal(0, 0.1, 400)
    table = pd.DataFrame({"method": "k_nearest", "map": np.arange(400), "participant": people, "error_percent": errors})
    unnamed = table.assign(method="rbf", participant="")
    summary = summarise_leave_one_out(pd.concat([table, unnamed]), rng, 500).set_index(["method", "statistic"])
    assert summary.loc[("rbf", "mean"), "value"] == pytest.approx(errors.mean())
    assert summary.loc[("rbf", "sd"), "value"] == pytest.approx(errors.std(ddof=1))
    width = {name: summary.loc[(name, "mean"), "high"] - summary.loc[(name, "mean"), "low"] for name in ("k_nearest", "rbf")}
    assert width["k_nearest"] > 3 * width["rbf"]


def test_weights_used_are_those_of_the_model() -> None:
    space = line(9)
    found = k_nearest_errors(space, 3, "linear")["error_percent"][0]
    shares = weights([[1.0, 2.0, 3.0]], "linear", beyond=[4.0])[0]
    assert found == pytest.approx(100 * 0.01 * (shares @ [1, 2, 3]))
