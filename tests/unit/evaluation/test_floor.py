"""The error floor of the grid on walks that the planner made itself."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.evaluation.floor import grid_floor
from walklab.evaluation.statistics import describe
from walklab.geometry.standing import Standing
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.path_following import PathFollowing
from walklab.steering.routes import task_of
from walklab.steering.space import space_from_config

PLANNER = PathFollowing(("v", "a"), 1 / 60)
SPACE = space_from_config([{"name": name, "unit": "", "start": 0.5, "step": 0.25, "count": 5} for name in ("v", "a")])
STANDING = Standing()


def walk(number: int, v: float, a: float) -> Walk:
    length_m = 2.0 + 0.3 * number
    row = pd.Series({"walk": f"w{number}", "participant": "P", "configuration": "straight", "length_m": length_m})
    row["start_x_m"] = row["start_y_m"] = row["end_y_m"] = row["start_speed_m_s"] = row["end_speed_m_s"] = 0.0
    row["end_x_m"] = length_m
    made = PLANNER.follow(np.array([[0.0, 0.0], [length_m, 0.0]]), task_of(row), np.array([v, a]), 60.0)
    row["duration_s"] = trajectory_travel_time_s(made, task_of(row), STANDING.standing_speed_m_s)
    return Walk(row, np.arange(len(made.positions_m)) / 60, made.positions_m)


def floor(walks: list[Walk], **options: np.ndarray) -> pd.DataFrame:
    routes = {w.row["walk"]: np.array([[0.0, 0.0], [w.row["length_m"], 0.0]]) for w in walks}
    return grid_floor(PLANNER, walks, routes, SPACE, STANDING, 60.0, "euclid", **options)


def test_walks_made_by_cells_have_no_error_and_others_keep_that_of_the_grid() -> None:
    made = np.array([[0.75, 1.0], [1.25, 0.5], [1.1, 0.9], [1.5, 1.5]])
    table = floor([walk(i, *values) for i, values in enumerate(made)])
    on_grid = [0, 1, 3]
    np.testing.assert_allclose(table.loc[on_grid, ["v", "a"]], made[on_grid])
    np.testing.assert_allclose(table.loc[on_grid, ["abs_dt_s", "metric_s"]], 0.0, atol=1e-12)
    assert table.loc[2, "metric_s"] > 0.001
    assert table["on_edge"].tolist() == [False, True, False, True]
    row = describe(table).iloc[0]
    assert (row["model"], row["n"], row["on_edge"], row["collided"]) == ("best cell", 4, 2, 0)


def test_no_cell_has_a_smaller_metric() -> None:
    walks = [walk(i, v, 0.83) for i, v in enumerate((0.6, 0.9, 1.3))]
    best = floor(walks)["metric_s"].to_numpy()
    for cell in range(len(SPACE.cells)):
        one = np.ones((3, len(SPACE.cells)))
        one[:, cell] = 0.0
        assert np.all(best <= floor(walks, scores=one)["metric_s"] + 1e-12)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="no route for walk w0"):
        grid_floor(PLANNER, [walk(0, 1.0, 1.0)], {}, SPACE, STANDING, 60.0, "euclid")
    with pytest.raises(InputError, match="do not fit 1 walks and 25 cells"):
        floor([walk(0, 1.0, 1.0)], scores=np.ones((1, 3)))
