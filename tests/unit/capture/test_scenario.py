from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from shapely import Point, union_all

from walklab.capture.centre_of_mass import from_belt_pose
from walklab.capture.constants import without_repetition_variation
from walklab.capture.scenario import ScenarioDesign, record_scenario
from walklab.capture.segmentation import SegmentationRules, extract_walks
from walklab.errors import InputError
from walklab.geometry.plans import Plan
from walklab.geometry.standing import Standing


def test_scenario_1_ends_near_the_published_figures(scenario_1):
    """Agethen et al. 2017, section 7.4: 1984 walks, 4.06 km."""
    assert len(scenario_1.accepted) == 1984
    assert scenario_1.accepted["length_m"].sum() / 1000 == pytest.approx(4.06, rel=0.02)
    assert sum(ScenarioDesign().sets) == 181


def test_scenario_2_ends_near_the_published_figures(scenario_2):
    """Agethen et al. 2017, section 7.4: 3.26 km; 1086 walks are made, of which 7 are spoilt as in scenario 1."""
    assert len(scenario_2.walks) == 1086
    assert len(scenario_2.accepted) == 1079
    assert scenario_2.accepted["length_m"].sum() / 1000 == pytest.approx(3.26, rel=0.02)


@pytest.mark.parametrize("name", ["scenario_1", "scenario_2"])
def test_walks_are_named_by_their_stations_as_in_the_schedule(name, request):
    captured = request.getfixturevalue(name)
    found = captured.walks.assign(recording=captured.walks["walk"].str.rsplit("/", n=1).str[0])
    found = found.sort_values(["recording", "start_s"], kind="stable")
    true = captured.truth.sort_values(["recording", "start_s"], kind="stable")
    assert list(found["configuration"]) == list(true["configuration"])


@pytest.mark.parametrize("name", ["scenario_1", "scenario_2"])
def test_captured_starts_and_ends_are_free_for_the_planner(name, request, plans):
    captured = request.getfixturevalue(name)
    obstacles = union_all(list(plans[name].scene.obstacles.values()))
    ends = np.vstack([captured.accepted[["start_x_m", "start_y_m"]], captured.accepted[["end_x_m", "end_y_m"]]])
    assert min(obstacles.distance(Point(end)) for end in ends) > 0.25 + 0.01


def test_consecutive_walks_chain(scenario_1):
    accepted = scenario_1.accepted.assign(set=scenario_1.accepted["walk"].str.rsplit("/", n=1).str[0])
    gaps = []
    for _, walks in accepted.groupby("set"):
        gaps += list(
            np.hypot(*(walks[["start_x_m", "start_y_m"]].to_numpy()[1:] - walks[["end_x_m", "end_y_m"]].to_numpy()[:-1]).T)
        )
    assert np.quantile(gaps, 0.98) < 0.04


def test_recording_never_jumps(scenario_1):
    part = scenario_1.recording[scenario_1.recording["recording"] == "scenario_1/P02/set_01"]
    steps = np.hypot(*np.diff(part[["x_m", "y_m"]].to_numpy(), axis=0).T)
    assert np.nanmax(steps) * 60 < 2.5


def poses_of_one(participants, plan: Plan, constants, sets: int = 1) -> tuple[pd.DataFrame, pd.DataFrame]:
    design = ScenarioDesign(sets=(sets,))
    return record_scenario(participants.iloc[:1], plan, design, constants, 1, 0)


def test_centre_of_mass_from_the_pose_is_exact_without_noise(scenario_1, plans, constants):
    """A rigid body that turns, tilts and walks: the derived centre is where the walk and the stoop put it."""
    still = without_repetition_variation(constants)
    people = scenario_1.participants.assign(trait_belt_gap_error_m=0.0)
    poses, truth = poses_of_one(people, plans["scenario_1"], still)
    centre = from_belt_pose(poses, people, ScenarioDesign().controller_offset_m)
    tilted = 1 - 2 * (poses["qx"] ** 2 + poses["qy"] ** 2)  # z component of the controller's z axis
    assert tilted.abs().max() > 0.3  # somebody bent deeply
    standing = poses["time_s"] < 1.5
    at = centre.loc[standing, ["x_m", "y_m"]].to_numpy()
    np.testing.assert_allclose(at, np.tile(plans["scenario_1"].stations["rack_2"].position_m, (len(at), 1)), atol=1e-12)
    end = centre[(poses["time_s"] > truth["end_s"].iloc[-1] + 2.0)][["x_m", "y_m"]].to_numpy()
    np.testing.assert_allclose(end, np.tile(plans["scenario_1"].stations["car"].position_m, (len(end), 1)), atol=1e-12)


