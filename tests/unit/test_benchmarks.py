"""The benchmarks have every row that is promised, and the work of the rows runs: nothing here is timed."""

import importlib
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def modules(monkeypatch):
    names = {path.stem for path in FOLDER.glob("*.py")}
    monkeypatch.syspath_prepend(FOLDER)
    yield importlib.import_module
    for name in names:
        sys.modules.pop(name, None)


def test_every_goal_has_a_measurement_and_every_measurement_a_goal(modules):
    benchmarks, summary = modules("test_benchmarks"), modules("summary")
    assert {case.key for case in benchmarks.CASES} | set(benchmarks.MEASURES) == set(summary.GOALS)


def test_a_step_of_the_lanes_is_counted_once_per_straight_beginning_and_the_sweep_runs(modules):
    sweep = modules("bench_sweep")
    lanes, steps, _ = sweep.sweep_work()
    lanes()
    frames = sum(len(sweep.cells()) * count for count in sweep.np.diff(sweep.walks(64).captured_offsets))
    assert 0 < steps < frames


def test_the_table_says_what_was_reached_and_what_was_not_measured(modules):
    summary = modules("summary")
    rows = {"sweep_vs_rvo": summary.row(2.0, 158.0, "peer", "ns"), "maps_1848": summary.row(2.5, None, "", "s, 2 threads")}
    lines = summary.table(rows).splitlines()
    assert lines[2] == "| `sweep_vs_rvo` | 2 ns | 158 (peer) | 79 | at least 80 | no |"
    assert "| `maps_1848` | 2.5 s, 2 threads | - | - | at most 3 s | yes |" in lines
    assert "| `study` | not measured | | | | |" in lines
