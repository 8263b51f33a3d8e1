"""Costs that follow the stated laws are found exactly, and carried on to any number of walks."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from walklab.errors import InputError
from walklab.runs import sizing
from walklab.runs.sizing import MEETING, SHARDED, Cost, Line
from walklab.storage import write_json

RULES = {"cpu_s": Line(2.0, 0.003), "memory_mb": Line(300.0, 0.05), "disk_mb": Line(0.0, 0.04)}


def jobs(sizes):
    return [Cost(walks, *(RULES[name].at(walks) for name in ("cpu_s", "memory_mb", "disk_mb"))) for walks in sizes]


@pytest.fixture
def costs():
    spaces = [
        Cost(walks, *(RULES[name].at(walks + added) for name in RULES), added) for walks, added in ((1848, 3152), (51744, 8256))
    ]
    return {**{stage: jobs([500, 4000]) for stage in SHARDED}, MEETING: spaces}


@pytest.mark.parametrize("name", RULES)
def test_a_line_is_found_exactly(name):
    sizes = [500, 1000, 1000, 4000]
    found = sizing.line(sizes, [RULES[name].at(size) for size in sizes])
    assert found.fixed == pytest.approx(RULES[name].fixed, abs=1e-6)
    assert found.per_walk == pytest.approx(RULES[name].per_walk)


def test_noise_gives_no_negative_fixed_cost():
    found = sizing.line([100, 1000], [1.0, 30.0])
    assert found.fixed == 0
    assert 0 < found.per_walk < 0.031


def test_jobs_of_one_size_do_not_tell_fixed_from_growing_cost():
    with pytest.raises(InputError, match="different sizes"):
        sizing.line([1000, 1010], [1.0, 2.0])


def test_a_job_that_compiles_is_no_measure_of_its_equals():
    found = sizing.typical([Cost(900, 9.4, 500.0, 5.0), Cost(900, 4.7, 480.0, 5.0)])
    assert found == Cost(900, 4.7, 500.0, 5.0)


def test_the_blending_space_grows_with_its_entries(costs):
    for added in (0.0, 0.16):
        row = sizing.sizing(costs, [10**6], 2000, added).set_index("stage").loc[MEETING]
        entries = (1 + added) * 1e6
        assert row["core_hours"] == pytest.approx(RULES["cpu_s"].at(entries) / 3600)
        assert row["memory_gb"] == pytest.approx(RULES["memory_mb"].at(entries) / 1e3)


def test_totals_are_those_of_all_shards(costs):
    table = sizing.sizing(costs, [1000, 10**7], 2000, 0.0).set_index(["walks", "stage"])
    assert table.loc[(1000, "score_maps"), "jobs"] == 1
    large = table.loc[(10**7, "score_maps")]
    assert large["jobs"] == 5000
    assert large["core_hours"] == pytest.approx((5000 * 2.0 + 1e7 * 0.003) / 3600)
    assert large["memory_gb"] == pytest.approx(0.4)  # of one shard
    assert table.loc[(10**7, MEETING), "memory_gb"] == pytest.approx(0.3 + 500)  # of all walks
    text = sizing.as_markdown(table.reset_index(), node_memory_gb=256, job_hours=0.1)
    assert text.count("fits") == 1
    assert "breaks: build_space needs more than 256 GB; build_space takes more than 0.1 hours" in text


def test_costs_are_read_from_the_files_of_a_run(tmp_path):
    replicate = tmp_path / "0"
    for stage in (*SHARDED, MEETING):
        folder = replicate / stage / ("0" if stage in SHARDED else "")
        folder.mkdir(parents=True, exist_ok=True)
        write_json({"wall_s": 9.0, "cpu_s": 4.5, "peak_memory_mb": 321.0}, folder / "cost.json")
        (folder / "log.txt").write_text("not a product")
        (folder / "product.nc").write_bytes(bytes(2_000_000))
    pd.DataFrame({"walk": np.arange(7)}).to_parquet(replicate / "plan_training/0/vectors.parquet")
    space = replicate / MEETING / "blending_space.nc"
    xr.Dataset({"vector": ("entry", np.zeros(10))}).to_netcdf(space)
    found = sizing.measured([tmp_path])
    assert found["score_maps"] == [Cost(7, 4.5, 321.0, 2.0)]
    assert found[MEETING] == [Cost(7, 4.5, 321.0, 2.0 + space.stat().st_size / 1e6, added=3)]
    with pytest.raises(InputError, match="no finished build_space"):
        sizing.measured([replicate])
