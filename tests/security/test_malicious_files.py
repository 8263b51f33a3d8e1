"""Files from somebody else: a model, a configuration, a plan view and recordings that would run code or leave their place."""

import io
import json
import os
import pickle
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from walklab.capture.acclaim_files import read_motion, read_skeleton
from walklab.capture.acclaim_skeleton import joint_positions
from walklab.capture.own import import_walks
from walklab.errors import InputError
from walklab.geometry.plans import load_plan
from walklab.steering.model_file import read_model

ROOT = Path(__file__).parents[2]


class Payload:
    """Unpickled anywhere, it leaves a mark."""

    def __init__(self, mark: Path) -> None:
        self.mark = str(mark)

    def __reduce__(self):
        return os.mkdir, (self.mark,)


@pytest.fixture
def mark(tmp_path: Path) -> Path:
    return tmp_path / "it_ran"


def test_the_payload_works_where_pickles_are_read(mark):
    pickle.loads(pickle.dumps(Payload(mark)))
    assert mark.is_dir(), "else the tests below could not fail"


def safetensors(header: bytes, data: bytes = b"", length: int | None = None) -> bytes:
    return struct.pack("<Q", len(header) if length is None else length) + header + data


def described(**entries: object) -> bytes:
    metadata = {"walklab": json.dumps({"format": "walklab motion model", "version": 2})}
    return json.dumps({"__metadata__": metadata, **entries}).encode()


MODELS = {
    "a pickle under another name": lambda mark: pickle.dumps(Payload(mark)),
    "a numpy file of pickled objects": lambda mark: numpy_objects(mark),
    "a header longer than the file": lambda mark: safetensors(b"{}", length=2**62),
    "a header without end": lambda mark: safetensors(b"[" * 100_000),
    "an array beyond the end": lambda mark: safetensors(described(maps={"dtype": "F64", "shape": [9], "data_offsets": [0, 72]})),
    "an array before its beginning": lambda mark: safetensors(
        described(maps={"dtype": "F64", "shape": [1], "data_offsets": [-8, 0]}), b"12345678"
    ),
    "a size that overflows": lambda mark: safetensors(
        described(maps={"dtype": "F64", "shape": [2**40, 2**40], "data_offsets": [0, 8]}), b"12345678"
    ),
    "an unknown type": lambda mark: safetensors(
        described(maps={"dtype": "OBJECT", "shape": [1], "data_offsets": [0, 8]}), b"12345678"
    ),
}


def numpy_objects(mark: Path) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.array([Payload(mark)], dtype=object), allow_pickle=True)
    return buffer.getvalue()


@pytest.mark.parametrize("name", MODELS)
def test_a_malicious_model_is_refused_in_one_line(name, mark, tmp_path):
    path = tmp_path / "model.safetensors"
    path.write_bytes(MODELS[name](mark))
    with pytest.raises(InputError, match=r"model\.safetensors: "):
        read_model(path)
    assert not mark.exists()


RECORDINGS = {
    "a pickle called CSV": (".csv", lambda mark: pickle.dumps(Payload(mark))),
    "a pickle called Parquet": (".parquet", lambda mark: pickle.dumps(Payload(mark))),
    "a compressed pickle": (".csv", lambda mark: numpy_objects(mark)),
}


@pytest.mark.parametrize("name", RECORDINGS)
def test_a_malicious_recording_is_refused_in_one_line(name, mark, tmp_path):
    suffix, content = RECORDINGS[name]
    path = tmp_path / f"walks{suffix}"
    path.write_bytes(content(mark))
    with pytest.raises(InputError, match=rf"walks\{suffix}"):
        import_walks(path)
    assert not mark.exists()


SKELETON = """
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    name {bone}
    direction 1 0 0
    length {length}
    axis 0 0 0 XYZ
    dof rx
  end
:hierarchy
  begin
    root {bone}
  end
"""
MOTION = ":DEGREES\n{frame}\nroot 0 0 0 0 0 0\n{bone} {angle}\n"
HARMLESS = {"bone": "leg", "length": "1", "frame": "1", "angle": "0"}
ACCLAIM = {
    "a length that overflows": {"length": "1e308"},
    "a length beyond every number": {"length": "1e999"},
    "code for a length": {"length": "__import__('os').getcwd()"},
    "an angle that overflows": {"angle": "-1e308"},
    "no number for an angle": {"angle": "nan"},
    "more numbers than the bone moves": {"angle": "0 " * 100_000},
    "a frame number without end": {"frame": "9" * 100_000},
    "a frame number of no digits": {"frame": "\u00b2"},
}


def read_acclaim(folder: Path, **words: str) -> dict[str, np.ndarray]:
    filled = HARMLESS | words
    (folder / "walk.asf").write_text(SKELETON.format(**filled))
    (folder / "walk.amc").write_text(MOTION.format(**filled))
    skeleton = read_skeleton(folder / "walk.asf")
    return joint_positions(skeleton, read_motion(folder / "walk.amc", skeleton))


