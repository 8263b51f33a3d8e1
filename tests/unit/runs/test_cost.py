"""What a job says of its cost is what it took."""

import json
import subprocess
import sys
import time

import pytest

from walklab.runs import cost

JOB = """
import sys, time
from walklab.runs import cost
held = bytearray(200_000_000)
del held
end = time.process_time() + 0.3
while time.process_time() < end:
    pass
cost.write(sys.argv[1])
"""


def test_a_job_measures_a_peak_that_is_over_and_what_came_before_it(tmp_path):
    subprocess.run([sys.executable, "-c", JOB, str(tmp_path)], check=True)
    found = json.loads((tmp_path / cost.FILE).read_text())
    assert 220 < found["peak_memory_mb"] < 600
    assert found["cpu_s"] >= 0.3
    assert found["wall_s"] >= 0.3


def test_a_job_does_not_say_that_it_took_longer_than_from_its_start_to_its_end(tmp_path):
    for turn in range(3):  # the time of day of a start, to a second, would be right by chance
        began = time.perf_counter()
        subprocess.run([sys.executable, "-c", JOB, str(tmp_path)], check=True)
        took_s = time.perf_counter() - began
        assert json.loads((tmp_path / cost.FILE).read_text())["wall_s"] <= took_s + 0.02, turn
        time.sleep(0.3)


def test_the_memory_of_the_program_that_started_a_job_is_not_counted(tmp_path):
    ballast = bytearray(b"x" * 500_000_000)
    subprocess.run([sys.executable, "-c", JOB, str(tmp_path)], check=True)
    assert len(ballast) > 0
    assert json.loads((tmp_path / cost.FILE).read_text())["peak_memory_mb"] < 500


def test_the_peak_is_read_in_kib(tmp_path):
    (tmp_path / "status").write_text("Name:\tpython\nVmHWM:\t  200000 kB\nVmRSS:\t 1 kB\n")
    assert cost.peak_memory_mb(tmp_path / "status") == pytest.approx(204.8)
