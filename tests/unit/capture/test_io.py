import numpy as np
import pandas as pd
import pytest

from walklab.capture import io
from walklab.errors import InputError


def test_tables_come_back_as_they_were(training, tmp_path):
    one = training.recording[training.recording["participant"] == "training_P03"].reset_index(drop=True)
    io.write_recording(one, tmp_path / "r.parquet")
    back = io.read_recording(tmp_path / "r.parquet")
    np.testing.assert_array_equal(back[["time_s", "x_m", "y_m"]].to_numpy(), one[["time_s", "x_m", "y_m"]].to_numpy())
    assert list(back["recording"].astype(str)) == list(one["recording"].astype(str))
    io.write_participants(training.participants, tmp_path / "p.parquet")
    pd.testing.assert_frame_equal(io.read_participants(tmp_path / "p.parquet", group="training"), training.participants)
    io.write_truth(training.truth, tmp_path / "t.parquet")
    pd.testing.assert_frame_equal(io.read_truth(tmp_path / "t.parquet"), training.truth, check_dtype=False)


def test_a_group_that_nobody_belongs_to_is_named(training, tmp_path):
    io.write_participants(training.participants, tmp_path / "p.parquet")
    with pytest.raises(InputError, match="scenarios_P"):
        io.read_participants(tmp_path / "p.parquet", group="scenarios")


@pytest.mark.parametrize(
    ("spoil", "column"),
    [
        (lambda r: r.assign(x_m=r["x_m"].where(r.index != 5, 4000.0)), "x_m, row 5"),
        (lambda r: r.assign(time_s=r["time_s"].where(r.index != 7, np.nan)), "time_s, row 7"),
        (lambda r: r.assign(time_s=r["time_s"].where(r.index != 7, 0.0)), "time_s, row 7"),
        (lambda r: r.drop(columns="scene"), "scene"),
        (lambda r: pd.concat([r.iloc[:9], r.iloc[[-1]], r.iloc[9:-1]], ignore_index=True), "recording"),
    ],
)
def test_a_broken_recording_names_file_column_and_row(training, tmp_path, spoil, column):
    part = training.recording[training.recording["participant"] == "training_P03"]
    first, second = part["recording"].unique()[:2]
    own = pd.concat([part[part["recording"] == first].iloc[:20], part[part["recording"] == second].iloc[:20]], ignore_index=True)
    path = tmp_path / "broken.parquet"
    spoil(own).to_parquet(path)
    with pytest.raises(InputError, match=column) as caught:
        io.read_recording(path)
    assert "broken.parquet" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_height_in_centimetres_is_refused(training, tmp_path):
    path = tmp_path / "p.parquet"
    training.participants.assign(height_m=training.participants["height_m"] * 100).to_parquet(path)
    with pytest.raises(InputError, match="height_m, row 0"):
        io.read_participants(path)
