"""Goal-directed walks: a made-up file in their format, named faults, and the real file where it is at hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recorded_files import ARC_M, write_goal_directed

from walklab.capture.goal_directed import FACING_RAD, read_goal_directed
from walklab.capture.realism import path_measures
from walklab.capture.recording_files import GOAL_DIRECTED, present
from walklab.errors import InputError


def test_every_subject_of_every_configuration_is_a_walk(tmp_path: Path) -> None:
    write_goal_directed(tmp_path, {"E0615": (-1.5, 0.0), "N4000": (0.0, -3.0)})
    walks = read_goal_directed(tmp_path / GOAL_DIRECTED)
    assert len(walks) == 20  # the mean is no walk
    assert {walk.subject for walk in walks} == set(range(1, 11))
    assert sorted({round(walk.distance_m, 6) for walk in walks}) == [1.5, 3.0]
    assert max(walk.facing_off_rad for walk in walks) < 1e-6
    assert [round(walk.peak_speed_m_s, 3) for walk in walks[:3]] == [1.01, 1.02, 1.03]
    excursion, _, _ = path_measures(walks[10].position_m)
    assert excursion == pytest.approx(ARC_M, abs=2e-3)


def test_who_faces_away_is_off_by_half_a_turn(tmp_path: Path) -> None:
    write_goal_directed(tmp_path, {"O0615": (-1.5, 0.0)})
    assert read_goal_directed(tmp_path / GOAL_DIRECTED)[0].facing_off_rad == pytest.approx(np.pi, abs=1e-6)


@pytest.mark.parametrize("fault", ["text", "empty", "shape", "nan"])
def test_faults_are_named_in_one_line(tmp_path: Path, fault: str) -> None:
    path = tmp_path / "walks.npz"
    stack = np.ones((11, 6, 20))
    if fault == "text":
        path.write_text("no archive")
    elif fault == "empty":
        np.savez(path, other=np.zeros(3))
    elif fault == "shape":
        np.savez(path, E0615=stack[:5])
    else:
        stack[4, 1, 3] = np.nan
        np.savez(path, E0615=stack)
    with pytest.raises(InputError, match=r"walks\.npz") as caught:
        read_goal_directed(path)
    assert "\n" not in str(caught.value)


def test_recordings_that_are_there_are_found(tmp_path: Path) -> None:
    assert present(tmp_path) == []
    write_goal_directed(tmp_path, {"E0615": (-1.5, 0.0)})
    assert present(tmp_path) == [tmp_path / GOAL_DIRECTED]


def test_real_walks_set_out_the_way_the_people_faced(data_folder: Path) -> None:
    """The initial of a configuration is the direction in which people stood: where the goal lies there, they set out so."""
    archive = data_folder / GOAL_DIRECTED
    if not archive.is_file():
        pytest.skip(f"no goal-directed walks: {archive} does not exist; set WALKLAB_DATA")
    walks = read_goal_directed(archive)
    assert len(walks) == 400
    off = []
    for walk in walks:
        if walk.facing_off_rad > np.deg2rad(30):
            continue
        away = np.hypot(*(walk.position_m - walk.position_m[0]).T)
        x, y = walk.position_m[np.argmax(away > 0.25)] - walk.position_m[0]
        turn = np.arctan2(y, x) - FACING_RAD[walk.configuration[0]]
        off.append(np.degrees(abs(np.arctan2(np.sin(turn), np.cos(turn)))))
    assert len(off) == 80
    assert np.median(off) < 15
    assert max(off) < 45
