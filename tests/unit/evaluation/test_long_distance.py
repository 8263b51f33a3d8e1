"""The long-distance study on walks that a known v and a made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.evaluation.long_distance import (
    SETTINGS,
    fine_axes,
    fine_times_s,
    simulated_times_s,
    split_walks,
    static_intervals_s,
    straight_travel_time_s,
    study_long_distances,
)
from walklab.geometry.standing import Standing
from walklab.planning.path_following import PathFollowing
from walklab.steering.space import space_from_config

PLANNER = PathFollowing(("v", "a"), 1 / 60)
SPACE = space_from_config(
    [
        {"name": "v", "unit": "m/s", "start": 0.5, "step": 0.3, "count": 6},
        {"name": "a", "unit": "m/s2", "start": 0.5, "step": 0.5, "count": 4},
    ]
)


def captured(spread: float = 0.0, people: int = 6) -> pd.DataFrame:
    rng = np.random.default_rng(0)
    rows = []
    for person in range(people):
        pace = 1.4 * (1 + spread * rng.normal())
        for distance in (10.0, 25.0, 50.0):
            for repetition in range(1, 5):
                name = f"long/P{person}/{distance:g}/{repetition}"
                time_s = straight_travel_time_s(distance, pace, 1.0)
                rows.append([name, f"P{person}", 1.7 + 0.03 * person, distance, repetition, time_s])
    return pd.DataFrame(rows, columns=["walk", "participant", "height_m", "distance_m", "repetition", "travel_time_s"])


@pytest.mark.parametrize(("distance_m", "v", "a"), [(10.0, 1.7, 1.2), (25.0, 0.8, 0.4), (0.5, 2.0, 0.5)])
def test_simulated_times_tend_to_the_closed_form(distance_m: float, v: float, a: float) -> None:
    fine = replace(PLANNER, step_s=1 / 480)
    times = [simulated_times_s(planner, distance_m, np.array([v, a]), Standing(0.001), 60.0)[0] for planner in (PLANNER, fine)]
    exact = straight_travel_time_s(distance_m, v, a)
    assert times[0] == pytest.approx(exact, abs=4 / 60)
    assert times[1] == pytest.approx(exact, abs=0.02)


def test_the_optimum_reproduces_walks_that_all_are_alike() -> None:
    table, draws, optimum, _ = study_long_distances(captured(), PLANNER, SPACE, Standing(), 5, 0, maxfun=600, resamples=50)
    medians = table[table["statistic"] == "median"].pivot_table(index="distance_m", columns="source", values="value")
    np.testing.assert_allclose(medians["P_Stat"], medians["Ref"], rtol=0.02)
    ranges = table[table["statistic"] == "iqr"].pivot_table(index="distance_m", columns="source", values="value")
    assert (ranges["P_Stat"] == 0).all()
    assert (ranges["P_Prob"] > 0).all()
    assert optimum["value"].iloc[0] == pytest.approx(1.4, abs=0.1)
    assert len(draws) == 4 * 36
    assert draws.loc[draws["source"] == "Ref", ["v", "a"]].isna().all(axis=None)


def test_the_exponent_is_learned_from_the_training_half_and_sharpens() -> None:
    walks = captured(0.05)
    table, _, _, sharpness = study_long_distances(walks, PLANNER, SPACE, Standing(), 5, 0, maxfun=20, resamples=20)
    chosen = sharpness[sharpness["chosen"]]
    assert len(chosen) == 1
    assert chosen["crps_s"].iloc[0] == sharpness["crps_s"].min()
    assert chosen["exponent"].iloc[0] > 1  # people who are alike are forecast best by a sharp density
    ranges = table[table["statistic"] == "iqr"].pivot_table(index="distance_m", columns="source", values="value")
    assert (ranges["P_Prob (calibrated)"] < ranges["P_Prob"]).all()
    _, test = split_walks(walks, "repetition")
    changed = walks.copy()
    changed.loc[changed["walk"].isin(test["walk"]), "travel_time_s"] *= 3
    again = study_long_distances(changed, PLANNER, SPACE, Standing(), 5, 0, maxfun=20, resamples=20)[3]
    pd.testing.assert_frame_equal(again, sharpness)  # no test walk has been read


def test_interpolated_times_are_those_of_simulations() -> None:
    axes = fine_axes(SPACE)
    rng = np.random.default_rng(3)
    places = np.column_stack([rng.integers(len(axis), size=60) for axis in axes])
    cells = np.column_stack([axis[place] for axis, place in zip(axes, places.T, strict=True)])
    for distance_m in (10.0, 50.0):
        times = simulated_times_s(PLANNER, distance_m, SPACE.cells, Standing(), 600.0)
        fine = fine_times_s(distance_m, times, SPACE).reshape([len(axis) for axis in axes])
        exact = simulated_times_s(PLANNER, distance_m, cells, Standing(), 600.0)
        np.testing.assert_allclose(fine[tuple(places.T)], exact, atol=0.1)


def test_the_interval_of_the_optimum_is_as_wide_as_training_people_differ() -> None:
    def widths(spread: float, people: int) -> np.ndarray:
        walks = captured(spread, people)
        times = {d: simulated_times_s(PLANNER, d, SPACE.cells, Standing(), 600.0) for d in (10.0, 25.0, 50.0)}
        intervals = static_intervals_s(walks, times, SPACE, 600.0, np.random.default_rng(0), 200)
        return np.array([high - low for low, high in intervals.values()])

    np.testing.assert_array_equal(widths(0.0, 6), 0.0)
    some = widths(0.1, 6)
    assert np.all(some > [0.3, 0.8, 1.5])
    assert np.all(np.diff(some) > 0)
    assert np.isnan(widths(0.1, 1)).all()


def test_the_table_has_an_interval_of_the_optimum_that_contains_it() -> None:
    table = study_long_distances(captured(0.1), PLANNER, SPACE, Standing(), 5, 0, maxfun=600, resamples=200)[0]
    static = table[table["source"] == "P_Stat"].set_index(["statistic", "distance_m"])
    median = static.loc["median"]
    assert ((median["low"] <= median["value"] + 0.1) & (median["value"] - 0.1 <= median["high"])).all()
    assert (median["high"] - median["low"] > 0.1).all()
    assert static.loc["iqr", ["low", "high"]].isna().all(axis=None)
    assert (static.loc["iqr", "value"] == 0).all()


def test_draws_depend_on_seed_and_walk_only() -> None:
    walks = captured(0.1)
    first = study_long_distances(walks, PLANNER, SPACE, Standing(), 5, 0, maxfun=20, resamples=20)[1]
    again = study_long_distances(walks, PLANNER, SPACE, Standing(), 5, 0, maxfun=20, resamples=20)[1]
    other = study_long_distances(walks, PLANNER, SPACE, Standing(), 6, 0, maxfun=20, resamples=20)[1]
    pd.testing.assert_frame_equal(first, again)
    drawn = first["source"] == "P_Prob"
    assert not np.allclose(first.loc[drawn, "v"], other.loc[drawn, "v"])


def test_halves_share_participants_by_repetition_and_none_by_participant() -> None:
    walks = captured()
    training, test = split_walks(walks, "repetition")
    assert set(training["participant"]) == set(test["participant"])
    assert set(training["repetition"]) == {1, 3}
    training, test = split_walks(walks, "participant")
    assert not set(training["participant"]) & set(test["participant"])
    assert len(training) == len(test) == 36
    with pytest.raises(InputError, match="cannot be halved"):
        split_walks(walks[walks["participant"] == "P0"], "participant")
    with pytest.raises(InputError, match="neither repetition nor participant"):
        split_walks(walks, "height")  # type: ignore[arg-type]


def test_more_neighbours_than_a_distance_has_walks_are_refused() -> None:
    with pytest.raises(InputError, match="at most 20"):
        study_long_distances(captured(), PLANNER, SPACE, Standing(), 5, 0, settings=replace(SETTINGS, k=30))
