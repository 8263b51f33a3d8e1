from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from walklab.capture.constants import without_dependency_effects, without_repetition_variation
from walklab.capture.participants import draw_participants
from walklab.capture.segmentation import SegmentationRules, extract_walks
from walklab.capture.training import TrainingDesign, record_training
from walklab.capture.walker import person_from_row
from walklab.errors import InputError
from walklab.geometry.standing import Standing
from walklab.randomness import generator

LABELS = ["recording", "participant", "configuration", "scene"]


def as_text(frame: pd.DataFrame) -> pd.DataFrame:
    return frame.astype(dict.fromkeys(LABELS, str)) if "scene" in frame else frame


def peaks_m_s(samples: pd.DataFrame, rate_hz: float) -> pd.Series:
    """Peak speed of each walk."""
    return samples.groupby("walk", sort=False)[["x_m", "y_m"]].apply(
        lambda walk: np.hypot(*np.gradient(walk.to_numpy(), 1 / rate_hz, axis=0).T).max()
    )


def test_default_capture_ends_in_the_published_walks(training):
    """Agethen et al. 2017, section 4.2: 1848 walks, 4.97 km, all 30 participants, all 16 configurations."""
    assert len(training.accepted) == 1848
    assert training.accepted["length_m"].sum() / 1000 == pytest.approx(4.97, rel=0.01)
    assert training.accepted["participant"].nunique() == 30
    assert training.accepted["configuration"].nunique() == 16
    assert set(training.samples["walk"]) == set(training.accepted["walk"])


def test_every_rejection_has_its_reason(training):
    reasons = training.walks["rejection"].str.extract(r"^([a-z]+)")[0].value_counts()
    flaws = training.truth["flaw"].value_counts()
    assert reasons["walk"] == 1920
    assert reasons["dropout"] == flaws["dropout"]
    assert reasons["interrupted"] == flaws["stop"]
    assert flaws["dropout"] + flaws["stop"] == 72


def test_walks_back_are_told_by_their_places(training):
    """The labels of the schedule, which the segmentation has not seen, agree with what it found."""
    found = training.walks.assign(recording=training.walks["walk"].str.rsplit("/", n=1).str[0])
    back = found["rejection"].eq("walk back").to_numpy()
    ordered = training.truth.sort_values(["recording", "start_s"], kind="stable")
    found = found.assign(back=back).sort_values(["recording", "start_s"], kind="stable")
    np.testing.assert_array_equal(found["back"].to_numpy(), ~ordered["toward"].to_numpy())


def test_a_participant_is_the_same_in_any_shard(training, plans, constants):
    everyone = list(training.participants["participant"])
    some = training.participants.iloc[[17, 4]].reset_index(drop=True)
    recording, truth = record_training(some, TrainingDesign(), plans, constants, training.seed, 0, all_participants=everyone)
    whole = training.recording[training.recording["participant"].isin(some["participant"])]
    for name in some["participant"]:
        pd.testing.assert_frame_equal(
            as_text(recording[recording["participant"] == name]).reset_index(drop=True),
            as_text(whole[whole["participant"] == name]).reset_index(drop=True),
        )
        pd.testing.assert_frame_equal(
            truth[truth["participant"] == name].reset_index(drop=True),
            training.truth[training.truth["participant"] == name].reset_index(drop=True),
        )


def test_another_replicate_is_another_capture(training, plans, constants):
    one = training.participants.iloc[:1]
    short = TrainingDesign(straight_distances_m=(2.0,), turning_angles_deg=(), straight_repetitions=1, flawed_walks=0)
    first, second = (record_training(one, short, plans, constants, 1, replicate)[1] for replicate in (0, 1))
    assert not np.array_equal(first["end_s"], second["end_s"])


def test_true_walks_are_bounded_by_the_standing_speed_of_the_study(training, plans, constants):
    one = training.participants.iloc[:1]
    short = TrainingDesign(straight_distances_m=(2.0,), turning_angles_deg=(), straight_repetitions=2, flawed_walks=0)
    default, same, high = (
        record_training(one, short, plans, constants, 1, 0, standing=standing) for standing in (None, Standing(), Standing(0.2))
    )
    pd.testing.assert_frame_equal(default[1], same[1])
    pd.testing.assert_frame_equal(as_text(default[0]), as_text(high[0]))
    assert (high[1]["start_s"] > default[1]["start_s"]).all()
    assert (high[1]["end_s"] < default[1]["end_s"]).all()


