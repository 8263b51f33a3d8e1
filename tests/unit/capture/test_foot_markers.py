"""Feet: a made-up recording whose speed is known, named faults, and the real one where it is at hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recorded_files import write_feet

from walklab.capture.foot_markers import RATE_HZ, REACHED, STEP_S, ramps, read_feet, step_mean
from walklab.capture.realism import RAMPS, ramp_samples
from walklab.capture.recording_files import FEET
from walklab.errors import InputError


def test_ramps_of_a_known_walk(tmp_path: Path) -> None:
    write_feet(tmp_path, speed_m_s=1.25, ramp_s=4.0, cruise_s=40.0)
    feet = read_feet(tmp_path / FEET)
    assert feet[:, 0].max() == pytest.approx(1.25 * (2 + 20), rel=1e-3)  # metres, though the file has millimetres
    found = ramps(feet)
    assert found.cruising_speed_m_s == pytest.approx(1.25, rel=1e-3)
    # A linear rise of 4 s stays linear, but at its ends, under a mean over a step.
    assert len(found.start) / RATE_HZ == pytest.approx(REACHED * 4.0, abs=0.25)
    np.testing.assert_allclose(found.start, found.stop[::-1], atol=0.02)
    rise, fall = (sample.value[0] for sample in ramp_samples(found) if sample.measure in RAMPS)
    assert rise == pytest.approx(0.8 * 4.0, abs=0.03)
    assert fall == pytest.approx(rise, abs=0.03)


def test_the_mean_over_a_step_takes_out_exactly_a_step() -> None:
    time_s = np.arange(400) / RATE_HZ
    swing = np.sin(2 * np.pi * time_s / STEP_S)
    mean = step_mean(1.2 + swing, round(STEP_S * RATE_HZ))
    np.testing.assert_allclose(mean[30:-30], 1.2, atol=1e-12)
    assert step_mean(np.ones((7, 2)), 4).shape == (7, 2)


def test_a_recording_that_begins_in_motion_is_refused(tmp_path: Path) -> None:
    write_feet(tmp_path)
    feet = read_feet(tmp_path / FEET)
    with pytest.raises(InputError, match="from standing to walking"):
        ramps(feet[500:])
    with pytest.raises(InputError, match="end standing"):
        ramps(feet[:800])


@pytest.mark.parametrize(
    ("content", "word"),
    [("a", "header rows|marker"), (",L_TOE,L_TOE\n,x,y\n0,1.0,2.0\n", "R_"), (",L_A,R_A\n,x,x\n0,1.0,2.0\n", "axis")],
)
def test_faults_are_named_in_one_line(tmp_path: Path, content: str, word: str) -> None:
    path = tmp_path / "feet.csv"
    path.write_text(content)
    with pytest.raises(InputError, match=word) as caught:
        read_feet(path)
    assert "\n" not in str(caught.value)


def test_the_real_recording_cruises_like_its_person(data_folder: Path) -> None:
    recording = data_folder / FEET
    if not recording.is_file():
        pytest.skip(f"no recording of feet: {recording} does not exist; set WALKLAB_DATA")
    found = ramps(read_feet(recording))
    assert 1.2 < found.cruising_speed_m_s < 1.35
    assert 0.5 < len(found.start) / RATE_HZ < 2.0
    assert 1.0 < len(found.stop) / RATE_HZ < 4.0
