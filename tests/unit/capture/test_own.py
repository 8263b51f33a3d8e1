"""Own walks: what is read is what was walked, and every fault is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from loading import module_at

from walklab.capture.imported_walks import ImportRules, walk_span
from walklab.capture.own import OwnColumns, import_walks
from walklab.capture.walks import read_walks, write_walks
from walklab.errors import InputError
from walklab.geometry.standing import Standing

EXAMPLES = Path(__file__).parents[3] / "examples"
RATE_HZ = 100.0


def standing_walk(length_m: float = 3.0, moving_s: float = 3.0, standing_s: float = 1.0) -> np.ndarray:
    """Positions of a minimum-jerk walk along x between two standing phases."""
    time_s = np.arange(0, moving_s + 2 * standing_s + 1e-9, 1 / RATE_HZ)
    share = np.clip((time_s - standing_s) / moving_s, 0, 1)
    return np.column_stack([length_m * (10 * share**3 - 15 * share**4 + 6 * share**5), np.zeros_like(time_s)])


def table(points: np.ndarray, participant: str = "P1", walk: str = "w1", height: float = 1.75) -> pd.DataFrame:
    time_s = np.arange(len(points)) / RATE_HZ
    return pd.DataFrame(
        {"participant": participant, "walk": walk, "time_s": time_s, "x_m": points[:, 0], "y_m": points[:, 1], "height_m": height}
    )


def write(tmp_path: Path, frame: pd.DataFrame, name: str = "walks.csv") -> Path:
    path = tmp_path / name
    frame.to_csv(path, index=False) if path.suffix == ".csv" else frame.to_parquet(path, index=False)
    return path


def test_walk_between_standing_phases_is_cut_at_them(tmp_path: Path) -> None:
    walks, samples = import_walks(write(tmp_path, table(standing_walk())))
    # 30 l (s^2 - 2 s^3 + s^4) / T reaches 0.05 m/s where the polynomial is 0.05 T / (30 l).
    share = np.linspace(0, 0.5, 100001)
    edge_s = 3.0 * share[np.searchsorted(30 * 3.0 * (share**2 - 2 * share**3 + share**4) / 3.0, 0.05)]
    row = walks.iloc[0]
    assert row["start_s"] == pytest.approx(1.0 + edge_s, abs=1.5 / RATE_HZ)
    assert row["duration_s"] == pytest.approx(3.0 - 2 * edge_s, abs=2.5 / RATE_HZ)
    assert row["start_speed_m_s"] == row["end_speed_m_s"] == 0.0
    assert row["length_m"] == pytest.approx(3.0, abs=0.01)
    assert samples["time_s"].iloc[-1] == pytest.approx(row["duration_s"])


def test_moving_ends_take_the_mean_over_a_whole_step(tmp_path: Path) -> None:
    """A speed that swings once per step has a start speed that does not depend on the phase."""
    time_s = np.arange(0, 4, 1 / RATE_HZ)
    found = []
    for phase in (0.0, 1.0, 2.0):
        x = 1.2 * time_s + 0.03 * np.sin(2 * np.pi * time_s / 0.5 + phase)
        walks, _ = import_walks(write(tmp_path, table(np.column_stack([x, 0 * x]))))
        found.append(walks[["start_speed_m_s", "end_speed_m_s", "duration_s"]].to_numpy()[0])
    np.testing.assert_allclose(np.array(found)[:, :2], 1.2, atol=0.01)
    np.testing.assert_allclose(np.array(found)[:, 2], time_s[-1])


def test_sway_while_standing_does_not_move_the_boundaries() -> None:
    speed = np.concatenate([[0.0, 0.08, 0.0, 0.0], np.linspace(0.06, 1.2, 20), np.linspace(1.2, 0.06, 20), [0.0, 0.07, 0.0]])
    assert walk_span(speed, Standing()) == (3, 44)


def test_units_columns_and_format_give_the_same_walk(tmp_path: Path) -> None:
    plain = table(standing_walk())
    wide = plain.assign(
        time_s=plain["time_s"] * 1000, x_m=plain["x_m"] * 100, y_m=plain["y_m"] * 100, height_m=plain["height_m"] * 1000
    )
    wide = wide.rename(columns={"participant": "who", "x_m": "px"})
    columns = OwnColumns(participant="who", x="px")
    path = write(tmp_path, wide, "wide.parquet")
    one = import_walks(write(tmp_path, plain))
    two = import_walks(path, columns, length_unit="cm", time_unit="ms", height_unit="mm")
    for left, right in zip(one, two, strict=True):
        pd.testing.assert_frame_equal(left, right, rtol=1e-9)


def test_without_time_column_the_rate_counts(tmp_path: Path) -> None:
    frame = table(standing_walk()).drop(columns=["time_s", "walk"])
    walks, _ = import_walks(write(tmp_path, frame), OwnColumns(walk=None, time=None), rate_hz=RATE_HZ)
    with_time, _ = import_walks(write(tmp_path, table(standing_walk())))
    assert walks["walk"].tolist() == ["own/P1/1"]
    assert walks["duration_s"].iloc[0] == pytest.approx(with_time["duration_s"].iloc[0])


def test_jittering_times_are_resampled(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    points, frame = standing_walk(), table(standing_walk())
    times = frame["time_s"] + rng.uniform(-0.2, 0.2, len(frame)) / RATE_HZ
    frame = frame.assign(time_s=times, x_m=np.interp(times, frame["time_s"], points[:, 0]))
    walks, _ = import_walks(write(tmp_path, frame))
    straight, _ = import_walks(write(tmp_path, table(points)))
    assert walks["duration_s"].iloc[0] == pytest.approx(straight["duration_s"].iloc[0], abs=0.03)


def test_a_walk_is_one_participant_and_one_name(tmp_path: Path) -> None:
    frames = [table(standing_walk(), who, name) for who in ("P1", "P2") for name in ("a", "b")]
    walks, samples = import_walks(write(tmp_path, pd.concat(frames)), scene="hall")
    assert walks["walk"].tolist() == ["own/P1/a", "own/P1/b", "own/P2/a", "own/P2/b"]
    assert set(walks["scene"]) == {"hall"}
    write_walks(walks, samples, tmp_path / "w.parquet", tmp_path / "s.parquet")
    assert len(read_walks(tmp_path / "w.parquet", tmp_path / "s.parquet")) == 4


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        (standing_walk(length_m=0.3, moving_s=2.5), "never faster than"),
        (standing_walk(length_m=0.4, moving_s=1.3), "closer than"),
        (standing_walk(length_m=1.0, moving_s=0.9), "shorter than two steps"),
        (np.concatenate([standing_walk(), standing_walk()[::-1] * 0.8 + [0.6, 0]]), "times as long"),
    ],
)
def test_what_is_no_walk_is_rejected_with_its_reason(tmp_path: Path, points: np.ndarray, reason: str) -> None:
    frame = pd.concat([table(standing_walk(), walk="good"), table(points, walk="bad")])
    walks, samples = import_walks(write(tmp_path, frame), rules=ImportRules())
    assert walks["rejection"].iloc[0] == ""
    assert reason in walks["rejection"].iloc[1]
    assert set(samples["walk"]) == {"own/P1/good"}


def _with(column: str, row: int, value: object) -> pd.DataFrame:
    frame = table(standing_walk()).astype(object)
    frame.loc[row, column] = value
    return frame


@pytest.mark.parametrize(
    ("frame", "options", "expected"),
    [
        (_with("x_m", 6, np.nan), {}, "column x_m, row 7: empty"),
        (_with("y_m", 6, "1,5"), {}, "column y_m, row 7: '1,5' is no finite number"),
        (_with("time_s", 6, 0.02), {}, "column time_s, row 7: time goes back"),
        (_with("time_s", 6, 0.05), {}, "column time_s, row 7: the same time twice"),
        (table(standing_walk()).drop(index=range(50, 70)), {}, "a gap of 0.21 s"),
        (_with("height_m", 0, 175), {}, "column height_m, row 1: 175 m is no person's height"),
        (_with("height_m", 9, 1.8), {}, "column height_m, row 10: the height changes"),
        (_with("participant", 3, ""), {}, "column participant, row 4: empty"),
        (table(standing_walk()).rename(columns={"x_m": "px"}), {}, "column x_m: no such column"),
        (table(standing_walk()).iloc[:0], {}, "no rows below its header"),
        (_with("x_m", 200, 40.0), {}, "column x_m, row"),
        (table(standing_walk() * 100), {"height_unit": "m"}, "check length_unit"),
        (table(standing_walk()), {"length_unit": "mm", "height_unit": "m"}, "never faster than 0.3 m/s"),
        (table(standing_walk()), {"time_unit": "ms"}, "check time_unit"),
        (table(standing_walk()), {"rate_hz": 60.0}, "frames come at 100 Hz, but rate_hz is 60"),
        (table(standing_walk()), {"length_unit": "inch"}, "length_unit: unknown unit 'inch'"),
        (table(standing_walk() + 2000), {}, "column x_m, row 1: more than 1000 m"),
    ],
)
def test_every_fault_is_one_line_with_its_place(tmp_path: Path, frame: pd.DataFrame, options: dict, expected: str) -> None:
    path = write(tmp_path, frame)
    with pytest.raises(InputError) as caught:
        import_walks(path, **options)
    message = str(caught.value)
    assert expected in message
    assert "\n" not in message
    assert "unit" in expected[:11] or str(path) in message


def test_missing_and_empty_files_are_named(tmp_path: Path) -> None:
    (tmp_path / "empty.csv").touch()
    for name in ("absent.csv", "empty.csv"):
        with pytest.raises(InputError, match=name):
            import_walks(tmp_path / name)


def test_example_in_the_repository_is_what_its_script_makes() -> None:
    script = module_at(EXAMPLES / "make_own_walks.py")
    columns = OwnColumns("person", "walk", "time_s", "x_m", "y_m", "height_cm")
    walks, _ = import_walks(EXAMPLES / "own_walks.csv", columns, height_unit="cm")
    assert len(walks) == len(script.PEOPLE) * len(script.WALKS)
    assert (walks["rejection"] == "").all()
    for row in walks.itertuples():
        length_m, _ = script.WALKS[row.walk.split("/")[2]]
        assert np.hypot(row.end_x_m - row.start_x_m, row.end_y_m - row.start_y_m) == pytest.approx(length_m, abs=0.02)
        assert row.height_m == pytest.approx(script.PEOPLE[row.participant][0])