def test_peak_speeds_look_like_real_ones(data_folder, groups, plans, constants):
    """Median peak speed by distance inside the interquartile range of the goal-directed walks of Maroger et al. 2020.

    Those walks are nearly direct: ours are compared where the path is at most 1.3 times the distance.
    """
    many = replace(groups["training"], count=60, female=10)
    design = TrainingDesign(straight_repetitions=2, turning_repetitions=1, flawed_walks=0)
    people = draw_participants(many, constants, generator(1, 0, "peaks"))
    recording, _ = record_training(people, design, plans, constants, 1, 0)
    walks, samples = extract_walks(recording, people, Standing(), SegmentationRules(), 0.2)
    walks = walks[walks["rejection"] == ""]
    distance = np.hypot(walks["end_x_m"] - walks["start_x_m"], walks["end_y_m"] - walks["start_y_m"]).to_numpy()
    peak = walks["walk"].map(peaks_m_s(samples, 120.0)).to_numpy()
    direct = walks["length_m"].to_numpy() < 1.3 * distance
    archive = np.load(data_folder / "maroger_laas" / "human_float32.npz")
    real = np.concatenate([archive[key][1:8, :4] for key in archive.files if archive[key].ndim == 3])
    real_distance = np.hypot(*(real[:, :2, -1] - real[:, :2, 0]).T)
    real_peak = np.hypot(real[:, 2], real[:, 3]).max(axis=1)
    compared = 0
    for low, high in ((0, 1), (1, 1.5), (1.5, 2), (2, 2.5), (2.5, 3), (3, 3.5), (3.5, 4), (4, 6)):
        known = real_peak[(real_distance >= low) & (real_distance < high)]
        if len(known) < 8:
            continue
        ours = peak[direct & (distance >= low) & (distance < high)]
        compared += 1
        assert np.quantile(known, 0.25) < np.median(ours) < np.quantile(known, 0.75), (low, high)
    assert compared == 7


def test_mean_speeds_lie_among_measured_ones(training):
    """Seethapathi & Srinivasan 2015: mean speeds from stop to stop of about 0.4 to 0.5 m/s at 0.5 m and 0.7 to 1.1 m/s at 4 m.

    Our durations leave out the moments below the standing speed, hence the wider upper limits.
    """
    speed = training.accepted["length_m"] / training.accepted["duration_s"]
    medians = speed.groupby(training.accepted["configuration"]).median()
    assert 0.4 < medians["straight_0.5"] < 0.6
    assert 0.7 < medians["straight_4.0"] < 1.15
    assert medians["turn_180_3.0"] < 0.95 * medians["straight_3.0"]


def test_people_differ_more_than_repetitions(training):
    straight = training.accepted[training.accepted["configuration"] == "straight_4.0"].groupby("participant")["duration_s"]
    assert straight.mean().std() > 1.3 * straight.std().mean() > 0.05


def test_without_repetition_variation_repetitions_are_identical(training, plans, constants):
    same = without_repetition_variation(constants)
    people = training.participants.iloc[:2]
    design = TrainingDesign(straight_distances_m=(2.0,), turning_angles_deg=(90.0,), turning_distances_m=(3.0,), flawed_walks=0)
    recording, _ = record_training(people, design, plans, same, 1, 0)
    walks, samples = extract_walks(recording, people, Standing(), SegmentationRules(), 0.2)
    accepted = walks[walks["rejection"] == ""]
    for _, repetitions in accepted.groupby(["participant", "configuration"]):
        own = [samples.loc[samples["walk"] == walk, ["time_s", "x_m", "y_m"]].to_numpy() for walk in repetitions["walk"]]
        for other in own[1:]:
            np.testing.assert_allclose(other, own[0], atol=1e-9)
    assert accepted["duration_s"].round(6).nunique() == 4


def test_without_dependency_effects_turns_cost_no_time(groups, plans, constants):
    still = without_dependency_effects(constants)
    people = draw_participants(groups["training"], still, generator(1, 0, "training"))
    design = TrainingDesign(straight_distances_m=(3.0,), turning_angles_deg=(180.0,), turning_distances_m=(3.0,), flawed_walks=0)
    recording, _ = record_training(people, design, plans, still, 1, 0)
    walks, _ = extract_walks(recording, people, Standing(), SegmentationRules(), 0.2)
    accepted = walks[walks["rejection"] == ""]
    comfortable = {row["participant"]: person_from_row(row, still).comfortable_speed_m_s for _, row in people.iterrows()}
    excess = accepted["duration_s"] - (accepted["length_m"] - 3.0) / accepted["participant"].map(comfortable)
    medians = excess.groupby(accepted["configuration"]).median()
    assert medians["turn_180_3.0"] == pytest.approx(medians["straight_3.0"], rel=0.03)


def test_missing_plans_and_stations_are_named(training, plans, constants):
    one = training.participants.iloc[:1]
    with pytest.raises(InputError, match=r"turn_30.yaml"):
        record_training(one, TrainingDesign(turning_angles_deg=(30.0,)), plans, constants, 1, 0)
    with pytest.raises(InputError, match="start_5"):
        record_training(one, TrainingDesign(turning_distances_m=(5.0,)), plans, constants, 1, 0)
    with pytest.raises(InputError, match="flawed_walks"):
        record_training(one, TrainingDesign(flawed_walks=100), plans, constants, 1, 0)
