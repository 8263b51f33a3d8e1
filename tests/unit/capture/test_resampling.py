"""Resampled walks: real shapes keep their shape, take the published time, and no held-out person shares a subject."""

from __future__ import annotations

import re
from functools import partial

import numpy as np
import pandas as pd
import pytest

from walklab.capture.constants import WalkerConstants
from walklab.capture.foot_markers import Ramps
from walklab.capture.long_distance import LongDistanceDesign
from walklab.capture.participants import draw_participants
from walklab.capture.published_times import LONG_WALKS, SHORT_WALKS, mean_speed_m_s
from walklab.capture.real_shapes import PATH, START, STOP, SWING, PathShape, RealShapes, read_shapes, write_shapes
from walklab.capture.recorded_shapes import import_shapes
from walklab.capture.resampling import (
    HELD_OUT,
    RealWalks,
    deal,
    lay,
    resample_long_distance,
    resampled_person,
    scaled_profile,
)
from walklab.capture.segmentation import SegmentationRules, extract_walks
from walklab.capture.training import TrainingDesign, record_training
from walklab.errors import InputError
from walklab.geometry.curves import arc_length, length, resample
from walklab.geometry.standing import Standing
from walklab.randomness import generator

SUBJECTS = tuple(f"{number:02d}" for number in range(1, 11))


def shape(distance_m: float, bulge: float) -> PathShape:
    share = np.linspace(0, 1, 200)
    return PathShape(distance_m, share, bulge * np.sin(np.pi * share))


@pytest.fixture(scope="module")
def ramps() -> Ramps:
    return Ramps(np.linspace(0.02, 1, 80), np.linspace(1, 0.02, 150), 0.01, 1.25)


@pytest.fixture(scope="module")
def shapes(ramps: Ramps) -> RealShapes:
    """Made-up recordings: every subject's paths bulge by an amount of its own, every subject's speed swings by one."""
    paths = {name: tuple(shape(d, 0.01 * int(name)) for d in (0.9, 1.7, 3.4, 4.2)) for name in SUBJECTS}
    wave = np.sin(2 * np.pi * np.arange(250) / 55)
    return RealShapes(paths, {name: (1 + 0.01 * int(name) * wave,) for name in SUBJECTS}, ramps)


def test_on_a_straight_way_a_path_is_laid_by_a_similarity() -> None:
    real = shape(4.0, 0.05)
    way = resample(np.array([[1.0, 2.0], [1.0, 5.0]]))
    laid = lay(real, way)
    np.testing.assert_allclose(laid[[0, -1]], [[1, 2], [1, 5]], atol=1e-9)
    own = np.column_stack([real.along, real.aside])
    gaps = np.hypot(*np.diff(laid, axis=0).T) / np.hypot(*np.diff(own, axis=0).T)
    np.testing.assert_allclose(gaps, 3.0, rtol=1e-6)
    assert laid[100, 0] < 1.0  # walking up, the left is at smaller x


def test_steps_back_before_the_start_are_kept() -> None:
    real = PathShape(1.0, np.array([0.0, -0.02, 0.5, 1.03, 1.0]), np.zeros(5))
    laid = lay(real, resample(np.array([[0.0, 0.0], [2.0, 0.0]])))
    np.testing.assert_allclose(laid[:, 0], [0.0, -0.04, 1.0, 2.06, 2.0], atol=1e-9)


def test_round_an_obstacle_the_deviation_stands_out_from_the_way() -> None:
    angle = np.linspace(0, np.pi, 400)
    way = np.column_stack([np.cos(angle), np.sin(angle)])  # left is inwards
    laid = lay(shape(3.0, 0.05), way)
    radius = np.hypot(*laid.T)
    np.testing.assert_allclose(radius[[0, -1]], 1.0, atol=1e-3)
    assert radius.min() == pytest.approx(1 - 0.05 * np.pi, abs=2e-3)


