"""Leave-one-subject-out: no leak, exact baselines, scores by their definition, every subject once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.capture.own import OwnColumns, import_walks
from walklab.capture.walks import WALKS, Walk, read_walks, write_walks
from walklab.errors import InputError
from walklab.evaluation.baselines import climatology, regression, task_speeds
from walklab.evaluation.cross_validation import CrossValidationOptions, Study, leave_one_subject_out, leave_out
from walklab.evaluation.forecasts import BARE, INFORMED, Forecast
from walklab.evaluation.score_tables import walk_scores
from walklab.evaluation.subject_scores import OWN_MAP, subject_scores, summarise
from walklab.geometry import curves
from walklab.geometry.scene import Body, Scene
from walklab.geometry.standing import Standing
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.path_following import PathFollowing
from walklab.steering.dependencies import dependency_vectors
from walklab.steering.routes import find_routes, pack, task_of
from walklab.steering.space import ParameterSpace, space_from_config
from walklab.steering.suitability import score_walks
from walklab.steering.training import TrainingSettings

EXAMPLES = Path(__file__).parents[3] / "examples"
SPACE = space_from_config(
    [
        {"name": "v", "unit": "m/s", "start": 0.6, "step": 0.3, "count": 5},
        {"name": "a", "unit": "m/s2", "start": 0.5, "step": 0.75, "count": 3},
    ]
)
PLANNER = PathFollowing(("v", "a"), fixed={"omega": 2.0})
STANDING = Standing()
SETTINGS = TrainingSettings(count=None, k=5)
OPTIONS = CrossValidationOptions(time_limit_s=20, static_maxfun=60)
TRUTH = (1.2, 1.25)  # a cell of the space


def simulated_walk(participant: str, number: int, length_m: float, height_m: float, truth: tuple[float, float]) -> Walk:
    """A walk the planner made itself, so that the right parameters are known."""
    row = pd.Series(dict.fromkeys(WALKS.columns, 0.0), dtype=object)
    row["walk"], row["participant"], row["scene"] = f"test/{participant}/{number}", participant, "open"
    row["configuration"], row["rejection"], row["height_m"], row["end_x_m"] = "straight", "", height_m, length_m
    trajectory = PLANNER.follow(np.array([[0.0, 0.0], [length_m, 0.0]]), task_of(row), np.array(truth), 20.0)
    row["duration_s"] = trajectory_travel_time_s(trajectory, task_of(row), STANDING.standing_speed_m_s)
    row["length_m"] = curves.length(trajectory.positions_m)
    return Walk(row, np.arange(len(trajectory.positions_m)) * PLANNER.step_s, trajectory.positions_m)


def study_of(walks: list[Walk]) -> Study:
    routes = find_routes(walks, {"open": Scene("open")}, PLANNER, Body())
    vectors = dependency_vectors(pd.DataFrame([walk.row for walk in walks]), routes, ["length", "height"])
    return Study(
        walks, routes, vectors, score_walks(PLANNER, pack(walks, routes, PLANNER), SPACE.cells), PLANNER, SPACE, STANDING
    )


@pytest.fixture(scope="module", autouse=True)
def one_thread() -> Iterator[None]:
    """The annealing scores one cell at a time: on so few walks, waking threads costs more than the work."""
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(before)


@pytest.fixture(scope="module")
def walks() -> list[Walk]:
    """Four people, unequally many walks."""
    rng = np.random.default_rng(5)
    heights = {"A": 1.62, "B": 1.70, "C": 1.78, "D": 1.86}
    counts = {"A": 2, "B": 3, "C": 4, "D": 6}
    return [
        simulated_walk(name, number, rng.uniform(1.5, 4.0), heights[name], TRUTH)
        for name in heights
        for number in range(counts[name])
    ]


@pytest.fixture(scope="module")
def study(walks: list[Walk]) -> Study:
    return study_of(walks)


def test_parameters_that_made_all_walks_are_found_for_people_never_seen(study: Study) -> None:
    """Every walk was made by one cell: P_Stat and P_Adapt forecast it to a few frames, and the samples surround it."""
    result = leave_one_subject_out(study, SETTINGS, OPTIONS, 1, 0)
    best = result.predictions[result.predictions["model"] == "P_Stat (point)"]
    assert best["crps_s"].max() <= 3 / 60 + 1e-9
    adaptive = result.predictions[result.predictions["model"] == "P_Adapt (point)"]
    assert adaptive["crps_s"].max() < 0.15
    drawn = result.predictions[result.predictions["model"] == "P_Prob (literal)"]
    assert drawn["coverage_90"].all()
    assert (drawn["crps_s"] < 1.0).all()
    sharp = result.predictions[result.predictions["model"] == "P_Prob (calibrated)"]
    assert sharp["crps_s"].mean() < 0.5 * drawn["crps_s"].mean()
    # Where there are trajectories they are scored, and the sharper density has the better ones.
    assert 0 < sharp["energy_m"].mean() < drawn["energy_m"].mean()
    assert result.predictions["energy_m"].notna().all()  # what forecasts times alone is put on the planned route
    counts = result.calibration.query("quantity == 'pit' and model == 'regression'")["value"]
    assert counts.sum() == pytest.approx(1.0)


def test_nothing_of_the_forecast_walks_is_used_but_their_tasks_and_the_height(study: Study) -> None:
    """Everything measured of participant B changes; the forecasts of B must not, and those of the others must."""
    rng = np.random.default_rng(9)
    changed, scores = [], study.scores.copy()
    for index, walk in enumerate(study.walks):
        if walk.row["participant"] == "B":
            row = walk.row.copy()
            row["duration_s"], row["length_m"], row["curvature_1_m"] = 9.0, 77.0, 5.0
            changed.append(Walk(row, walk.time_s * 3, walk.position_m + rng.normal(size=walk.position_m.shape)))
            scores[index] = rng.uniform(size=scores.shape[1])
        else:
            changed.append(walk)
    other = replace(study, walks=changed, scores=scores)
    forecast = ["model", "walk", "point_s", "width_90_s", "inside_hull"]
    before, after = (leave_out("B", which, SETTINGS, OPTIONS, 1, 0) for which in (study, other))
    # The error floor alone reads the walk itself.
    assert np.any(before.loc[before["model"] == OWN_MAP, "point_s"] != after.loc[after["model"] == OWN_MAP, "point_s"])
    before, after = (frame[frame["model"] != OWN_MAP] for frame in (before, after))
    informed = before["model"].isin(INFORMED)
    pd.testing.assert_frame_equal(before.loc[~informed, forecast], after.loc[~informed, forecast])
    # What uses a person's earlier walks, and says so, knows nothing before the first, and something after it.
    first = informed & (before["walk"] == before["walk"].iloc[0])
    pd.testing.assert_frame_equal(before.loc[first, forecast], after.loc[first, forecast])
    later = informed & ~first
    assert (before.loc[later, "point_s"] != after.loc[later, "point_s"]).all()
    before, after = (leave_out("C", which, SETTINGS, OPTIONS, 1, 0) for which in (study, other))
    for model in (
        "P_Prob (literal)",
        "P_Prob without dependencies",
        "climatology",
        "regression",
        "Gaussian process",
        "P_Prob (extended)",
    ):
        one, two = (frame.loc[frame["model"] == model, ["point_s", "width_90_s"]].to_numpy() for frame in (before, after))
        assert np.any(one != two), model


def test_one_participant_alone_gives_the_rows_of_the_whole_study(study: Study) -> None:
    """Shards by participant cannot change the tables."""
    whole = leave_one_subject_out(study, SETTINGS, OPTIONS, 3, 0)
    alone = leave_out("C", study, SETTINGS, OPTIONS, 3, 0)
    pd.testing.assert_frame_equal(whole.predictions[whole.predictions["participant"] == "C"].reset_index(drop=True), alone)
    assert len(whole.scores) == 4 * alone["model"].nunique()
    assert set(whole.scores["walks"]) == {2, 3, 4, 6}
    assert (whole.summary["participants"] == 4).all()


def test_without_dependencies_everybody_gets_the_same_distribution(walks: list[Walk]) -> None:
    """The same task of a tall and of a short person: the same forecast to the last digit, unlike that of a regression."""
    study = study_of([*walks, simulated_walk("E", 0, 2.5, 1.55, TRUTH)])
    taller = study.vectors.copy()
    taller.loc["test/E/0", "height"] = 1.95
    tables = [leave_out("E", which, SETTINGS, OPTIONS, 1, 0) for which in (study, replace(study, vectors=taller))]
    short, tall = (table.set_index("model")["point_s"] for table in tables)
    assert short[BARE] == tall[BARE]
    assert short["regression"] != tall["regression"]


def test_moving_ends_add_the_baseline_of_the_task_alone(study: Study) -> None:
    moving = []
    for walk in study.walks:
        row = walk.row.copy()
        row["start_speed_m_s"] = row["end_speed_m_s"] = 1.2
        moving.append(Walk(row, walk.time_s, walk.position_m))
    rows = leave_out("A", replace(study, walks=moving), SETTINGS, OPTIONS, 1, 0).query("model == 'task speeds alone'")
    lengths = study.planned_lengths_m[study.participants == "A"]
    np.testing.assert_allclose(rows["point_s"], lengths / 1.2)
    assert "task speeds alone" not in set(leave_out("A", study, SETTINGS, OPTIONS, 1, 0)["model"])
    assert task_speeds([1.0, 1.0], [0.0, 1.0], [1.0, 1.0]) is None


def test_mismatched_tables_and_too_few_people_are_refused(study: Study) -> None:
    with pytest.raises(InputError, match="same order"):
        replace(study, vectors=study.vectors.iloc[::-1])
    keep = np.isin(study.participants, ["A", "B"])
    few = replace(
        study,
        walks=[walk for walk, kept in zip(study.walks, keep, strict=True) if kept],
        vectors=study.vectors[keep],
        scores=study.scores[keep],
    )
    with pytest.raises(InputError, match="2 participants are too few"):
        leave_one_subject_out(few, SETTINGS, OPTIONS, 1, 0)
    with pytest.raises(InputError, match="k = 500"):
        leave_out("A", study, replace(SETTINGS, k=500), OPTIONS, 1, 0)


def test_climatology_gives_every_participant_the_same_share() -> None:
    """One slow walk of one person against 99 fast ones of another: half the members are slow."""
    durations, lengths = np.array([4.0] + [2.0] * 99), np.full(100, 2.0)
    members = climatology(durations, lengths, ["slow"] + ["fast"] * 99, [3.0], 200)
    assert members.shape == (1, 200)
    assert np.sum(np.isclose(members, 6.0)) == 100
    assert np.sum(np.isclose(members, 3.0)) == 100


def test_regression_is_the_textbook_prediction_interval() -> None:
    """One regressor: fitted value, standard error of a new observation and t quantiles written out."""
    rng = np.random.default_rng(2)
    x = rng.uniform(1, 4, 20)
    y = 0.8 + 0.7 * x + rng.normal(0, 0.2, 20)
    members = regression(y, np.column_stack([x, np.full(20, 1.7)]), [[2.5, 1.7]], 400)[0]
    slope, intercept = np.polyfit(x, y, 1)
    residual = np.sqrt(np.sum((y - intercept - slope * x) ** 2) / 18)
    error = residual * np.sqrt(1 + 1 / 20 + (2.5 - x.mean()) ** 2 / np.sum((x - x.mean()) ** 2))
    expected = intercept + slope * 2.5 + error * stats.t.ppf((np.arange(400) + 0.5) / 400, 18)
    np.testing.assert_allclose(members, expected, rtol=1e-9)
    with pytest.raises(InputError, match="too few"):
        regression([1.0, 2.0, 3.0], [[1.0], [2.0], [3.0]], [[1.0]])


def test_the_error_floor_is_that_of_the_walks_own_map_and_is_compared_with_nothing(study: Study) -> None:
    result = leave_one_subject_out(study, SETTINGS, OPTIONS, 1, 0)
    floor = result.predictions[result.predictions["model"] == OWN_MAP]
    np.testing.assert_allclose(floor["crps_s"], 0.0, atol=1e-6)  # every walk was made by a cell
    summary = result.summary.set_index("model")
    assert summary.loc[OWN_MAP, "kind"] == "error floor"
    assert summary["kind"].eq("forecast").sum() == len(summary) - 1
    assert summary["better_than_reference"].isna().tolist() == (summary.index == OWN_MAP).tolist()
    assert summary["crps_minus_reference_s"].isna().tolist() == (summary.index == OWN_MAP).tolist()
    with pytest.raises(InputError, match=r"no model .best cell"):
        summarise(result.scores, OWN_MAP, np.random.default_rng(0))


def predictions_of(errors: dict[str, dict[str, list[float]]]) -> pd.DataFrame:
    frames = []
    for model, people in errors.items():
        for participant, values in people.items():
            captured = np.full(len(values), 3.0)
            walks = pd.DataFrame({"walk": "w", "participant": participant, "inside_hull": [True] * len(values)})
            members = captured[:, None] + np.array(values)[:, None]
            frames.append(walk_scores(captured, {model: Forecast(members)}, walks).assign(point_s=members[:, 0]))
    return pd.concat(frames, ignore_index=True)


def test_every_participant_counts_once_however_many_walks() -> None:
    errors = {"ours": {"A": [1.0], "B": [0.0] * 50, "C": [-0.5]}, "theirs": {"A": [2.0], "B": [0.5] * 50, "C": [-1.0]}}
    scores = subject_scores(predictions_of(errors))
    summary = summarise(scores, "theirs", np.random.default_rng(0)).set_index("model")
    assert summary.loc["ours", "median_abs_dt_s"] == pytest.approx((1.0 + 0.0 + 0.5) / 3)
    assert summary.loc["ours", "median_dt_s"] == pytest.approx((1.0 + 0.0 - 0.5) / 3)
    assert summary.loc["ours", "crps_minus_reference_s"] == pytest.approx(-(1.0 + 0.5 + 0.5) / 3)
    assert summary.loc["ours", "better_than_reference"] == 3
    assert summary.loc["theirs", "crps_minus_reference_s"] == 0.0
    assert summary.loc["ours", "walks"] == 52
    with pytest.raises(InputError, match="no model 'nobody'"):
        summarise(scores, "nobody", np.random.default_rng(0))


def test_interval_over_subjects_covers_the_mean_as_often_as_it_says() -> None:
    """Ten subjects drawn 200 times: the 95 % interval of the mean holds the true mean in about 95 %."""
    rng = np.random.default_rng(11)
    scores = subject_scores(predictions_of({"ours": {f"P{i}": [0.0] for i in range(10)}}))
    held = 0
    for _ in range(200):
        row = summarise(scores.assign(median_dt_s=rng.normal(0.4, 0.2, 10)), "ours", rng, resamples=400).iloc[0]
        held += row["median_dt_s_low"] <= 0.4 <= row["median_dt_s_high"]
    assert 1e-3 < stats.binom.cdf(held, 200, 0.95) < 1 - 1e-3


def test_the_space_is_data() -> None:
    """The study knows its parameters only from the space: another number of axes goes through the same code."""
    space = ParameterSpace(SPACE.axes[:1])
    planner = PathFollowing(("v",), fixed={"omega": 2.0, "a": 1.25})
    walks = [simulated_walk(name, n, 2.0 + n, 1.7, TRUTH) for name in "ABC" for n in range(3)]
    routes = find_routes(walks, {"open": Scene("open")}, planner, Body())
    vectors = dependency_vectors(pd.DataFrame([walk.row for walk in walks]), routes, ["length"])
    scores = score_walks(planner, pack(walks, routes, planner), space.cells)
    study = Study(walks, routes, vectors, scores, planner, space, STANDING)
    result = leave_one_subject_out(study, replace(SETTINGS, k=3), OPTIONS, 1, 0)
    assert result.predictions.query("model == 'P_Stat (point)'")["crps_s"].max() <= 3 / 60 + 1e-9


def test_example_of_own_walks_goes_through_the_whole_chain(tmp_path: Path) -> None:
    """From the CSV in examples/ to scores: four people, every model, and a static model that learnt how they walk."""
    columns = OwnColumns("person", "walk", "time_s", "x_m", "y_m", "height_cm")
    tables = import_walks(EXAMPLES / "own_walks.csv", columns, height_unit="cm")
    write_walks(*tables, tmp_path / "walks.parquet", tmp_path / "samples.parquet")
    study = study_of(read_walks(tmp_path / "walks.parquet", tmp_path / "samples.parquet"))
    result = leave_one_subject_out(study, SETTINGS, OPTIONS, 1, 0)
    assert len(result.scores) == 4 * result.predictions["model"].nunique()
    assert (result.scores["walks"] == 5).all()
    summary = result.summary.set_index("model")
    assert np.isfinite(summary[["median_abs_dt_s", "crps_s", "coverage_90"]].to_numpy(dtype=float)).all()
    # Standing starts and stops take time that a mean pace does not know of.
    assert summary.loc["P_Stat (point)", "median_abs_point_dt_s"] < summary.loc["climatology", "median_abs_point_dt_s"]
