"""Writers leave whole files or none; readers end in one clear message."""

import numpy as np
import pandas as pd
import pytest

from walklab import storage
from walklab.errors import InputError


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "table.txt"
    target.write_text("old")

    def fill_the_disk() -> None:
        with storage.atomic_path(target) as temporary:
            temporary.write_text("half of the new")
            raise RuntimeError("disk full")

    with pytest.raises(RuntimeError, match="full"):
        fill_the_disk()
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["table.txt"]


def test_what_a_killed_writer_left_is_removed_by_the_next(tmp_path):
    (tmp_path / ".table.a1b2c3d4.txt").write_text("half")
    (tmp_path / ".other.a1b2c3d4.txt").write_text("somebody else's")
    storage.write_text("whole", tmp_path / "table.txt")
    assert sorted(path.name for path in tmp_path.iterdir()) == [".other.a1b2c3d4.txt", "table.txt"]


@pytest.mark.parametrize("name", ["table.csv", "table", "model.v2.safetensors", "checksums.txt"])
def test_temporary_files_are_told_by_their_names(tmp_path, name):
    with storage.atomic_path(tmp_path / name) as temporary:
        assert storage.is_temporary(temporary)
        assert not storage.is_temporary(tmp_path / name)


@pytest.mark.parametrize("name", [".gitignore", ".dockerignore", ".venv", ".pre-commit-config.yaml", "table.a1b2c3d4.csv"])
def test_other_hidden_files_are_not_temporary(name):
    assert not storage.is_temporary(name)


@pytest.mark.parametrize("name", ["table.parquet", "table.csv"])
def test_a_table_survives_the_round_trip(tmp_path, name):
    frame = pd.DataFrame({"walk": ["a", "b"], "length_m": [0.5, 1.25]})
    storage.write_table(frame, tmp_path / "deep" / name)
    pd.testing.assert_frame_equal(storage.read_table(tmp_path / "deep" / name), frame)


def test_the_same_table_gives_the_same_bytes(tmp_path):
    frame = pd.DataFrame({"x": np.linspace(0, 1, 1000)})
    for name in ("one.parquet", "two.parquet"):
        storage.write_table(frame, tmp_path / name)
    assert (tmp_path / "one.parquet").read_bytes() == (tmp_path / "two.parquet").read_bytes()


def test_tensors_survive_the_round_trip_with_their_header(tmp_path):
    tensors = {"maps": np.arange(6.0).reshape(2, 3)[:, ::-1]}
    storage.write_tensors(tensors, {"format": 1}, tmp_path / "model.safetensors")
    read, header = storage.read_tensors(tmp_path / "model.safetensors")
    np.testing.assert_array_equal(read["maps"], tensors["maps"])
    assert header == {"format": 1}


@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("table.parquet", storage.read_table),
        ("table.csv", storage.read_table),
        ("model.safetensors", storage.read_tensors),
        ("maps.nc", storage.read_dataset),
        ("static.json", storage.read_json),
    ],
)
@pytest.mark.parametrize("content", [None, b"", b"\x00\xff nonsense"])
def test_a_missing_empty_or_foreign_file_is_named(tmp_path, name, read, content):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=name) as caught:
        read(path)
    assert "\n" not in str(caught.value)


def test_json_refuses_nan(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        storage.write_json({"value": float("nan")}, tmp_path / "value.json")
    assert list(tmp_path.iterdir()) == []
