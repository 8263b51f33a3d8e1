"""Walks from a known distribution, against that distribution, closed forms and scipy."""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from walklab.capture.training import TrainingDesign, configurations
from walklab.errors import InputError
from walklab.evaluation.planner_walks import known_distribution, walk_by_planner
from walklab.evaluation.recovery import (
    BEFORE,
    LITERAL,
    NEIGHBOURS,
    PERFECT,
    UNIFORM,
    Setup,
    best_cells,
    compare,
    energy_distance,
    recover_all,
    resampled,
    score_planner_walks,
)
from walklab.geometry.plans import load_plan
from walklab.geometry.scene import Body
from walklab.geometry.standing import Standing
from walklab.planning.registry import make_planner
from walklab.steering.space import space_from_config
from walklab.steering.training import TrainingSettings

ROOT = Path(__file__).parents[3]
SPACE = space_from_config([{"name": name, "unit": "", "start": 0.4, "step": 0.4, "count": 5} for name in ("v", "a", "omega")])
STRAIGHT, TURN = "straight_3.0", "turn_90_3.0"


def known_of(sd=0.15, per_length=0.0):
    one = {"mean": 1.2, "sd": sd, "per_length": per_length, "per_curvature": 0.0}
    return known_distribution(dict.fromkeys(SPACE.names, one), SPACE.names, SPACE.bounds)


@pytest.fixture(scope="module")
def planner():
    return make_planner("path_following", SPACE.names, 1 / 60, {"cell_m": 0.02})


def walks_of(planner, count, known, seed=1):
    plan = load_plan(ROOT / "config/scenes/turn_90.yaml")
    design = TrainingDesign(straight_distances_m=(3.0,), turning_angles_deg=(90.0,), turning_distances_m=(3.0,))
    made = configurations(design, {plan.scene.name: plan})
    return walk_by_planner(count, made, known, planner, Body(), Standing(), 60.0, 4, np.random.default_rng(seed))


def setup_of(planner, draws=200):
    return Setup(planner, Standing(), 60.0, "euclid", TrainingSettings(k=80), (STRAIGHT, TURN), draws)


def test_draws_follow_the_stated_distribution_and_stay_in_the_space():
    known = known_of(sd=0.5, per_length=0.3)
    drawn = known.draw(np.full(4000, 3.5), np.zeros(4000), np.random.default_rng(0))
    assert drawn.min() >= 0.4
    assert drawn.max() <= 2.0
    levels = known.cdf(3.5, 0.0, np.sort(drawn, axis=0))
    assert min(stats.kstest(levels[:, axis], "uniform").pvalue for axis in range(3)) > 0.01
    # Truncated normal by definition.
    phi = stats.norm(1.2 + 0.3 * (3.5 - 2.5), 0.5)
    expected = (phi.cdf(1.0) - phi.cdf(0.4)) / (phi.cdf(2.0) - phi.cdf(0.4))
    assert known.cdf(3.5, 0.0, np.ones((1, 3)))[0] == pytest.approx(np.full(3, expected))


def test_a_known_distribution_names_every_parameter():
    with pytest.raises(InputError, match="give one each"):
        known_distribution({"v": {"mean": 1, "sd": 1, "per_length": 0, "per_curvature": 0}}, SPACE.names, SPACE.bounds)


def test_energy_distance_in_one_dimension_is_scipys_and_of_two_points_their_distance():
    rng = np.random.default_rng(2)
    x, y = rng.normal(0, 1, (80, 1)), rng.normal(0.7, 2, (50, 1))
    assert energy_distance(x, y) == pytest.approx(stats.energy_distance(x[:, 0], y[:, 0]))
    assert energy_distance(np.zeros((1, 3)), np.full((1, 3), 2.0)) == pytest.approx(np.sqrt(2 * np.sqrt(12)))
    assert energy_distance(x, x) == 0


