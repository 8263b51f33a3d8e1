"""Costs that are straight lines are found exactly, and carried on to any number of walks."""

import numpy as np
import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.runs import sizing
from walklab.runs.sizing import MEETING, SHARDED, Cost, Line

RULES = {"cpu_s": Line(2.0, 0.003), "memory_mb": Line(300.0, 0.05), "disk_mb": Line(0.0, 0.04)}


def costs(sizes):
    return [Cost(walks, *(RULES[name].at(walks) for name in ("cpu_s", "memory_mb", "disk_mb"))) for walks in sizes]


@pytest.mark.parametrize("name", RULES)
def test_a_line_is_found_exactly(name):
    found = sizing.line(costs([500, 1000, 1000, 4000]), name)
    assert found.fixed == pytest.approx(RULES[name].fixed, abs=1e-6)
    assert found.per_walk == pytest.approx(RULES[name].per_walk)


def test_noise_gives_no_negative_fixed_cost():
    found = sizing.line([Cost(100, 1.0, 0, 0), Cost(1000, 30.0, 0, 0)], "cpu_s")
    assert found.fixed == 0
    assert 0 < found.per_walk < 0.031


def test_jobs_of_one_size_do_not_tell_fixed_from_growing_cost():
    with pytest.raises(InputError, match="different sizes"):
        sizing.line(costs([1000, 1010]), "cpu_s")


def test_totals_are_those_of_all_shards():
    measured = {stage: costs([500, 4000]) for stage in (*SHARDED, MEETING)}
    table = sizing.sizing(measured, [1000, 10**7], walks_per_shard=2000).set_index(["walks", "stage"])
    assert table.loc[(1000, "score_maps"), "jobs"] == 1
    large = table.loc[(10**7, "score_maps")]
    assert large["jobs"] == 5000
    assert large["core_hours"] == pytest.approx((5000 * 2.0 + 1e7 * 0.003) / 3600)
    assert large["memory_gb"] == pytest.approx(0.4)  # of one shard
    assert table.loc[(10**7, MEETING), "memory_gb"] == pytest.approx(0.3 + 500)  # of all walks
    text = sizing.as_markdown(table.reset_index(), node_memory_gb=256)
    assert text.count("fits") == 1
    assert "breaks: build_space" in text


def test_costs_are_read_from_the_files_of_a_run(tmp_path):
    shard = tmp_path / "0/extract_training/0"
    for stage in (*SHARDED, MEETING):
        folder = tmp_path / "0" / stage / ("" if stage == MEETING else "0")
        folder.mkdir(parents=True, exist_ok=True)
        pd.DataFrame({"s": [9.0], "max_rss": [321.0], "cpu_time": [4.5]}).to_csv(folder / "benchmark.tsv", sep="\t", index=False)
        (folder / "log.txt").write_text("not a product")
        (folder / "product.nc").write_bytes(bytes(2_000_000))
    pd.DataFrame({"walk": np.arange(7)}).to_parquet(shard / "walks.parquet")
    found = sizing.measured([tmp_path])
    assert found["score_maps"] == [Cost(7, 4.5, 321.0, 2.0)]
    assert found[MEETING] == [Cost(7, 4.5, 321.0, 2.0)]
    with pytest.raises(InputError, match="no finished build_space"):
        sizing.measured([tmp_path / "0"])
