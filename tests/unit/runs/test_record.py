"""The record of a run holds what tells it from another, and nothing that names its user."""

import getpass
import hashlib
import json
import os
import platform

import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.runs.io import read_record
from walklab.runs.record import commit, processor, record, stage_cost
from walklab.storage import write_table


def test_claims_scores_and_products_are_kept_in_brief(run):
    found = read_record(run)
    assert [claim["id"] for claim in found["claims"]] == ["first", "second"]
    assert found["claims"][1]["ours"] is None
    assert [score["crps_s"] for score in found["scores"]] == [0.2], "only the row of all walks"
    figure = run / "figures/fig11.svg"
    assert found["products"]["figures/fig11.svg"] == hashlib.sha256(figure.read_bytes()).hexdigest()
    assert found["code"] == {"score_maps.py": "digest 100"}
    assert found["versions"]["numpy"]


def test_tables_over_many_replicates_are_products_without_a_brief(tmp_path):
    path = tmp_path / "results/replicates/claims.csv"
    write_table(pd.DataFrame({"id": ["first"], "published": [0.453], "reproduced": [3]}), path)
    found = record({"run": "replicates", "seed": 1}, tmp_path, [], {}, [str(path)], path.parent)
    assert found["claims"] == []
    assert list(found["products"]) == ["claims.csv"]


def test_nobody_is_named(run):
    text = json.dumps(read_record(run))
    assert os.path.expanduser("~") + "/" not in text
    assert platform.node() not in text or len(platform.node()) < 4
    assert f'"{getpass.getuser()}"' not in text


def test_the_cost_of_a_short_job_has_no_memory(tmp_path):
    path = tmp_path / "benchmark.tsv"
    path.write_text("s\th:m:s\tmax_rss\n0.2514\t0:00:00\t-\n")
    relative = "results/steering/3/score_maps/1/benchmark.tsv"
    target = tmp_path / relative
    target.parent.mkdir(parents=True)
    path.rename(target)
    before = os.getcwd()
    os.chdir(tmp_path)
    try:
        cost = stage_cost(relative)
    finally:
        os.chdir(before)
    assert cost == {"stage": "score_maps", "part": "1", "replicate": 3, "wall_s": 0.25, "peak_memory_mb": 0.0}


def test_outside_of_git_there_is_no_commit(tmp_path):
    assert commit(tmp_path) == {}


def test_the_processor_is_read_where_linux_tells_it(tmp_path):
    (tmp_path / "cpuinfo").write_text("vendor_id : X\nmodel name\t: Some CPU @ 2 GHz\n")
    assert processor(tmp_path / "cpuinfo") == "Some CPU @ 2 GHz"
    assert processor(tmp_path / "absent") == platform.processor()


@pytest.mark.parametrize(
    ("text", "reason"), [(None, "no such record"), ("{", "not a readable JSON"), ("{}", "it lacks run"), ("[]", "it lacks run")]
)
def test_a_missing_or_spoilt_record_is_named(tmp_path, text, reason):
    if text is not None:
        (tmp_path / "run.json").write_text(text)
    with pytest.raises(InputError, match=rf"run\.json.*{reason}"):
        read_record(tmp_path)
