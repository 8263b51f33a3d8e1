"""The command line, as its user meets it."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from walklab.cli.app import app
from walklab.cli.errors import BAD_INPUT, printable
from walklab.steering.models import ProbabilisticModel

ROOT = Path(__file__).parents[2]
SCENE = str(ROOT / "config/scenes/scenario_1.yaml")
COLUMNS = ["--participant", "person", "--height", "height_cm", "--height-unit", "cm"]


def run(*arguments, code=0):
    result = CliRunner().invoke(app, [str(a) for a in arguments])
    assert result.exit_code == code, result.output
    return result


def complaint(*arguments):
    """The one line on stderr of a command that fails."""
    result = run(*arguments, code=BAD_INPUT)
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1
    assert lines[0].startswith("walklab: ")
    assert "Traceback" not in result.output
    return lines[0]


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("cli") / "own.safetensors"
    said = run("fit", ROOT / "examples/own_walks.csv", "-o", path, *COLUMNS).stdout
    assert "20 walks of 4 people" in said
    return path


def test_help_names_the_units():
    assert {"fit", "sample", "simulate", "inspect"} <= set(run("--help").stdout.split())
    for command, words in (("sample", ["m.", "1/m."]), ("simulate", ["m.", "s."]), ("fit", ["mm.", "ms."])):
        text = run(command, "--help").stdout
        assert all(word in text for word in words), text


def test_fitting_with_either_basis(model, tmp_path):
    assert ProbabilisticModel.load(model).interpolant.name == "rbf"
    run("fit", ROOT / "examples/own_walks.csv", "-o", tmp_path / "m", *COLUMNS, "--basis", "multilinear", "--neighbours", 4)
    fast = ProbabilisticModel.load(tmp_path / "m")
    assert (fast.interpolant.name, fast.k) == ("multilinear", 4)


def test_fitting_without_a_column_of_times(model, tmp_path):
    table = pd.read_csv(ROOT / "examples/own_walks.csv")
    step_s = float(np.median(np.diff(table["time_s"])))
    table.drop(columns="time_s").to_csv(tmp_path / "w.csv", index=False)
    run("fit", tmp_path / "w.csv", "-o", tmp_path / "m", *COLUMNS, "--rate-hz", 1 / step_s)
    rated, timed = ProbabilisticModel.load(tmp_path / "m"), ProbabilisticModel.load(model)
    assert rated.blending.vectors == pytest.approx(timed.blending.vectors, rel=1e-6)
    assert timed.dependencies == ("length", "height"), "all planned paths are straight, so that curvature tells nothing"
    assert "column time_s" in complaint("fit", tmp_path / "w.csv", "-o", tmp_path / "m", *COLUMNS)


def test_sampling_prints_a_table_with_units(model):
    asked = ["--length", 2.5, "--height", 1.75, "--size", 3]
    lines = run("sample", model, *asked, "--seed", 1).stdout.splitlines()
    assert lines[0] == "v (m/s),a (m/s²),omega (1/m)"
    values = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    expected = ProbabilisticModel.load(model).sample([2.5, 1.75], 3, np.random.default_rng(1))
    assert values == pytest.approx(expected, rel=1e-5)
    assert run("sample", model, *asked, "--seed", 1).stdout.splitlines() == lines
    assert run("sample", model, *asked).stdout.splitlines() != lines


def test_a_walk_outside_the_training_range_is_told_on_stderr(model):
    result = run("sample", model, "--length", 9, "--height", 1.75)
    assert len(result.stdout.splitlines()) == 2
    assert result.stderr.count("\n") == 1
    assert "length 9 m (trained" in result.stderr


def test_simulating_writes_table_picture_and_animation(model, tmp_path):
    from PIL import Image

    arguments = ["simulate", SCENE, "--model", model, "--from", "car", "--to", "rack_2", "--height", 1.78, "--draws", 12]
    said = run(*arguments, "-o", tmp_path, "--seed", 0).stdout
    assert said.startswith("travel time: median ")
    table = pd.read_csv(tmp_path / "variants.csv")
    assert list(table) == ["draw", "v", "a", "omega", "travel_time_s", "arrival", "collided"]
    assert len(table) == 12
    missed, collided = (table["arrival"] == "passed").sum(), table["collided"].sum()
    assert f"of 12 variants {missed} missed the end and {collided} went through an obstacle" in said
    for name, frames in (("variants.png", 1), ("variants.gif", 10)):
        with Image.open(tmp_path / name) as picture:
            assert getattr(picture, "n_frames", 1) >= frames
            assert min(picture.size) > 200
    run(*arguments[:-4], "--height", 1.78, "--draws", 2, "-o", tmp_path / "still", "--no-animation")
    assert sorted(path.name for path in (tmp_path / "still").iterdir()) == ["variants.csv", "variants.png"]
    run(
        "simulate", SCENE, "-m", model, "--from", "0,0", "--to", "-1.0,-1.0", "--height", 1.8, "--draws", 1, "-o", tmp_path / "xy"
    )


def test_inspecting_names_everything(model):
    said = run("inspect", model, "--check").stdout
    for words in ("20 maps of 1000 cells", "v (m/s): 0.1 to 1.99", "height (m): trained 1.66 to 1.83", "k 20", "own_walks.csv"):
        assert words in said


def test_bad_input_is_one_line_and_exit_code_2(model, tmp_path):
    assert "height (m) is missing" in complaint("sample", model, "--length", 2)
    assert "nothing.safetensors" in complaint("inspect", tmp_path / "nothing.safetensors")
    (tmp_path / "torn").write_bytes(model.read_bytes()[:1000])
    assert "not a walklab model file" in complaint("sample", tmp_path / "torn", "--length", 2)
    assert "no station 'cr' (it has car," in complaint("simulate", SCENE, "-m", model, "--from", "cr", "--to", "rack_1")
    walk = ["simulate", SCENE, "-m", model, "--to", "rack_1", "--height", 1.8, "-o", tmp_path]
    assert "position (nan, 0.0)" in complaint(*walk, "--from", "nan,0")
    assert "time_limit_s = -1.0" in complaint(*walk, "--from", "car", "--time-limit", -1)
    assert "body radius -0.1" in complaint(*walk, "--from", "car", "--body-radius", -0.1)
    assert "train the model again" not in complaint("sample", tmp_path / "nofile", "--length", 2)
    assert "height is -1.8; it cannot be below 0" in complaint(*walk[:-3], -1.8, "--from", "car", "-o", tmp_path)
    (tmp_path / "list.yaml").write_text("obstacles: [1, 2]")
    assert "list.yaml: obstacles: give each a name" in complaint("simulate", tmp_path / "list.yaml", *walk[2:], "--from", "0,0")
    assert "no.yaml" in complaint("simulate", "no.yaml", "-m", model, "--from", "a", "--to", "b")
    assert "column participant" in complaint("fit", ROOT / "examples/own_walks.csv", "-o", tmp_path / "m")
    assert "there is no 'quintic'" in complaint("fit", ROOT / "examples/own_walks.csv", *COLUMNS, "--basis", "quintic")
    run("sample", model, "--size", 0, code=BAD_INPUT)  # typer's own check


@pytest.mark.parametrize("command", [["sample"], ["simulate", SCENE, "-m"]])
def test_a_negative_seed_is_refused(command, model):
    result = run(*command, model, "--seed", -1, code=2)
    assert "--seed" in result.stderr
    assert "Traceback" not in result.output


OTHERS = ["--height", 1.7]
HOSTILE = {
    "a length whose square overflows": (["sample", "MODEL", "--length", "1e300", *OTHERS], "up to 1e+12"),
    "more draws than memory": (["sample", "MODEL", "--length", 2, *OTHERS, "--size", 10**14], "not enough memory"),
    "a start beyond whole numbers": (["simulate", "SCENE", "-m", "MODEL", "--from", "1e300,0", "--to", "3,0"], "too far away"),
    "a scene that is no text": (["simulate", "BINARY", "-m", "MODEL", "--from", "0,0", "--to", "3,0"], "UTF-8"),
    "a record nested without end": (["compare", "NESTED", "NESTED"], "not a readable JSON file"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_input_is_one_line(name, model, tmp_path):
    command, told = HOSTILE[name]
    (tmp_path / "binary.yaml").write_bytes(b"\x96\xff\x00")
    (tmp_path / "run.json").write_text("[" * 100_000)
    files = {"MODEL": model, "SCENE": SCENE, "BINARY": tmp_path / "binary.yaml", "NESTED": tmp_path}
    result = run(*(files.get(part, part) for part in command), code=BAD_INPUT)
    assert told in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def test_control_characters_are_written_out():
    assert printable("a\x1b]0;t\x07\nb") == "a\\x1b]0;t\\x07\nb"


def test_the_module_runs_as_a_program(model):
    command = [sys.executable, "-m", "walklab.cli.app", "sample", str(model), "--length", "2"]
    ended = subprocess.run(command, capture_output=True, text=True, env={**os.environ})
    assert ended.returncode == BAD_INPUT
    assert ended.stderr == "walklab: dependency height (m) is missing; this model needs length, height\n"