@pytest.mark.parametrize(("way_m", "duration_s"), [(0.5, 1.1), (2.0, 2.3), (4.0, 4.5), (4.7, 9.0)])
def test_a_profile_covers_its_length_in_its_time(ramps: Ramps, way_m: float, duration_s: float) -> None:
    profile = scaled_profile(way_m, duration_s, ramps, 1 + 0.05 * np.sin(np.arange(300) / 9), 17)
    assert profile.duration_s == pytest.approx(duration_s)
    fine = np.linspace(0, duration_s, 4001)
    assert profile.travelled(fine)[-1] == pytest.approx(way_m, rel=1e-9)
    assert np.trapezoid(profile.speed(fine), fine) == pytest.approx(way_m, rel=1e-3)
    assert profile.speed(np.array([-0.1, duration_s + 0.1])).tolist() == [0.0, 0.0]
    assert profile.speed(fine).min() >= 0.0
    assert max(profile.speed(np.array([0.0, duration_s]))) < 0.1 * profile.peak_m_s


def test_without_swing_a_profile_is_the_real_start_and_stop(ramps: Ramps) -> None:
    profile = scaled_profile(4.0, 4.5, ramps, np.ones(50), 0)
    at = 0.01 * np.arange(80)
    np.testing.assert_allclose(profile.speed(at) / profile.peak_m_s, ramps.start, atol=0.01)
    np.testing.assert_allclose(profile.speed(4.5 - 1.49 + 0.01 * np.arange(150)) / profile.peak_m_s, ramps.stop, atol=0.01)


def test_held_out_people_share_no_subject_with_training() -> None:
    training, held_out = deal(SUBJECTS, 20170728, "paths")
    assert len(held_out) == HELD_OUT
    assert sorted(training + held_out) == list(SUBJECTS)
    with pytest.raises(InputError, match="hold some out"):
        deal(SUBJECTS[:HELD_OUT], 1, "paths")


def test_participants_of_both_experiments_resample_other_subjects(shapes, groups, constants) -> None:
    lent = {}
    for name in ("training", "scenarios"):
        people = draw_participants(groups[name], constants, generator(1, 0, name))
        sources = [resampled_person(row, constants, shapes, 5).source for _, row in people.iterrows()]
        lent[name] = {round(float(np.abs(s.paths[0].aside).max()), 3) for s in sources if isinstance(s, RealWalks)}
    assert len(lent["scenarios"]) == HELD_OUT
    assert len(lent["training"]) == len(SUBJECTS) - HELD_OUT
    assert not lent["training"] & lent["scenarios"]


def test_walks_take_the_published_time_of_their_length(shapes) -> None:
    """Over many repetitions the median time is way / (published speed x pace), and it spreads as published."""
    walks = RealWalks(shapes.paths["03"], shapes.swings["03"], shapes.ramps, 1.2, 0.045)
    rng = generator(3, "times")
    for way_m, speed in SHORT_WALKS:
        way = resample(np.array([[0.0, 0.0], [way_m, 0.0]]))
        times = np.array([walks.draw(way, rng).duration_s for _ in range(400)])
        assert np.median(times) == pytest.approx(way_m / (speed * 1.2), rel=0.01)
        assert np.log(times).std() == pytest.approx(0.045, rel=0.12)


def test_mean_speed_grows_with_distance_between_the_published_ones() -> None:
    at = np.array([mean_speed_m_s(d) for d in np.linspace(0.5, 4.0, 40)])
    assert np.all(np.diff(at) > 0)
    assert (at[0], at[-1]) == (pytest.approx(0.45), pytest.approx(0.9))
    assert mean_speed_m_s(0.01) == 0.2


def test_a_drawn_walk_is_as_long_as_its_path(shapes) -> None:
    walks = RealWalks(shapes.paths["05"], shapes.swings["05"], shapes.ramps, 1.0, 0.045)
    walk = walks.draw(resample(np.array([[0.0, 0.0], [3.0, 0.0]])), generator(3, "one"))
    assert walk.bell.travelled(np.array([walk.duration_s]))[0] == pytest.approx(length(walk.path), rel=1e-9)
    assert np.all(np.diff(arc_length(walk.path)) > 0)


