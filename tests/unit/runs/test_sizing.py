"""Costs that follow the stated laws are found exactly, and carried on to any number of walks."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from walklab.errors import InputError
from walklab.runs import sizing
from walklab.runs.sizing import MEETING, SHARDED, Cost, Costs, Line
from walklab.storage import write_json

RULES = {"cpu_s": Line(2.0, 0.003), "memory_mb": Line(300.0, 0.05), "disk_mb": Line(0.0, 0.04)}
IDLE_S = 1.5
PER_WALK_S, PER_PAIR_S = 2e-4, 4e-7


def jobs(sizes):
    return [Cost(walks, *(RULES[name].at(walks) for name in ("cpu_s", "memory_mb", "disk_mb"))) for walks in sizes]


def meeting(walks, added):
    """The blending space, by the law of up-sampling."""
    entries = walks + added
    cpu_s = IDLE_S + PER_WALK_S * walks + PER_PAIR_S * added * entries
    return Cost(walks, cpu_s, RULES["memory_mb"].at(entries), RULES["disk_mb"].at(entries), added)


@pytest.fixture
def costs():
    return Costs(
        {**{stage: jobs([500, 4000]) for stage in SHARDED}, MEETING: [meeting(1848, 3152), meeting(51744, 8256)]}, IDLE_S
    )


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


def test_upsampling_is_not_taken_for_a_straight_line(costs):
    assert sizing.upsampling(costs.stages[MEETING], IDLE_S) == pytest.approx((PER_WALK_S, PER_PAIR_S))
    table = sizing.sizing(costs, [10**6], 2000, added_per_walk=0.16).set_index("stage")
    assert table.loc[MEETING, "core_hours"] == pytest.approx(meeting(10**6, 160_000).cpu_s / 3600)
    assert table.loc[MEETING, "memory_gb"] == pytest.approx(meeting(10**6, 160_000).memory_mb / 1e3)


def test_without_added_entries_only_walks_cost(costs):
    table = sizing.sizing(costs, [10**6], 2000, added_per_walk=0.0).set_index("stage")
    assert table.loc[MEETING, "core_hours"] == pytest.approx((IDLE_S + PER_WALK_S * 1e6) / 3600)


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
    for stage in (*SHARDED, MEETING, sizing.IDLE):
        folder = replicate / stage / ("0" if stage in SHARDED else "")
        folder.mkdir(parents=True, exist_ok=True)
        write_json({"wall_s": 9.0, "cpu_s": 4.5, "peak_memory_mb": 321.0}, folder / "cost.json")
        (folder / "log.txt").write_text("not a product")
        (folder / "product.nc").write_bytes(bytes(2_000_000))
    pd.DataFrame({"walk": np.arange(7)}).to_parquet(replicate / "plan_training/0/vectors.parquet")
    space = replicate / MEETING / "blending_space.nc"
    xr.Dataset({"vector": ("entry", np.zeros(10))}).to_netcdf(space)
    found = sizing.measured([tmp_path])
    assert found.idle_cpu_s == 4.5
    assert found.stages["score_maps"] == [Cost(7, 4.5, 321.0, 2.0)]
    assert found.stages[MEETING] == [Cost(7, 4.5, 321.0, 2.0 + space.stat().st_size / 1e6, added=3)]
    with pytest.raises(InputError, match="no finished build_space"):
        sizing.measured([replicate])
