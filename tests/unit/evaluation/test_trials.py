"""Trials on straight walks, whose travel times are known in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import pytest
import shapely
from numpy.typing import ArrayLike

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.evaluation.long_distance import straight_travel_time_s
from walklab.evaluation.trials import simulate_trials, task_of
from walklab.geometry.scene import Scene
from walklab.geometry.standing import Standing
from walklab.planning.path_following import PathFollowing
from walklab.steering.models import StaticModel
from walklab.steering.space import space_from_config

STEP_S = 1 / 60
PLANNER = PathFollowing(("v", "a"), STEP_S)


@dataclass(frozen=True)
class Drawing:
    """Draws speeds; knows a domain of validity."""

    names: tuple[str, ...] = ("v", "a")

    def parameters(self, vectors: ArrayLike, generators: Sequence[np.random.Generator] | None = None) -> np.ndarray:
        assert generators is not None
        return np.array([[rng.uniform(0.5, 1.5), 1.0] for rng in generators])

    def inside(self, vectors: np.ndarray) -> np.ndarray:
        return vectors[:, 0] < 2.5


def walk(number: int, length_m: float, v: float = 1.0, a: float = 1.0) -> Walk:
    row = pd.Series(
        {
            "walk": f"scenario_1/P{number % 2}/straight/{number:04d}",
            "participant": f"P{number % 2}",
            "configuration": "straight",
            "scene": "hall",
            "duration_s": straight_travel_time_s(length_m, v, a),
            "length_m": length_m,
            "start_x_m": 0.0,
            "start_y_m": 0.0,
            "end_x_m": length_m,
            "end_y_m": 0.0,
            "start_speed_m_s": 0.0,
            "end_speed_m_s": 0.0,
        }
    )
    followed = PLANNER.follow(np.array([[0.0, 0.0], [length_m, 0.0]]), task_of(row), np.array([v, a]), 60.0).positions_m
    return Walk(row, np.arange(len(followed)) * STEP_S, followed)


WALKS = [walk(i, length) for i, length in enumerate([0.8, 1.5, 2.0, 3.0, 4.0])]
ROUTES = {w.row["walk"]: np.array([[0.0, 0.0], [w.row["length_m"], 0.0]]) for w in WALKS}
VECTORS = np.array([[w.row["length_m"]] for w in WALKS])


def simulate(
    models: dict, walks: list[Walk] = WALKS, vectors: np.ndarray = VECTORS, limit_s: float = 60.0, **options: Any
) -> pd.DataFrame:
    return simulate_trials(models, PLANNER, walks, ROUTES, vectors, Standing(), limit_s, "euclid", 7, 0, **options)


def test_travel_times_are_those_of_the_closed_form() -> None:
    table = simulate({"P_Stat": StaticModel(("v", "a"), (0.8, 0.5))})
    expected = [straight_travel_time_s(w.row["length_m"], 0.8, 0.5) for w in WALKS]
    # Standing thresholds cut the first and last moments of slow motion: 0.05 m/s at 0.5 m/s2 is 0.1 s at each end.
    np.testing.assert_allclose(table["simulated_s"], expected, atol=0.25)
    np.testing.assert_allclose(table["dt_s"], table["simulated_s"] - table["captured_s"])
    np.testing.assert_allclose(table["abs_dt_s"], np.abs(table["dt_s"]))


def test_the_parameters_a_walk_was_made_with_reproduce_it() -> None:
    table = simulate({"P_Stat": StaticModel(("v", "a"), (1.0, 1.0))})
    np.testing.assert_allclose(table["metric_s"], 0.0, atol=1e-12)
    assert (table["abs_dt_s"] <= 0.15).all()


def test_a_walk_that_never_arrives_keeps_its_row_with_the_time_limit() -> None:
    table = simulate({"P_Stat": StaticModel(("v", "a"), (0.1, 1.0))}, limit_s=5.0)
    assert len(table) == len(WALKS)
    assert (table["arrival"] == "timeout").all()
    assert (table["simulated_s"] == 5.0).all()


def test_draws_do_not_depend_on_which_other_walks_and_models_there_are() -> None:
    whole = simulate({"P_Stat": StaticModel(("v", "a"), (1.0, 1.0)), "P_Prob": Drawing()})
    part = simulate({"P_Prob": Drawing()}, WALKS[::-2], VECTORS[::-2])
    expected = whole[whole["model"] == "P_Prob"].set_index("walk").loc[part["walk"]].reset_index()
    pd.testing.assert_frame_equal(part, expected[part.columns])


def test_a_stream_gives_variants_common_random_numbers() -> None:
    table = simulate({"full": Drawing(), "variant": Drawing()}, stream="P_Prob")
    named = simulate({"P_Prob": Drawing()})
    assert table.groupby("walk")["v"].nunique().max() == 1
    np.testing.assert_array_equal(table[table["model"] == "full"]["v"], named["v"])
    own = simulate({"full": Drawing(), "variant": Drawing()})
    assert own.groupby("walk")["v"].nunique().min() == 2


def test_rows_carry_the_domain_of_validity_and_the_parameters_by_name() -> None:
    table = simulate({"P_Stat": StaticModel(("v", "a"), (1.0, 1.0)), "P_Prob": Drawing()})
    assert list(table["inside_hull"]) == 2 * [True, True, True, False, False]
    columns = "walk participant configuration model v a captured_s simulated_s dt_s abs_dt_s arrival metric_s inside_hull"
    assert list(table.columns) == [*columns.split(), "on_edge", "collided"]
    assert not table[["on_edge", "collided"]].any(axis=None)


SPACE = space_from_config([{"name": name, "unit": "", "start": 0.5, "step": 0.5, "count": 3} for name in ("v", "a")])


def test_parameters_on_the_border_of_the_space_are_marked() -> None:
    models = {"inside": StaticModel(("v", "a"), (1.0, 1.2)), "corner": StaticModel(("v", "a"), (1.5, 0.7))}
    table = simulate(models, space=SPACE)
    assert table.groupby("model")["on_edge"].agg(["all", "any"]).to_numpy().tolist() == [[True, True], [False, False]]
    with pytest.raises(InputError, match="axes a are not the planner's v, a"):
        simulate(models, space=SPACE.without("v"))


@pytest.mark.parametrize(
    ("box", "hit"),
    [
        ((1.6, -0.1, 1.7, 0.1), [False, False, True, True, True]),  # from side to side
        ((1.6, 0.0, 1.7, 0.1), [False] * 5),  # along its outline
        ((1.6, 0.3, 1.7, 0.6), [False] * 5),  # closer than a body is wide
        ((-1.0, -1.0, 9.0, 1.0), [True] * 5),  # altogether inside
        ((0.7, -0.1, 1.0, 0.1), [True] * 5),  # the first ends within
    ],
)
def test_a_path_through_a_true_obstacle_collides(box: tuple[float, float, float, float], hit: list[bool]) -> None:
    hall = Scene("hall", {"far": shapely.box(50, 50, 51, 51), "rack": shapely.box(*box)})
    table = simulate({"P_Stat": StaticModel(("v", "a"), (1.0, 1.0))}, scenes={"hall": hall, "open": Scene("open")})
    assert table["collided"].tolist() == hit
    # Brute force: some stretch of the path lies inside.
    for row, one in zip(table.itertuples(), WALKS, strict=True):
        path = PLANNER.follow(ROUTES[row.walk], task_of(one.row), np.array([1.0, 1.0]), 60.0).positions_m
        inside = [part.length > 0 and part.within(shapely.box(*box).buffer(-1e-9)) for part in _split(path, box)]
        assert row.collided == any(inside)


def _split(path: np.ndarray, box: tuple[float, float, float, float]) -> list[shapely.Geometry]:
    return list(shapely.get_parts(shapely.intersection(shapely.LineString(path), shapely.box(*box).buffer(-1e-6))))


def test_an_open_scene_has_nothing_to_collide_with_and_an_unknown_one_is_refused() -> None:
    models = {"P_Stat": StaticModel(("v", "a"), (1.0, 1.0))}
    assert not simulate(models, scenes={"hall": Scene("hall")})["collided"].any()
    with pytest.raises(InputError, match="column scene: 'hall' is not among the plan views"):
        simulate(models, scenes={"open": Scene("open")})


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="P_Stat gives v, omega, the planner takes v, a"):
        simulate({"P_Stat": StaticModel(("v", "omega"), (1.0, 1.0))})
    with pytest.raises(InputError, match="4 dependency vectors for 5 walks"):
        simulate({"P_Prob": Drawing()}, vectors=VECTORS[:4])
    with pytest.raises(InputError, match="no route for walk scenario_1/P0/straight/0000"):
        simulate_trials({"P_Prob": Drawing()}, PLANNER, WALKS, {}, VECTORS, Standing(), 60.0, "euclid", 7, 0)