def test_the_study_can_cut_resampled_recordings_into_walks(shapes, groups, plans) -> None:
    constants = WalkerConstants()
    people = draw_participants(groups["training"], constants, generator(1, 0, "training")).iloc[:2]
    design = TrainingDesign(
        straight_distances_m=(0.5, 4.0), turning_angles_deg=(90.0,), straight_repetitions=2, turning_repetitions=1, flawed_walks=1
    )
    make = partial(resampled_person, shapes=shapes, seed=5)
    recording, truth = record_training(people, design, plans, constants, 1, 0, make_person=make)
    again, _ = record_training(people.iloc[1:], design, plans, constants, 1, 0, tuple(people["participant"]), make_person=make)
    second = recording[recording["participant"] == people["participant"].iloc[1]]
    np.testing.assert_array_equal(second[["x_m", "y_m"]].to_numpy(), again[["x_m", "y_m"]].to_numpy())
    walks, _ = extract_walks(recording, people, Standing(), SegmentationRules(), 0.1)
    accepted = walks[walks["rejection"] == ""]
    assert len(accepted) == truth["toward"].sum() - 1  # all but the flawed one
    straight = accepted[accepted["configuration"] == "straight_4.0"]
    assert straight["length_m"].between(4.0, 4.3).all()


def test_long_walks_have_the_published_median_and_range(groups, constants) -> None:
    many = [draw_participants(groups["long_distance"], constants, generator(s, 0, "long")) for s in range(40)]
    people = pd.concat(many, ignore_index=True)
    people["participant"] = [f"long_distance_P{n:03d}" for n in range(len(people))]
    times = resample_long_distance(people, LongDistanceDesign(), constants, 1, 0)
    for distance, part in times.groupby("distance_m")["travel_time_s"]:
        median_s, iqr_s = LONG_WALKS[float(distance)]
        assert part.median() == pytest.approx(median_s, rel=0.01)
        assert part.quantile(0.75) - part.quantile(0.25) == pytest.approx(iqr_s, rel=0.12)
    with pytest.raises(InputError, match="12 m"):
        resample_long_distance(people.iloc[:1], LongDistanceDesign(distances_m=(12.0,)), constants, 1, 0)


def test_a_missing_recording_is_named(tmp_path) -> None:
    with pytest.raises(InputError, match=r"human_float32\.npz: not there"):
        import_shapes(tmp_path)


def test_a_table_without_a_kind_is_refused(tmp_path) -> None:
    rows = [(kind, "01", "w", 1.0, x, 1.0) for kind in (PATH, START, STOP) for x in (0.0, 0.01)]
    table = pd.DataFrame(rows, columns=["kind", "subject", "walk", "distance_m", "x", "y"])
    write_shapes(table, tmp_path / "shapes.parquet")
    with pytest.raises(InputError, match=re.escape("no row is a swing")):
        read_shapes(tmp_path / "shapes.parquet")
    assert SWING == "swing"


def test_shapes_of_the_real_recordings(data_folder, tmp_path) -> None:
    """Ten subjects with eight straight walks each, ten who swing by some per cent of their speed, one start and stop."""
    try:
        table = import_shapes(data_folder)
    except InputError as error:
        pytest.skip(str(error))
    write_shapes(table, tmp_path / "shapes.parquet")
    found = read_shapes(tmp_path / "shapes.parquet")
    assert [len(paths) for paths in found.paths.values()] == [8] * 10
    assert len(found.swings) == 10
    for paths in found.paths.values():
        for path in paths:
            np.testing.assert_allclose([path.along[0], path.aside[0], path.along[-1], path.aside[-1]], [0, 0, 1, 0], atol=1e-9)
            assert np.abs(path.aside).max() < 0.25
    spread = [float(np.mean([swing.std() for swing in swings])) for swings in found.swings.values()]
    assert 0.02 < min(spread) < max(spread) < 0.12
