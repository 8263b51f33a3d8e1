"""Neighbours, distances, production and the interval of the optimum, on constructed data."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.evaluation.distances import distance_shares
from walklab.evaluation.neighbours import models_by_neighbours, neighbour_table, neighbour_trials, time_neighbours
from walklab.evaluation.optimum import optimum_table
from walklab.evaluation.production import production_example
from walklab.steering.models import MotionModel, ProbabilisticModel
from walklab.steering.space import space_from_config
from walklab.steering.training import TrainingSettings, train

Build = Callable[..., pd.DataFrame]

SPACE = space_from_config([{"name": n, "unit": "", "start": 0.2, "step": 0.2, "count": 5} for n in ("v", "a")])


@pytest.fixture(scope="module")
def model() -> ProbabilisticModel:
    rng = np.random.default_rng(0)
    vectors = pd.DataFrame({"length": rng.uniform(1, 4, 25)})
    settings = TrainingSettings(count=None, k=10)
    return train(rng.random((25, 25)), vectors, ["P"] * 25, SPACE, settings, rng)


def test_sweep_leaves_out_too_large_k_and_draws_under_one_name(model: ProbabilisticModel, make_trials: Build) -> None:
    models = models_by_neighbours(model, (10, 20, 25, 50))
    assert {k: m.k for k, m in models.items()} == {10: 10, 20: 20, 25: 25}
    assert models[20].coefficients is model.coefficients
    asked: list[list[str]] = []

    def simulate(given: dict[str, MotionModel]) -> pd.DataFrame:
        asked.append(list(given))
        k = given["P_Prob"].k  # type: ignore[attr-defined]
        return make_trials({"P_Prob": np.full(20, 1.0 / k)})

    table = neighbour_table(neighbour_trials(models, simulate), np.random.default_rng(0), 100)
    assert asked == [["P_Prob"]] * 3
    medians = table[table["statistic"] == "median"].set_index("k")["value"]
    np.testing.assert_allclose(medians.loc[[10, 20, 25]], [0.1, 0.05, 0.04])


def test_times_are_read_off_the_clock_in_milliseconds(model: ProbabilisticModel) -> None:
    ticks = iter(np.cumsum([0.0, 0.002, 0.003] * 4))
    table = time_neighbours({10: model}, np.array([[1.0], [2.0], [3.0], [4.0]]), 1, 4, lambda: next(ticks))
    assert table.loc[0, ["interpolation_ms", "sample_ms"]].tolist() == pytest.approx([2.0, 3.0])


def test_distance_classes_hold_their_upper_edge_and_all_walks() -> None:
    table = distance_shares({"scenario_1": np.array([0.5, 1.0, 1.0001, 2.0, 3.5, 9.0])}, (0, 1, 2, 4))
    assert table["walks"].tolist() == [2, 2, 1, 1]
    assert table["cumulative_share"].iloc[-1] == 1.0
    assert table["share"].sum() == pytest.approx(1.0)
    published = table.set_index("high_m")["published_cumulative_share"]
    assert (published[2.0], published[4.0]) == (0.75, 0.95)
    assert np.isnan(published[1.0])
    with pytest.raises(InputError, match="must ascend"):
        distance_shares({"scenario_1": np.ones(3)}, (0, 2, 1))
    with pytest.raises(InputError, match="scenario_2 has no walks"):
        distance_shares({"scenario_2": np.zeros(0)})


def test_production_example_adds_up(make_trials: Build) -> None:
    signs = np.resize([1.0, -1.0], 40)
    trials = make_trials({"P_Stat": 0.5 * signs, "P_Prob": np.full(40, 0.4)}, captured_s=2.0)
    table = production_example(trials, np.random.default_rng(0), resamples=100).set_index("quantity")["value"]
    assert table["walks_per_car"] == pytest.approx(10.0)  # 20 s of walking in walks of 2 s
    assert table["absolute_reduction"] == pytest.approx(10 * (0.5 - 0.4))
    assert table["net_first"] == pytest.approx(0.0, abs=1e-12)  # signs cancel
    assert table["net_second"] == pytest.approx(4.0)
    assert table["paper_reduction"] == pytest.approx(20 * (1 - 0.4 / 0.5))


def test_optimum_interval_is_as_wide_as_people_disagree() -> None:
    people = np.repeat([f"P{i}" for i in range(12)], 4)
    best = SPACE.cells[7]

    def scores(targets: np.ndarray) -> np.ndarray:
        return ((SPACE.cells[None] - targets[:, None]) ** 2).sum(axis=-1)

    agreed = optimum_table(
        best, [], [0.0] * 2, scores(np.tile(best, (48, 1))), people.tolist(), SPACE, np.random.default_rng(0), 300
    )
    # All people have one map: every resample has one optimum, and nothing widens the interval to the grid's step.
    np.testing.assert_allclose(agreed["high"] - agreed["low"], 0.0, atol=1e-9)
    np.testing.assert_allclose(agreed["interpolated"], best, atol=0.02)
    np.testing.assert_allclose(agreed["low"], best, atol=1e-8)
    spread = np.tile(best, (48, 1))
    spread[:, 0] += np.repeat(np.random.default_rng(1).normal(0, 0.5, 12), 4)
    varied = optimum_table(best, ["v"], [0.0] * 2, scores(spread), people.tolist(), SPACE, np.random.default_rng(0), 300)
    width = (varied["high"] - varied["low"]).to_numpy()
    # The mean of 12 people who differ by 0.5 has an interval of about 4 * 0.5 / sqrt(12), cut by the space; no grid steps.
    assert width[0] > 0.35
    assert width[1] < 0.05
    assert varied["on_edge"].tolist() == [True, False]
    assert ((varied["low"] <= best + 1e-9) & (best - 1e-9 <= varied["high"])).all()
    with pytest.raises(InputError, match="do not fit"):
        optimum_table(best, [], [0.0] * 2, np.ones((3, 25)), ["P"] * 4, SPACE, np.random.default_rng(0))
