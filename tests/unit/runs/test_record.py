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


def test_claims_of_many_specifications_are_a_product_without_a_brief(tmp_path):
    folder = tmp_path / "results/multiverse"
    columns = {name: [0.4] for name in ("published", "ours", "ours_low", "ours_high")}
    write_table(
        pd.DataFrame({"specification": ["default"], "claim": ["first"], **columns, "verdict": ["partly"]}), folder / "claims.csv"
    )
    found = record({"run": "steering", "seed": 1}, tmp_path, [], {}, [str(folder / "claims.csv")], folder)
    assert found["claims"] == []
    assert found["run"] == "multiverse", "named after its folder: the configuration is that of the study it varies"
    assert list(found["products"]) == ["claims.csv"]


def test_the_cost_of_a_short_job_has_no_memory(tmp_path):
    path = tmp_path / "3/score_maps/1/benchmark.tsv"
    path.parent.mkdir(parents=True)
    path.write_text("s\th:m:s\tmax_rss\n0.2514\t0:00:00\t-\n")
    cost = stage_cost(path, tmp_path)
    assert cost == {"stage": "score_maps", "part": "1", "replicate": 3, "wall_s": 0.25, "peak_memory_mb": 0.0}


def test_what_has_no_replicates_counts_as_replicate_0(tmp_path):
    path = tmp_path / "evaluate_specification/default/benchmark.tsv"
    path.parent.mkdir(parents=True)
    path.write_text("s\th:m:s\tmax_rss\n2.5\t0:00:02\t700.04\n")
    cost = stage_cost(path, tmp_path)
    assert cost == {"stage": "evaluate_specification", "part": "default", "replicate": 0, "wall_s": 2.5, "peak_memory_mb": 700.0}


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
