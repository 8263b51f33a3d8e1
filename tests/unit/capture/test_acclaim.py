"""Acclaim recordings: closed-form and brute-force kinematics, named faults, and the CMU walks where they are at hand."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest

from walklab.capture.acclaim import CMU_UNIT_M, floor_plan, import_walks
from walklab.capture.acclaim_files import read_motion, read_skeleton
from walklab.capture.acclaim_skeleton import ROOT, Motion, Skeleton, joint_positions
from walklab.capture.body_segments import CMU_SEGMENTS, Segment, StatureRule, centre_of_mass, stature
from walklab.errors import InputError

SKELETON = """# a made-up arm
:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name upper
     direction 1 0 0
     length 2.0
     axis 30 -20 50 XYZ
     dof rx ry rz
     limits (-160.0 20.0)
            (-70.0 70.0)
            (-60.0 70.0)
  end
  begin
     id 2
     name joint
     direction 0 1 0
     length 0.5
     axis 0 0 0 XYZ
  end
  begin
     id 3
     name lower
     direction 0.6 0.8 0
     length 1.0
     axis 0 0 0 XYZ
     dof rz
  end
:hierarchy
  begin
    root upper
    upper joint
    joint lower
  end
"""

MOTION = """#!comment
:FULLY-SPECIFIED
:DEGREES
7
root 1 2 3 0 0 0
upper 0 0 0
lower 90
8
root 1 2 3 10 -20 30
upper 40 5 -60
lower -35
"""


@pytest.fixture
def arm(tmp_path: Path) -> tuple[Path, Path]:
    (tmp_path / "arm.asf").write_text(SKELETON)
    (tmp_path / "arm_01.amc").write_text(MOTION)
    return tmp_path / "arm.asf", tmp_path / "arm_01.amc"


def turn(axis: str, degrees: float) -> np.ndarray:
    """Rotation matrix about one axis, written out."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


def test_channels_at_zero_are_the_rest_pose_and_one_joint_bends_about_its_axis(arm: tuple[Path, Path]) -> None:
    skeleton = read_skeleton(arm[0])
    ends = joint_positions(skeleton, read_motion(arm[1], skeleton))
    np.testing.assert_allclose(ends["upper"][0], [3, 2, 3], atol=1e-12)
    np.testing.assert_allclose(ends["joint"][0], [3, 2.5, 3], atol=1e-12)
    np.testing.assert_allclose(ends["lower"][0], [3 - 0.8, 2.5 + 0.6, 3], atol=1e-12)


def test_order_of_axes_follows_the_format(arm: tuple[Path, Path]) -> None:
    """Second frame by written-out matrices: X first, then Y, then Z, each about a fixed axis, inside the bone's frame."""
    skeleton = read_skeleton(arm[0])
    ends = joint_positions(skeleton, read_motion(arm[1], skeleton))
    root = turn("z", 30) @ turn("y", -20) @ turn("x", 10)
    local = turn("z", 50) @ turn("y", -20) @ turn("x", 30)
    upper = root @ local @ turn("z", -60) @ turn("y", 5) @ turn("x", 40) @ local.T
    at = np.array([1.0, 2, 3]) + upper @ [2.0, 0, 0]
    np.testing.assert_allclose(ends["upper"][1], at, atol=1e-12)
    at = at + upper @ [0, 0.5, 0]
    np.testing.assert_allclose(ends["joint"][1], at, atol=1e-12)
    np.testing.assert_allclose(ends["lower"][1], at + upper @ turn("z", -35) @ [0.6, 0.8, 0], atol=1e-12)