def test_the_planners_walk_has_its_own_parameters_as_the_best_cell(planner):
    cell = SPACE.cells[np.flatnonzero(np.isclose(SPACE.cells, [1.2, 0.8, 1.6]).all(axis=1))[0]]
    still = {"sd": 1e-9, "per_length": 0, "per_curvature": 0}
    means = {name: {"mean": value, **still} for name, value in zip(SPACE.names, cell, strict=True)}
    exact = known_distribution(means, SPACE.names, SPACE.bounds)
    made = walks_of(planner, 4, exact)
    scores = score_planner_walks(made, SPACE, setup_of(planner))
    best = SPACE.cells[scores.argmin(axis=1)]
    assert scores.min(axis=1).max() < 1e-3
    turning = made.tasks == TURN
    assert np.allclose(best[turning], cell)
    assert np.allclose(best[~turning, :2], cell[:2]), "omega has no effect on a straight walk"
    ties = (scores[~turning] <= scores[~turning].min(axis=1, keepdims=True) + 1e-6).sum(axis=1)
    assert (ties == SPACE.shape[2]).all()


def test_where_cells_tie_the_point_is_uniform_over_all_of_them():
    scores = np.ones((3000, len(SPACE.cells)))
    tied = np.flatnonzero(np.isclose(SPACE.cells[:, :2], [1.2, 0.8]).all(axis=1))
    scores[:, tied] = 0
    points = best_cells(scores, SPACE, np.random.default_rng(4))
    for axis, (low, high) in enumerate(((1.0, 1.4), (0.6, 1.0), (0.4, 2.0))):
        assert stats.kstest(points[:, axis], stats.uniform(low, high - low).cdf).pvalue > 0.001


def test_comparing_the_truth_with_itself_gives_the_floor_and_a_shift_its_bias():
    known, rng = known_of(), np.random.default_rng(5)
    truth, again = (known.draw(np.full(2000, 3.0), np.zeros(2000), rng) for _ in range(2))
    shifted = again + np.array([0.15, 0, 0])
    floor, moved = (
        {(row["measure"], row["parameter"]): row["value"] for row in compare(points, truth, known, (3.0, 0.0), SPACE.names)}
        for points in (again, shifted)
    )
    assert max(floor["ks", name] for name in SPACE.names) < 1.63 / np.sqrt(2000)  # the 1 % point of Kolmogorov's distribution
    assert moved["bias", "v"] == pytest.approx(1, abs=0.1)
    assert moved["ks", "v"] == pytest.approx(2 * stats.norm.cdf(0.5) - 1, abs=0.04)
    assert moved["energy", "all"] > 3 * floor["energy", "all"]


def test_what_is_identified_is_recovered_before_blending_and_nothing_is_by_the_literal_reading(planner):
    known = known_of()
    made = walks_of(planner, 240, known)
    table, shown = recover_all(made, SPACE, [60, 240], [5, 6], known, setup_of(planner), seed=1)
    ks = table[(table["measure"] == "ks") & (table["walks"] == 240)].set_index(["task", "parameter", "model"])["value"]
    for parameter in ("v", "a", "omega"):
        assert ks[TURN, parameter, PERFECT] < 0.15 < ks[TURN, parameter, LITERAL]
        assert ks[TURN, parameter, NEIGHBOURS] < 0.25
    assert ks[TURN, "omega", BEFORE] < ks[STRAIGHT, "omega", BEFORE], "omega leaves no trace on a straight walk"
    assert ks[STRAIGHT, "omega", BEFORE] == pytest.approx(ks[STRAIGHT, "omega", UNIFORM], abs=0.12)
    assert ks[TURN, "a", BEFORE] < ks[TURN, "a", LITERAL]
    assert set(table["resolution"]) == {5, 6}
    assert set(table.loc[table["resolution"] == 6, "walks"]) == {60}
    assert set(table.loc[table["walks"] == 60, "repetition"]) >= {0, 1}
    areas = shown.groupby(["task", "model", "parameter"]).apply(lambda rows: rows["density"].sum() * 1.6 / len(rows))
    assert areas.to_numpy() == pytest.approx(1, abs=0.02)


def test_another_resolution_keeps_the_range():
    fine = resampled(SPACE, 9)
    assert fine.shape == (9, 9, 9)
    assert np.allclose(fine.bounds, SPACE.bounds)