def test_the_harmless_acclaim_recording_is_read(tmp_path):
    positions = read_acclaim(tmp_path)
    assert positions
    assert all(np.isfinite(points).all() for points in positions.values())


@pytest.mark.parametrize("name", ACCLAIM)
def test_a_malicious_acclaim_recording_is_refused_in_one_line(name, tmp_path):
    with pytest.raises(InputError, match=r"walk\.a[sm][fc], line \d+: "):
        read_acclaim(tmp_path, **ACCLAIM[name])


def test_a_bone_named_like_a_path_stays_a_name(tmp_path):
    read_acclaim(tmp_path, bone="../../../etc/cron.d/x")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["walk.amc", "walk.asf"]


@pytest.mark.parametrize("suffix", ["asf", "amc"])
def test_a_pickle_called_acclaim_is_refused(suffix, mark, tmp_path):
    path = tmp_path / f"walk.{suffix}"
    path.write_bytes(pickle.dumps(Payload(mark)))
    (tmp_path / "whole.asf").write_text(SKELETON.format(**HARMLESS))
    skeleton = read_skeleton(tmp_path / "whole.asf")
    with pytest.raises(InputError, match=rf"walk\.{suffix}"):
        read_skeleton(path) if suffix == "asf" else read_motion(path, skeleton)
    assert not mark.exists()


def test_a_participant_named_like_a_path_stays_a_name(tmp_path):
    time_s = np.arange(0, 3, 0.01)
    walk = {"time_s": time_s, "x_m": np.interp(time_s, [0.5, 2.5], [0.0, 2.0]), "y_m": 0.0, "height_m": 1.7}
    people = ("../../../etc/cron.d/x", "<script>alert(1)</script>", "=HYPERLINK(1)")
    frame = pd.concat([pd.DataFrame({"participant": who, "walk": 1, **walk}) for who in people], ignore_index=True)
    frame.to_csv(tmp_path / "walks.csv", index=False)
    walks, _ = import_walks(tmp_path / "walks.csv")
    assert set(walks["participant"]) == set(people)
    assert [path.name for path in tmp_path.iterdir()] == ["walks.csv"]


TAGS = ("!!python/object/apply:os.mkdir ['{mark}']", "!!python/object/new:os.mkdir ['{mark}']", "!!python/name:os.system")


@pytest.mark.parametrize("tag", TAGS)
def test_a_plan_view_with_a_yaml_tag_runs_nothing(tag, mark, tmp_path):
    path = tmp_path / "plan.yaml"
    path.write_text(f"name: {tag.format(mark=mark)}\n")
    with pytest.raises(InputError, match=r"plan\.yaml: not valid YAML"):
        load_plan(path)
    assert not mark.exists()


@pytest.mark.workflow
@pytest.mark.parametrize("tag", TAGS)
def test_a_configuration_with_a_yaml_tag_runs_nothing(tag, mark, tmp_path):
    (tmp_path / "bad.yaml").write_text(f"run: {tag.format(mark=mark)}\n")
    command = [sys.executable, "-m", "snakemake", "--dry-run", "--cores", "1", "--configfile", str(tmp_path / "bad.yaml")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert not mark.exists()


@pytest.mark.workflow
def test_a_value_of_the_configuration_never_reaches_a_shell(mark, tmp_path):
    (tmp_path / "bad.yaml").write_text(json.dumps({"run": f"x; mkdir {mark}"}))
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--configfile", str(tmp_path / "bad.yaml")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "config key run" in done.stdout + done.stderr
    assert not mark.exists()


OUTSIDE = {
    "a scenario by a link": ("scenarios.scenario_1", {"scenarios": {"scenario_1": "link.yaml"}}),
    "another run's verdicts": ("compare_verdicts.other", {"compare_verdicts": {"other": "../private.yaml"}}),
}


@pytest.mark.workflow
@pytest.mark.parametrize("name", OUTSIDE)
def test_a_configuration_cannot_name_a_file_elsewhere(name, tmp_path):
    """A dry run stops at the key, before anything has read the file."""
    key, config = OUTSIDE[name]
    folder, outside = tmp_path / "work", tmp_path / "private.yaml"
    folder.mkdir()
    outside.write_text("secret: 1\n")
    (folder / "link.yaml").symlink_to(outside)
    (folder / "bad.yaml").write_text(json.dumps(config))
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--configfile", "bad.yaml", "--dry-run"]
    environment = {**os.environ, "WALKLAB_DATA": str(folder / "data")}
    done = subprocess.run([*command, "--cores", "1"], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    told = done.stdout + done.stderr
    assert done.returncode != 0
    assert f"config key {key}: " in told, told
    assert "lies outside of the working folder" in told
    assert "secret" not in told
