import numpy as np
import pandas as pd
import pytest

from walklab.capture.segmentation import SegmentationRules, compare_boundaries, extract_walks, fill_short_gaps, find_walks
from walklab.capture.walker import Bell
from walklab.errors import InputError
from walklab.geometry.standing import Standing

RATE_HZ = 120.0
PEOPLE = pd.DataFrame({"participant": ["a_P01"], "height_m": [1.8]})


def straight(*distances_m: float, pause_s: float = 4.0) -> np.ndarray:
    """Bell-shaped movements along x with pauses between, noise-free."""
    pieces, at = [np.zeros(int(pause_s * RATE_HZ))], 0.0
    for distance in distances_m:
        bell = Bell(abs(distance) / 1.2, 1.0, 0.2, 1.0)
        pieces.append(at + np.sign(distance) * bell.travelled(np.arange(0, bell.duration_s, 1 / RATE_HZ)))
        at += distance
        pieces.append(np.full(int(pause_s * RATE_HZ), at))
    along = np.concatenate(pieces)
    return np.column_stack([along, np.zeros_like(along)])


def recording(points_m: np.ndarray, name: str = "training/P01/straight_2.0") -> pd.DataFrame:
    time_s = np.arange(len(points_m)) / RATE_HZ
    return pd.DataFrame(
        {"recording": name, "participant": "a_P01", "configuration": "straight_2.0", "scene": "open", "time_s": time_s}
        | {"x_m": points_m[:, 0], "y_m": points_m[:, 1]}
    )


def cut(points_m: np.ndarray, **kwargs) -> pd.DataFrame:
    return extract_walks(recording(points_m), PEOPLE, Standing(), SegmentationRules(**kwargs), 0.2)[0]


@pytest.mark.parametrize(("name", "rate_hz"), [("training", 120.0), ("scenario_1", 60.0), ("scenario_2", 60.0)])
def test_recovered_boundaries_are_the_true_ones(name, rate_hz, request):
    captured = request.getfixturevalue(name)
    errors = compare_boundaries(captured.walks, captured.truth, rate_hz)
    assert len(errors) == len(captured.accepted)
    for column in ("start_error_frames", "end_error_frames"):
        assert errors[column].notna().all()
        assert errors[column].abs().median() <= 3
        assert errors[column].abs().quantile(0.95) <= 10


def test_short_walks_between_bends_keep_their_boundaries(scenario_1):
    near = scenario_1.accepted[scenario_1.accepted["configuration"].isin(["car-rack_3", "rack_3-car"])]
    assert len(near) > 700
    errors = compare_boundaries(near, scenario_1.truth, 60.0)
    assert errors["start_error_frames"].abs().quantile(0.95) <= 10
    assert errors["end_error_frames"].abs().quantile(0.95) <= 10


def test_comparing_boundaries_sees_a_shift(training):
    late = training.accepted.assign(start_s=training.accepted["start_s"] + 7 / 120)
    before, after = (compare_boundaries(walks, training.truth, 120.0) for walks in (training.accepted, late))
    np.testing.assert_allclose(after["start_error_frames"] - before["start_error_frames"], 7, atol=1e-6)


def test_noise_free_walks_start_and_end_at_the_standing_speed():
    points = straight(2.0)
    (found,) = find_walks(points, [], RATE_HZ, Standing(), SegmentationRules())
    speed = np.abs(np.gradient(points[:, 0], 1 / RATE_HZ))
    assert speed[found.start] < 0.05 <= speed[found.start + 1]
    assert speed[found.end] < 0.05 <= speed[found.end - 1]


def test_out_and_back_are_told_apart():
    walks = cut(straight(2.0, -2.0, 2.0, -2.0))
    assert list(walks["rejection"]) == ["", "walk back", "", "walk back"]
    assert walks["length_m"].to_numpy() == pytest.approx(2.0, abs=0.02)
    assert list(walks["walk"]) == [f"training/P01/straight_2.0/{i:04d}" for i in range(4)]


def test_shifts_and_bends_are_no_walks():
    assert list(cut(straight(2.0, 0.1, -0.1))["length_m"]) == pytest.approx([2.0], abs=0.02)
    assert len(cut(straight(0.5))) == 1


def test_a_short_stop_spoils_a_walk():
    (rejection,) = cut(straight(1.0, 1.0, pause_s=0.8))["rejection"]
    assert rejection.startswith("interrupted")
    assert len(cut(straight(1.0, 1.0, pause_s=4.0))) == 2


def test_a_recording_must_begin_and_end_standing():
    points = straight(2.0)
    middle = int(4.0 * RATE_HZ) + 100
    assert list(cut(points[middle:])["rejection"]) == ["recording begins while walking"]
    assert list(cut(points[:middle])["rejection"]) == ["recording ends while walking"]


@pytest.mark.parametrize(("lost", "reason"), [(12, ""), (13, "dropout"), (60, "dropout")])
def test_only_short_dropouts_are_bridged(lost, reason):
    points = straight(2.0)
    points[600 : 600 + lost] = np.nan
    (rejection,) = cut(points, longest_dropout_s=0.1)["rejection"]
    assert rejection.startswith(reason)
    assert bool(rejection) == bool(reason)


def test_dropouts_while_standing_spoil_nothing():
    points = straight(2.0)
    points[50:150] = np.nan
    assert list(cut(points)["rejection"]) == [""]


def test_bridging_a_straight_constant_motion_is_exact_and_changes_nothing_else():
    line = np.column_stack([np.arange(100.0), 2 * np.arange(100.0)])
    holed = line.copy()
    holed[[10, 11, 12, 40]] = np.nan
    holed[60:80] = np.nan
    filled, gaps = fill_short_gaps(holed, 5)
    np.testing.assert_allclose(filled, line)
    assert gaps == [(60, 80)]


def test_rigid_smoothing_leaves_uniform_motion_with_a_gap_alone():
    points = straight(2.0)
    holed = points.copy()
    holed[700:706] = np.nan
    whole, bridged = (extract_walks(recording(p), PEOPLE, Standing(), SegmentationRules(), 0.2)[1] for p in (points, holed))
    np.testing.assert_allclose(bridged[["x_m", "y_m"]], whole[["x_m", "y_m"]], atol=1e-3)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda r: r.assign(time_s=r["time_s"].to_numpy()[::-1]), "time_s"),
        (lambda r: r.drop(index=range(100, 200)), "frame 100"),
        (lambda r: r.assign(participant="b_P09"), "b_P09"),
        (lambda r: r.assign(x_m=np.nan, y_m=np.nan), "fewer than two"),
        (lambda r: r.assign(x_m=0.0, y_m=0.0), "no walk found"),
    ],
)
def test_malformed_recordings_end_in_one_line(spoil, message):
    with pytest.raises(InputError, match=message) as caught:
        extract_walks(spoil(recording(straight(2.0))), PEOPLE, Standing(), SegmentationRules(), 0.2)
    assert "\n" not in str(caught.value)


def test_unknown_scene_is_named():
    with pytest.raises(InputError, match=r"open\.yaml"):
        extract_walks(recording(straight(2.0)), PEOPLE, Standing(), SegmentationRules(), 0.2, {"hall": {"a": (0.0, 0.0)}})
