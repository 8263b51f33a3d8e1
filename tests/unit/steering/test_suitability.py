import dataclasses

import numpy as np
import pytest

from walklab.errors import InputError
from walklab.planning.path_following import PathFollowing
from walklab.steering.metrics import METRICS
from walklab.steering.suitability import batch_task, captured_walk, normalise, score_walks


def test_m_euclid_follows_its_definition(world):
    cell = np.array([[1.0, 2.0]])
    scores = score_walks(world.planner, world.batch, cell)
    for walk in (0, 33, 79):
        captured = captured_walk(world.batch, walk)
        route, task = batch_task(world.batch, walk)
        simulated = world.planner.follow(route, task, cell[0], 60.0).positions_m
        # Brute force: frame by frame, the agent standing at its end once it has arrived.
        total = sum(np.hypot(*(captured[t] - simulated[min(t, len(simulated) - 1)])) for t in range(len(captured)))
        assert scores[walk, 0] == pytest.approx(total / 60 / world.batch.lengths_m[walk], rel=1e-12)


def test_a_walk_made_by_the_planner_scores_zero_with_its_own_parameters(point_mass, packer):
    batch = packer(point_mass, [np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])], [(1.1, 0.7)])
    assert score_walks(point_mass, batch, np.array([[1.1, 0.7], [1.2, 0.7]]))[:, 0] == pytest.approx([0.0], abs=1e-12)


# Few cells are scored in double precision, many in single-precision lanes: each has its own bound.
@pytest.mark.parametrize(("count", "bound"), [(15, 1e-9), (40, 1e-4)])
def test_compiled_and_generic_scores_agree(packer, count, bound):
    planner = PathFollowing(("v", "a", "omega"), 1 / 60)
    rng = np.random.default_rng(1)
    routes = [np.array([[0, 0], [1.5, 0], [1.5, 1.2]]), np.array([[0, 0], [0.7, 0.1]]), np.array([[0.0, 0], [2, 2], [1, 3]])]
    batch = packer(planner, [np.array(r, dtype=float) for r in routes], rng.uniform(0.5, 1.5, (3, 3)))
    noisy = dataclasses.replace(batch, captured_m=batch.captured_m + rng.normal(0, 0.02, batch.captured_m.shape))
    cells = rng.uniform(0.1, 2.0, (count, 3))
    generic = dataclasses.replace(METRICS["euclid"], name="not compiled")
    assert np.abs(score_walks(planner, noisy, cells) - score_walks(planner, noisy, cells, generic)).max() < bound


def test_looking_beyond_the_captured_walk_scores_a_late_arrival_higher(world):
    slow = np.array([[0.2, 1.0]])
    short = score_walks(world.planner, world.batch, slow, "euclid")
    both = score_walks(world.planner, world.batch, slow, "euclid_until_both_end")
    assert np.all(both >= short)
    assert np.all(both[40:] > 1.1 * short[40:])


# Compiled scores of these metrics against the generic ones: many cells in lanes, a radius that ends walks one by one.
@pytest.mark.parametrize("ends_at", ["line", "radius"])
@pytest.mark.parametrize("metric", ["euclid", "euclid_until_both_end", "mean_distance"])
def test_every_compiled_metric_is_the_generic_one(packer, metric, ends_at):
    planner = PathFollowing(("v", "a", "omega"), 1 / 60, ends_at=ends_at)
    rng = np.random.default_rng(2)
    routes = [np.array([[0, 0], [1.5, 0], [1.5, 1.2]]), np.array([[0, 0], [0.7, 0.1]]), np.array([[0.0, 0], [2, 2], [1, 3]])]
    batch = packer(planner, [np.array(r, dtype=float) for r in routes], rng.uniform(0.5, 1.5, (3, 3)))
    noisy = dataclasses.replace(batch, captured_m=batch.captured_m + rng.normal(0, 0.02, batch.captured_m.shape))
    cells = rng.uniform(0.1, 2.0, (40, 3))
    generic = dataclasses.replace(METRICS[metric], name="not compiled")
    compiled = score_walks(planner, noisy, cells, metric, 20.0)
    np.testing.assert_allclose(compiled, score_walks(planner, noisy, cells, generic, 20.0), atol=2e-4)


def test_until_both_have_ended_is_another_time_for_each_parameter_vector(packer, point_mass):
    """Beside a slow walker, a quick one is not scored for standing a little off its mark all that time."""
    batch = packer(point_mass, [np.array([[0.0, 0.0], [2.0, 0.0]])], [(1.0, 1.0)])
    off = dataclasses.replace(batch, captured_m=batch.captured_m + np.array([0.0, 0.05]))
    quick, slow = np.array([[1.0, 1.0]]), np.array([[0.1, 1.0]])
    alone = score_walks(point_mass, off, quick, "euclid_until_both_end")
    assert score_walks(point_mass, off, np.vstack([quick, slow]), "euclid_until_both_end")[0, 0] == pytest.approx(alone[0, 0])


def test_a_score_that_is_not_finite_names_walk_and_parameters(world):
    broken = dataclasses.replace(world.batch, lengths_m=np.where(np.arange(80) == 7, np.nan, world.batch.lengths_m))
    with pytest.raises(InputError, match=r"walk 7 .*\[1.0, 1.0\]"):
        score_walks(world.planner, broken, np.array([[1.0, 1.0]]))


def test_walks_at_another_step_are_refused(world):
    with pytest.raises(InputError, match="resample"):
        score_walks(world.planner, dataclasses.replace(world.batch, step_s=1 / 120), np.array([[1.0, 1.0]]))


def test_normalisations():
    scores = np.array([[1.0, 2.0, 4.0], [3.0, 3.0, 3.0], [0.0, 8.0, 2.0]])
    assert normalise(scores) == pytest.approx(np.array([[0.75, 0.5, 0], [1, 1, 1], [1, 0, 0.75]]))
    assert normalise(scores, "min_max") == pytest.approx(np.array([[1, 2 / 3, 0], [1, 1, 1], [1, 0, 0.75]]))
    assert normalise(scores, "global_max")[[0, 2]] == pytest.approx(1 - scores[[0, 2]] / 8)
    with pytest.raises(InputError, match="softmax"):
        normalise(scores, "softmax")


@pytest.mark.parametrize("how", ["per_map_max", "global_max", "min_max"])
def test_normalising_keeps_the_order_of_the_cells_and_the_range(how):
    scores = np.random.default_rng(0).random((20, 30))
    suitability = normalise(scores, how)
    assert np.array_equal(np.argsort(suitability, axis=1), np.argsort(-scores, axis=1))
    assert suitability.min() >= 0
    assert suitability.max() <= 1
