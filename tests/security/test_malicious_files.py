"""Files from somebody else: a model, a configuration, a plan view and recordings that would run code or leave their place."""

import io
import json
import os
import pickle
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from safetensors.numpy import save_file

from walklab.capture.acclaim_files import read_motion, read_skeleton
from walklab.capture.acclaim_skeleton import joint_positions
from walklab.capture.own import import_walks
from walklab.errors import InputError
from walklab.geometry.plans import load_plan
from walklab.steering.blending_space import blending_space
from walklab.steering.interpolation import interpolant_named
from walklab.steering.mapped_tensors import open_tensors
from walklab.steering.model_file import read_model
from walklab.steering.models import probabilistic_model
from walklab.steering.scaling import fit_scaling
from walklab.steering.space import space_from_config

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


def rewritten(model: Path, tensors: Callable[[dict], None] = dict, header: Callable[[dict], None] = dict) -> Path:
    """A copy of a saved model that is well-formed, but tampered with."""
    arrays, described = open_tensors(model)
    arrays = {name: values.copy() for name, values in arrays.items()}
    tensors(arrays)
    header(described)
    path = model.with_name("tampered.safetensors")
    save_file(arrays, path, {"walklab": json.dumps(described)})  # not with walklab's own writer, which refuses some of this
    return path


@pytest.fixture(scope="module")
def saved(tmp_path_factory) -> Path:
    """A small model of random maps; as it is, it is read, checked and drawn from."""
    rng = np.random.default_rng(4)
    space = space_from_config([{"name": name, "unit": "m/s", "start": 0.1, "step": 0.4, "count": 4} for name in ("v", "a")])
    vectors = rng.uniform(1.0, 3.0, (30, 2))
    blending = blending_space(("length", "height"), ("m", "m"), vectors, rng.random((30, 16)), fit_scaling(vectors))
    path = tmp_path_factory.mktemp("models") / "model.safetensors"
    probabilistic_model(blending, space, interpolant_named("rbf", space.shape), k=5, provenance={"run": "test"}).save(path)
    assert read_model(path).sample(length=2.0, height=2.0, rng=rng).shape == (1, 2)
    return path


def put(name: str, value: float, rows: slice | int = slice(None)) -> Callable[[dict], None]:
    return lambda arrays: arrays[name].__setitem__(rows, value)


ARRAYS = {
    "a parent that is not there": (put("parents", 10**6, 3), "parents"),
    "no parent": (put("parents", -1, 3), "parents"),
    "an infinite map": (put("maps", np.inf, 3), "maps"),
    "a map above 1": (put("maps", 7.0, 3), "maps"),
    "a negative map": (put("maps", -0.5, 3), "maps"),
    "a map of nothing": (put("maps", 0.0, 3), "maps, row 3"),
    "coefficients of nothing": (put("coefficients", 0.0, 3), "coefficients, row 3"),
    "bounds of nothing": (put("rungs", 0, 3), "rungs, row 3"),
    "weights below a whole": (put("parent_weights", -3.0, 3), "parent_weights"),
    "weights above a whole": (put("parent_weights", 9.0, 3), "parent_weights"),
    "a dependency far beyond any walk": (put("vectors", 1e300, 3), "vectors"),
    "a dependency that is no number": (put("vectors", np.nan, 3), "vectors"),
    "a domain that is no number": (put("domain_equations", np.nan), "domain_equations"),
    "maps of another type": (lambda arrays: arrays.update(maps=arrays["maps"].astype(np.int64)), "maps"),
    "bounds of another type": (lambda arrays: arrays.update(rungs=arrays["rungs"].astype(float)), "rungs"),
    "maps of another size": (lambda arrays: arrays.update(maps=arrays["maps"][:, :-1].copy()), "maps"),
    "an array that is missing": (lambda arrays: arrays.pop("parents"), "parents"),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_that_were_tampered_with_are_found_by_a_check(name, saved):
    tamper, told = ARRAYS[name]
    path = rewritten(saved, tensors=tamper)
    with pytest.raises(InputError, match=rf"tampered\.safetensors: .*{told}"):
        read_model(path)


@pytest.mark.parametrize(
    ("name", "value"), [("coefficients", 0.0), ("coefficients", 200.0), ("coefficients", np.nan), ("rungs", 0)]
)
def test_arrays_that_were_tampered_with_are_one_line_when_drawn_from(name, value, saved):
    model = read_model(rewritten(saved, tensors=put(name, value)), check_all=False)
    with pytest.raises(InputError, match=r"tampered\.safetensors: the interpolated map is"):
        model.sample(length=2.0, height=2.0, size=100, rng=np.random.default_rng(1))


HEADERS = {
    "a later version": ({"version": 9}, "of version 9, .*update walklab"),
    "a version that is no number": ({"version": "2; rm"}, "not a walklab motion model"),
    "an earlier version": ({"version": 1}, "walklab migrate"),
    "a scale of 0": (
        {"dependencies": [{"name": n, "unit": "m", "offset": 0, "scale": 0} for n in ("length", "height")]},
        "scale",
    ),
    "an offset that is no number": (
        {"dependencies": [{"name": n, "unit": "m", "offset": float("nan"), "scale": 1} for n in ("length", "height")]},
        "offset",
    ),
    "an offset whose distances overflow": (
        {"dependencies": [{"name": n, "unit": "m", "offset": 1e308, "scale": 1e-308} for n in ("length", "height")]},
        "offset",
    ),
    "a dependency twice": ({"dependencies": [{"name": "length", "unit": "m", "offset": 0, "scale": 1}] * 2}, "twice"),
    "names that are no text": ({"dependencies": [{"name": n, "unit": "m", "offset": 0, "scale": 1} for n in (5, 6)]}, "no text"),
    "a unit of bounds that overflows": ({"rung": 1e300}, "rung"),
    "no axes": ({"axes": []}, "inconsistent"),
    "axes that are no mapping": ({"axes": ["v", "a"]}, "inconsistent"),
    "a unit of bounds of 0": ({"rung": 0.0}, "rung"),
    "more neighbours than maps": ({"k": 10**9}, "model.k"),
    "neighbours that are no number": ({"k": "all"}, "k is no whole number"),
    "a sharpness below 0": ({"exponent": -1.0}, "exponent"),
    "a kernel without width": ({"basis": {"name": "rbf", "kernel": "multiquadric", "epsilon": float("inf")}}, "epsilon"),
    "held parameters as a list": ({"fixed": ["v"]}, "fixed"),
    "a command to the terminal": ({"provenance": {"run": "\x1b[2Jgone"}}, "control characters"),
    "a command in a name": ({"provenance": {"run\x1b]0;title\x07": 1}}, "control characters"),
}


@pytest.mark.parametrize("name", HEADERS)
def test_a_header_that_was_tampered_with_is_refused_at_once(name, saved):
    changed, told = HEADERS[name]
    path = rewritten(saved, header=lambda header: header.update(changed))
    with pytest.raises(InputError, match=rf"tampered\.safetensors: .*{told}") as caught:
        read_model(path, check_all=False)
    assert str(caught.value).isprintable()


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