def test_radians_and_degrees_agree(arm: tuple[Path, Path], tmp_path: Path) -> None:
    skeleton = read_skeleton(arm[0])
    text = MOTION.replace(":DEGREES", ":RADIANS").replace("lower 90", f"lower {math.pi / 2}")
    text = text.replace("10 -20 30", " ".join(str(math.radians(a)) for a in (10, -20, 30)))
    text = text.replace("40 5 -60", " ".join(str(math.radians(a)) for a in (40, 5, -60))).replace("-35", str(math.radians(-35)))
    (tmp_path / "radians.amc").write_text(text)
    one, two = (joint_positions(skeleton, read_motion(path, skeleton)) for path in (arm[1], tmp_path / "radians.amc"))
    for bone in one:
        np.testing.assert_allclose(one[bone], two[bone], atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("length 2.0", "length two", "line 17: length has a value that is no number"),
        ("direction 1 0 0", "direction 1 0", "line 16: direction needs 3 numbers, has 2"),
        ("direction 1 0 0", "direction 3 0 0", "line 16: direction has length 3"),
        ("     length 2.0\n", "", "bone 'upper' has no length"),
        ("dof rz", "dof tz", "dof must list rotations"),
        ("axis 30 -20 50 XYZ", "axis 30 -20 50 XYY", "line 18: axis order"),
        ("angle deg", "angle grad", "line 6: angle unit"),
        ("    joint lower\n", "", "does not connect ['lower'] to the root"),
        ("joint lower", "joint lower elbow", "names bone 'elbow'"),
        ("joint lower", "joint lower upper", "a second parent"),
        ("name joint", "name upper", "described twice"),
        ("     dof rz\n  end\n", "     dof rz\n", "no 'end'"),
        (":root", ":roof", "without a :root section"),
    ],
)
def test_faults_of_a_skeleton_name_file_and_line(tmp_path: Path, old: str, new: str, expected: str) -> None:
    path = tmp_path / "broken.asf"
    assert old in SKELETON
    path.write_text(SKELETON.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        read_skeleton(path)
    assert expected in str(caught.value)
    assert str(caught.value).startswith(f"{path}, line ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("upper 40 5 -60", "upper 40 5", "line 10: bone 'upper' needs 3 numbers, has 2"),
        ("lower -35", "lower nan", "line 11: bone 'lower' is not finite"),
        ("lower -35", "elbow -35", "line 11: bone 'elbow' is not one the skeleton moves"),
        ("lower -35\n", "", "lacks bone 'lower'"),
        ("lower 90\n", "", "line 7: the frame before it lacks bone 'lower'"),
        ("lower -35", "lower -35\nlower -35", "line 12: bone 'lower' appears twice"),
        ("\n8\n", "\n9\n", "line 8: frame 9 follows frame 7"),
        ("\n7\n", "\n", "before the first frame number"),
        (MOTION, ":DEGREES\n", "no frames"),
        (MOTION, "", "line 1: the file is empty"),
    ],
)
def test_faults_of_a_motion_name_file_and_line(arm: tuple[Path, Path], old: str, new: str, expected: str) -> None:
    skeleton = read_skeleton(arm[0])
    assert old in MOTION
    arm[1].write_text(MOTION.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        read_motion(arm[1], skeleton)
    assert expected in str(caught.value)
    assert str(caught.value).startswith(f"{arm[1]}, line ")
    assert "\n" not in str(caught.value)


def test_skeleton_without_the_named_bones_is_refused(arm: tuple[Path, Path]) -> None:
    skeleton = read_skeleton(arm[0])
    with pytest.raises(InputError, match="has no bone 'thorax'"):
        centre_of_mass(joint_positions(skeleton, read_motion(arm[1], skeleton)))
    with pytest.raises(InputError, match="rule for the stature"):
        stature(skeleton)


def test_centre_of_mass_is_the_weighted_mean() -> None:
    joints = {"a": np.array([[0.0, 0, 0]]), "b": np.array([[2.0, 0, 0]]), "c": np.array([[2.0, 4, 0]])}
    segments = (Segment("ab", 0.3, 0.5, ("a",), ("b",)), Segment("bc", 0.1, 0.25, ("b",), ("c",)))
    np.testing.assert_allclose(centre_of_mass(joints, segments), [[(0.3 * 1 + 0.1 * 2) / 0.4, 0.1 * 1 / 0.4, 0]])


def test_segment_table_adds_up_and_is_the_same_on_both_sides() -> None:
    """Winter 2009, table 4.1: a total arm 0.050, a total leg 0.161, trunk, head and neck 0.578."""
    assert sum(segment.mass for segment in CMU_SEGMENTS) == pytest.approx(1.0)
    for side in ("left", "right"):
        arm_mass = sum(s.mass for s in CMU_SEGMENTS if s.name in {f"{side}_upper_arm", f"{side}_forearm", f"{side}_hand"})
        leg_mass = sum(s.mass for s in CMU_SEGMENTS if s.name in {f"{side}_thigh", f"{side}_shank", f"{side}_foot"})
        assert arm_mass == pytest.approx(0.050)
        assert leg_mass == pytest.approx(0.161)


@pytest.mark.parametrize("up", ["x", "y", "z"])
def test_left_turn_seen_from_above_is_positive(up: str) -> None:
    """Forward, then up x forward (to the left), must turn counter-clockwise in the plan."""
    vertical = np.eye(3)["xyz".index(up)]
    forward = np.roll(vertical, 1)
    plan = floor_plan(np.stack([forward, np.cross(vertical, forward)]), up)
    assert plan[0, 0] * plan[1, 1] - plan[0, 1] * plan[1, 0] == pytest.approx(1.0)


# Real recordings


@pytest.fixture(scope="module")
def recordings() -> Path:
    data = Path(os.environ.get("WALKLAB_DATA", Path(__file__).parents[4] / "shared" / "data"))
    folder = data / "cmu_walk_amc"
    if not folder.is_dir():
        pytest.skip(f"no CMU walks at {folder}; set WALKLAB_DATA to the folder that holds cmu_walk_amc")
    return folder


@pytest.fixture(scope="module")
def loaded(recordings: Path) -> tuple[Skeleton, Motion, dict[str, np.ndarray]]:
    folder = recordings / "data" / "35"
    skeleton = read_skeleton(folder / "35.asf")
    motion = read_motion(folder / "35_01.amc", skeleton)
    return skeleton, motion, joint_positions(skeleton, motion)


def test_bones_keep_their_lengths_in_every_frame(loaded: tuple[Skeleton, Motion, dict[str, np.ndarray]]) -> None:
    skeleton, motion, joints = loaded
    assert len(motion) == 224  # frames 135 to 358 of the file
    for bone in skeleton.bones.values():
        length = np.linalg.norm(joints[bone.name] - joints[bone.parent], axis=1)
        np.testing.assert_allclose(length, bone.length, rtol=1e-9, atol=1e-9)


def test_left_is_left_of_right_while_walking(loaded: tuple[Skeleton, Motion, dict[str, np.ndarray]]) -> None:
    """Seen from above, the left hip lies counter-clockwise of the walking direction: the plan is not mirrored."""
    _, _, joints = loaded
    ahead = floor_plan(joints[ROOT][-1:] - joints[ROOT][:1], "y")[0]
    across = floor_plan(joints["lhipjoint"] - joints["rhipjoint"], "y")
    assert np.all(ahead[0] * across[:, 1] - ahead[1] * across[:, 0] > 0)


def test_feet_alternate_and_stay_on_the_floor(loaded: tuple[Skeleton, Motion, dict[str, np.ndarray]]) -> None:
    _, _, joints = loaded
    lowest = np.minimum(joints["ltoes"], joints["rtoes"])[:, 1] * CMU_UNIT_M
    assert np.all(np.abs(lowest) < 0.1)
    ahead = floor_plan(joints["lfoot"] - joints["rfoot"], "y")[:, 0]
    assert np.sum(np.diff(np.sign(ahead)) != 0) >= 2


def test_centre_of_mass_is_inside_the_body_at_waist_height(loaded: tuple[Skeleton, Motion, dict[str, np.ndarray]]) -> None:
    """Standing and walking people carry it at 0.53 to 0.58 of their height."""
    skeleton, _, joints = loaded
    centre = centre_of_mass(joints)
    everything = np.stack(list(joints.values()))
    assert np.all(centre > everything.min(axis=0))
    assert np.all(centre < everything.max(axis=0))
    assert 0.53 < centre[:, 1].mean() / stature(skeleton) < 0.58


def test_stature_agrees_with_the_proportion_of_the_legs(recordings: Path) -> None:
    """Hip to ankle is 0.530 - 0.039 of stature (Drillis and Contini 1966); another way to the same ten heights."""
    heights, by_legs = [], []
    for path in sorted(recordings.rglob("*.asf")):
        skeleton = read_skeleton(path)
        heights.append(stature(skeleton) * CMU_UNIT_M)
        legs = [sum(skeleton.bones[bone].length for bone in leg) for leg in StatureRule().legs]
        by_legs.append(np.mean(legs) * CMU_UNIT_M / 0.491)
    assert len(heights) == 10
    assert all(1.5 < height < 2.0 for height in heights)
    assert np.median(np.abs(np.subtract(heights, by_legs))) < 0.02
    assert np.max(np.abs(np.subtract(heights, by_legs))) < 0.11


def test_all_47_walks_are_walks(recordings: Path) -> None:
    walks, samples = import_walks(recordings)
    assert len(walks) == 47
    assert walks["participant"].nunique() == 10
    assert (walks["rejection"] == "").all()
    assert (walks["participant"] == "35").sum() == 20
    assert samples.groupby("walk").size().sum() == len(samples) > 10_000
    pace = walks["length_m"] / walks["duration_s"]
    assert pace.between(0.6, 2.0).all()
    # Moving starts: the speed there is that of a person who already walks.
    assert (walks["start_speed_m_s"] > 0.3).all()
    first = samples.groupby("walk").first()
    np.testing.assert_allclose(first.loc[walks["walk"], "x_m"], walks["start_x_m"])


def test_wrong_unit_is_noticed(recordings: Path) -> None:
    with pytest.raises(InputError, match="check the unit"):
        import_walks(recordings / "data" / "49", unit_m=1.0)


def test_folder_without_recordings_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no \.asf file"):
        import_walks(tmp_path)
    (tmp_path / "a.asf").write_text(SKELETON)
    with pytest.raises(InputError, match="rule for the stature"):
        import_walks(tmp_path)
