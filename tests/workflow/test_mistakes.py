"""Bad configurations and bad recordings each end in one clear message, never in a traceback."""

import json

import numpy as np
import pandas as pd
import pytest

pytestmark = pytest.mark.workflow

TINY = ("--configfile", "tests/workflow/tiny.yaml")

CONFIGS = {
    "unknown section": ({"modell": {"k": 3}}, "config key modell: unknown; did you mean 'model'"),
    "unknown key": ({"model": {"neighbors": 3}}, "config key model.neighbors: unknown"),
    "ill-typed": ({"model": {"k": "all"}}, "config key model.k: 'all' is not of type 'integer'"),
    "another unit": ({"body": {"radius_m": 25}}, "config key body.radius_m: 25 is greater than the maximum of 1 (unit: m)"),
    "no fit": ({"record_scenario": {"sets": [1, 1, 1, 1]}}, "config key record_scenario.sets: 4 numbers for 3 participants"),
    "no such plan view": (
        {"scenarios": {"scenario_1": "config/scenes/nowhere.yaml"}},
        "config key scenarios.scenario_1: config/scenes/nowhere.yaml does not exist",
    ),
    "no such walks": ({"source": {"kind": "table", "path": "absent.csv"}}, "config key source.path: absent.csv does not exist"),
    "a file of the user's that is none of its business": (
        {"source": {"kind": "table", "path": "/etc/passwd"}},
        "config key source.path: /etc/passwd lies outside of the working folder",
    ),
    "a run name that would leave the results": ({"run": "../../elsewhere"}, "config key run"),
    "unknown planner": ({"planner": {"name": "teleport"}}, "teleport"),
    "unknown parameter": ({"space": [{"name": name, "unit": "-", "values": [1, 2]} for name in "vw"]}, "'w'"),
}


@pytest.mark.parametrize("name", CONFIGS)
def test_a_bad_configuration_stops_with_its_reason(project, name):
    overrides, expected = CONFIGS[name]
    (project.folder / "bad.yaml").write_text(json.dumps(overrides))
    output = project.run(
        "--cores", "2", "--configfile", "tests/workflow/tiny.yaml", "bad.yaml", "--until", "plan_training", fails=True
    )
    assert expected in output
    assert "Traceback" not in output


def walks() -> pd.DataFrame:
    time_s = np.arange(0, 3, 0.01)
    x_m = np.interp(time_s, [0.5, 2.5], [0.0, 2.0])
    return pd.concat(
        [
            pd.DataFrame({"participant": who, "walk": 1, "time_s": time_s, "x_m": x_m, "y_m": 0.0, "height_m": 1.7})
            for who in "ABC"
        ],
        ignore_index=True,
    )


RECORDINGS = {
    "a gap": (lambda frame: frame.assign(x_m=frame["x_m"].where(frame.index != 40)), "x_m"),
    "unsorted time": (lambda frame: frame.assign(time_s=frame["time_s"].to_numpy()[::-1]), "time_s"),
    "centimetres": (lambda frame: frame.assign(x_m=frame["x_m"] * 100), "x_m"),
    "height in cm": (lambda frame: frame.assign(height_m=170.0), "height_m"),
    "a missing column": (lambda frame: frame.drop(columns="y_m"), "y_m"),
    "no rows": (lambda frame: frame.iloc[:0], "own.csv"),
}


@pytest.mark.parametrize("name", RECORDINGS)
def test_a_bad_recording_stops_with_file_and_column(project, name):
    spoil, expected = RECORDINGS[name]
    spoil(walks()).to_csv(project.folder / "own.csv", index=False)
    (project.folder / "bad.yaml").write_text(json.dumps({"source": {"kind": "table", "path": "own.csv"}}))
    output = project.run(
        "--cores", "1", "--configfile", "tests/workflow/tiny.yaml", "bad.yaml", "--until", "import_walks", fails=True
    )
    message = next(line for line in output.splitlines() if "error in import_walks" in line)
    assert "own.csv" in message
    assert expected in message
    assert "Traceback" not in output
