"""Every row of the table of speeds (``make bench``): ours by pytest-benchmark, its baseline right before and after."""

from __future__ import annotations

import time
from importlib import import_module

import pytest
from case import Case
from summary import SUMMARY, add, row

from walklab.storage import read_json

TIMED = ("bench_sweep", "bench_lazy_theta_star", "bench_model", "bench_study")
CASES: list[Case] = [case for name in TIMED for case in import_module(name).CASES]
MEASURES = import_module("bench_memory").MEASURES | import_module("bench_study").MEASURES
# A sample outside the training range warns; warnings that are recorded cost time.
pytestmark = pytest.mark.filterwarnings("ignore")
CLOCKS = {False: time.process_time, True: time.perf_counter}


def param(case: Case):
    name = f"{case.key}-{case.variant}" if case.variant else case.key
    return pytest.param(case, id=name, marks=pytest.mark.benchmark(timer=CLOCKS[case.wall], group=case.key))


@pytest.fixture(scope="module", autouse=True)
def fresh_summary():
    """Rows of an earlier run must not stand beside those of this one."""
    SUMMARY.unlink(missing_ok=True)


@pytest.mark.parametrize("case", [param(case) for case in CASES])
def test_beside_its_baseline(case: Case, benchmark):
    work = case.prepare()
    before = work.baseline_s() if work.baseline_s else None
    benchmark.pedantic(work.ours, rounds=work.rounds, warmup_rounds=int(work.rounds > 1))
    ours = benchmark.stats.stats.min / work.units
    # A slow moment of the machine must not make the baseline look bad.
    baseline = None if before is None else work.factor * min(before, work.baseline_s())
    found = row(work.factor * ours, baseline, work.baseline_name, work.unit)
    benchmark.extra_info.update(found)
    other = read_json(SUMMARY).get(case.key) if SUMMARY.is_file() else None
    if other is None or other["ours"] < found["ours"]:  # of several variants the slowest counts
        add(case.key, found)


@pytest.mark.parametrize("key", MEASURES)
def test_peak_memory(key: str):
    measure_mb, unit = MEASURES[key]
    add(key, row(measure_mb(), None, "", unit))