def test_controller_sits_in_front_and_turns_with_the_person(scenario_1, plans, constants):
    still = without_repetition_variation(constants)
    people = scenario_1.participants.assign(trait_belt_gap_error_m=0.0)
    poses, _ = poses_of_one(people, plans["scenario_1"], still)
    first, station = poses.iloc[0], plans["scenario_1"].stations["rack_2"]
    reach = people["torso_depth_m"].iloc[0] / 2 + ScenarioDesign().controller_offset_m
    facing = np.deg2rad(station.facing_deg)
    expected = np.array(station.position_m) + reach * np.array([np.cos(facing), np.sin(facing)])
    np.testing.assert_allclose(first[["x_m", "y_m"]].to_numpy(dtype=float), expected, atol=1e-9)


def test_bending_alone_is_no_walk(scenario_1, plans, constants):
    """A set with every walk taken out of the schedule but one: bends remain, one walk is found."""
    plan = replace(plans["scenario_1"], walks=(("rack_3", "car"),))
    poses, _ = poses_of_one(scenario_1.participants, plan, constants, sets=20)
    people = scenario_1.participants
    recording = from_belt_pose(poses, people, ScenarioDesign().controller_offset_m)
    stations = {"scenario_1": {name: station.position_m for name, station in plan.stations.items()}}
    walks, _ = extract_walks(recording, people, Standing(), SegmentationRules(), 0.2, stations)
    assert len(walks) == 20
    assert (walks["rejection"] == "").all()
    assert walks["length_m"].between(0.5, 0.9).all()


def test_a_participant_is_the_same_in_any_shard(scenario_1, plans, constants):
    everyone = list(scenario_1.participants["participant"])
    some = scenario_1.participants.iloc[[6]]
    poses, truth = record_scenario(
        some, plans["scenario_1"], ScenarioDesign(flawed_walks=7), constants, scenario_1.seed, 0, everyone
    )
    recording = from_belt_pose(poses, some, ScenarioDesign().controller_offset_m)
    name = some["participant"].iloc[0]
    whole = scenario_1.recording[scenario_1.recording["participant"] == name]
    np.testing.assert_array_equal(recording[["time_s", "x_m", "y_m"]].to_numpy(), whole[["time_s", "x_m", "y_m"]].to_numpy())
    known = scenario_1.truth[scenario_1.truth["participant"] == name]
    pd.testing.assert_frame_equal(truth, known.reset_index(drop=True))


def test_unchained_walks_and_wrong_counts_are_refused(scenario_1, plans, constants):
    torn = replace(plans["scenario_1"], walks=(("rack_1", "car"), ("rack_2", "car")))
    with pytest.raises(InputError, match="chain"):
        poses_of_one(scenario_1.participants, torn, constants)
    with pytest.raises(InputError, match="sets"):
        record_scenario(scenario_1.participants.iloc[:2], plans["scenario_1"], ScenarioDesign(), constants, 1, 0)


def test_poses_of_strangers_and_broken_quaternions_are_refused(scenario_1, plans, constants):
    poses, _ = poses_of_one(scenario_1.participants, plans["scenario_1"], constants)
    with pytest.raises(InputError, match="torso_depth_m"):
        from_belt_pose(poses, scenario_1.participants.iloc[1:], 0.02)
    with pytest.raises(InputError, match="row 3"):
        from_belt_pose(poses.assign(qw=poses["qw"].where(poses.index != 3, 2.0)), scenario_1.participants, 0.02)
