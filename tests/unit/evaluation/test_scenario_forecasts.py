"""What is put together for the forecasts of a scenario knows nothing of how its walks were walked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from walklab.capture.walks import Walk
from walklab.evaluation.calibration import Calibration
from walklab.evaluation.forecasts import CALIBRATED, EXTENDED, INFORMED, REGRESSION, TIMES_ALONE, Asked, Forecast
from walklab.evaluation.long_distance import straight_travel_time_s
from walklab.evaluation.route_forecasts import route_energy
from walklab.evaluation.scenario_forecasts import Learned, asked_walks, durations, forecast_scenario, known_walks
from walklab.evaluation.subject_scores import OWN_MAP
from walklab.evaluation.tracing import drawn_energy
from walklab.evaluation.trials import simulate_trials
from walklab.geometry import curves
from walklab.geometry.standing import Standing
from walklab.planning.path_following import PathFollowing
from walklab.steering.dependencies import dependency_vectors
from walklab.steering.learned import Pace
from walklab.steering.models import AdaptiveModel, StaticModel
from walklab.steering.pace import PaceEffect, Trend
from walklab.steering.routes import pack, task_of
from walklab.steering.sharpness import SharpnessLaw
from walklab.steering.space import space_from_config
from walklab.steering.suitability import score_walks
from walklab.steering.training import TrainingSettings, train

STEP_S, LIMIT_S = 1 / 60, 30.0
PLANNER = PathFollowing(("v", "a"), STEP_S)
SPACE = space_from_config(
    [{"name": "v", "unit": "m/s", "values": [0.6, 0.9, 1.2, 1.5]}, {"name": "a", "unit": "m/s²", "values": [0.5, 1.0, 1.5]}]
)
DEPENDENCIES = ("length", "height")
FLAT = Pace(8.0, (), Trend((), (), (), (), (), (), 0, (0.0,)), PaceEffect(0.0, 0.08, 0.04), 0.03)


def walk(number: int, length_m: float, v: float) -> Walk:
    row = pd.Series(
        {
            "walk": f"P{number % 3}/{number:02d}",
            "participant": f"P{number % 3}",
            "configuration": "straight",
            "scene": "hall",
            "duration_s": straight_travel_time_s(length_m, v, 1.0),
            "length_m": length_m,
            "height_m": 1.6 + 0.1 * (number % 3),
            "start_x_m": 0.0,
            "start_y_m": 0.0,
            "end_x_m": length_m,
            "end_y_m": 0.0,
            "start_speed_m_s": 0.0,
            "end_speed_m_s": 0.0,
        }
    )
    followed = PLANNER.follow(np.array([[0.0, 0.0], [length_m, 0.0]]), task_of(row), np.array([v, 1.0]), LIMIT_S).positions_m
    return Walk(row, np.arange(len(followed)) * STEP_S, followed)


def speed_of(number: int, rng: np.random.Generator) -> float:
    """Every person has a speed of their own, else earlier walks would tell nothing."""
    return 0.9 + 0.2 * (number % 3) + rng.uniform(-0.05, 0.05)


def walked_otherwise(walk: Walk) -> Walk:
    """The same person and task, but slower and along an arc."""
    along = walk.position_m[:, 0] / walk.position_m[-1, 0]
    bowed = walk.position_m + np.column_stack([np.zeros(len(along)), 0.8 * np.sin(np.pi * along)])
    longer = {"length_m": curves.length(bowed), "duration_s": 1.6 * float(walk.row["duration_s"])}
    return Walk(pd.Series({**walk.row, **longer}), 1.6 * walk.time_s, bowed)


def routes_of(walks: list[Walk]) -> dict[str, np.ndarray]:
    """The planned routes: straight, whatever was walked."""
    return {walk.row["walk"]: np.array([[0.0, 0.0], [walk.row["end_x_m"], 0.0]]) for walk in walks}


def both_vectors(walks: list[Walk]) -> pd.DataFrame:
    """Planned and captured dependencies beside each other, as the workflow keeps them."""
    table = pd.DataFrame([walk.row for walk in walks])
    parts = [
        dependency_vectors(table, routes_of(walks), DEPENDENCIES, index).add_prefix(f"{index}_")
        for index in ("planned", "captured")
    ]
    return pd.concat(parts, axis=1).reset_index()


@pytest.fixture(scope="module")
def learned() -> Learned:
    rng = np.random.default_rng(0)
    walks = [walk(number, length, speed_of(number, rng)) for number, length in enumerate(rng.uniform(1, 4, 24))]
    scores = score_walks(PLANNER, pack(walks, routes_of(walks), PLANNER), SPACE.cells, "euclid", LIMIT_S)
    vectors = both_vectors(walks)[[f"planned_{name}" for name in DEPENDENCIES]].set_axis(DEPENDENCIES, axis=1)
    people = [str(each.row["participant"]) for each in walks]
    model = train(scores, vectors, people, SPACE, TrainingSettings(count=None, basis="multilinear", k=6), rng)
    residuals = pd.DataFrame({"walk": [each.row["walk"] for each in walks[::2]]})
    residuals = residuals.assign(static_residual_s=rng.normal(0, 0.2, 12), adaptive_residual_s=rng.normal(0, 0.2, 12))
    known = known_walks(walks, routes_of(walks), vectors.to_numpy(), scores, residuals, "per_map_max")
    return Learned(model, Calibration(SharpnessLaw(6.0), 4.0, FLAT), known, PLANNER, Standing(), LIMIT_S, "euclid")


@pytest.fixture(scope="module")
def asked_for() -> list[Walk]:
    rng = np.random.default_rng(1)
    return [walk(number, length, speed_of(number, rng)) for number, length in enumerate(rng.uniform(1.2, 3.8, 9))]


def trials_of(walks: list[Walk], vectors: pd.DataFrame, learned: Learned) -> pd.DataFrame:
    models = {"P_Stat": StaticModel(("v", "a"), (1.1, 0.9)), "P_Adapt": AdaptiveModel(learned.model)}
    asked = vectors.set_index("walk").loc[[each.row["walk"] for each in walks], [f"planned_{name}" for name in DEPENDENCIES]]
    return simulate_trials(models, PLANNER, walks, routes_of(walks), asked, Standing(), LIMIT_S, "euclid", 7, 0)


def forecast(walks: list[Walk], learned: Learned, vectors: pd.DataFrame | None = None) -> tuple[Asked, dict[str, Forecast]]:
    """From the walks to their forecasts, as the workflow does it."""
    table = both_vectors(walks) if vectors is None else vectors
    asked = asked_walks(walks, routes_of(walks), table, trials_of(walks, both_vectors(walks), learned), learned)
    return asked, forecast_scenario(walks, routes_of(walks), asked, learned, 7, 0)


def test_however_the_walks_were_walked_the_forecasts_are_the_same(learned: Learned, asked_for: list[Walk]) -> None:
    before, after = forecast(asked_for, learned)[1], forecast([walked_otherwise(each) for each in asked_for], learned)[1]
    assert len(before) == 17
    for name, found in before.items():
        if name not in (*INFORMED, OWN_MAP):
            np.testing.assert_array_equal(found.members_s, after[name].members_s, err_msg=name)
        else:
            assert (found.members_s != after[name].members_s).any(), f"{name} reads walks, so the change must have reached it"
    # And the change is one that a captured index would have let in.
    walks = [walked_otherwise(each) for each in asked_for]
    table = both_vectors(walks)
    for name in DEPENDENCIES:
        table[f"planned_{name}"] = table[f"captured_{name}"]
    leaked = forecast(walks, learned, table)[1]
    for name in (CALIBRATED, EXTENDED, REGRESSION):
        assert (leaked[name].members_s != before[name].members_s).any(), name


def test_times_maps_and_vectors_are_each_walks_own(learned: Learned, asked_for: list[Walk]) -> None:
    """Whatever the order of the tables; and what is put together is what the models say of the planned walk."""
    table = both_vectors(asked_for)
    trials = trials_of(asked_for, table, learned)
    rng = np.random.default_rng(2)
    shuffled = (frame.iloc[rng.permutation(len(frame))] for frame in (table, trials))
    asked = asked_walks(asked_for, routes_of(asked_for), *shuffled, learned)
    np.testing.assert_array_equal(asked.captured_s, durations(asked_for))
    np.testing.assert_allclose(asked.lengths_m, [each.row["end_x_m"] for each in asked_for])
    np.testing.assert_allclose(asked.vectors[:, 1], [each.row["height_m"] for each in asked_for])
    for name, times_s in (("P_Stat", asked.static_s), ("P_Adapt", asked.adaptive_s)):
        np.testing.assert_array_equal(times_s, trials.loc[trials["model"] == name, "simulated_s"])
    assert (asked.static_s != asked.adaptive_s).any()
    np.testing.assert_array_equal(asked.suitability[3], learned.model.blend(asked.vectors)[3])
    # Each walk was made with a = 1 and a speed between cells: its own map's best cell takes about as long.
    np.testing.assert_allclose(asked.own_map_s, asked.captured_s, atol=0.5)
    # The trajectory that goes with it is near the captured one; one vector for everybody is farther off.
    assert asked.own_map_m.mean() < 0.5 * asked.static_m.mean()
    assert (asked.static_m != asked.adaptive_m).any()
    # Followed once more by itself, the oracle's cell is as far off as among all cells.
    best = score_walks(PLANNER, pack(asked_for, routes_of(asked_for), PLANNER), SPACE.cells, "euclid", LIMIT_S).argmin(axis=1)
    alone = drawn_energy(asked_for, routes_of(asked_for), PLANNER, SPACE.cells[best][:, None], LIMIT_S)
    np.testing.assert_allclose(alone, asked.own_map_m, atol=0.03)


def test_the_extended_models_energy_score_is_of_its_own_draws(learned: Learned, asked_for: list[Walk]) -> None:
    asked, found = forecast(asked_for, learned)
    assert np.isfinite(found[EXTENDED].energy_m).all()
    again = forecast_scenario(asked_for, routes_of(asked_for), asked, learned, 7, 0)
    np.testing.assert_array_equal(found[EXTENDED].energy_m, again[EXTENDED].energy_m)
    slower = replace(learned, calibration=replace(learned.calibration, pace=replace(FLAT, effect=PaceEffect(1.0, 0.08, 0.04))))
    late = forecast_scenario(asked_for, routes_of(asked_for), asked, slower, 7, 0)
    assert late[EXTENDED].energy_m.mean() > 2 * found[EXTENDED].energy_m.mean()


def test_forecasts_of_times_alone_are_put_on_the_planned_route(learned: Learned, asked_for: list[Walk]) -> None:
    """Their trajectories are those of their own times; how the walk that is forecast went on its way is only scored."""
    asked, found = forecast(asked_for, learned)
    for name in TIMES_ALONE:
        np.testing.assert_array_equal(
            found[name].energy_m, route_energy(asked_for, routes_of(asked_for), found[name].members_s, learned.known.progress)
        )
    assert len({float(found[name].energy_m.mean()) for name in TIMES_ALONE}) == len(TIMES_ALONE)
    late = replace(learned, known=replace(learned.known, progress=learned.known.progress**3))
    other = forecast_scenario(asked_for, routes_of(asked_for), asked, late, 7, 0)
    assert (other[REGRESSION].energy_m != found[REGRESSION].energy_m).all()
    np.testing.assert_array_equal(other[REGRESSION].members_s, found[REGRESSION].members_s)
