"""The record of a run holds what tells it from another, and nothing that names its user."""

import getpass
import hashlib
import json
import os
import platform
import socket
import subprocess
from pathlib import Path

import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.runs.io import read_record
from walklab.runs.record import commit, processor, record, stage_cost
from walklab.storage import write_json, write_table


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
    found = record({"run": "replicates", "seed": 1}, tmp_path, [], {}, [str(path)], path.parent, "record_run")
    assert found["claims"] == []
    assert list(found["products"]) == ["claims.csv"]


def test_nobody_is_named(request, monkeypatch):
    monkeypatch.setattr(platform, "node", lambda: "a-host-with-a-name")
    monkeypatch.setattr(socket, "gethostname", lambda: "a-host-with-a-name")
    monkeypatch.setattr(platform, "uname", lambda: platform.uname_result("Linux", "a-host-with-a-name", "6.1", "#1", "x86_64"))
    text = json.dumps(read_record(request.getfixturevalue("run")))
    assert os.path.expanduser("~") + "/" not in text
    assert "a-host-with-a-name" not in text
    assert f'"{getpass.getuser()}"' not in text


def test_claims_of_many_specifications_are_a_product_without_a_brief(tmp_path):
    folder = tmp_path / "results/multiverse"
    columns = {name: [0.4] for name in ("published", "ours", "ours_low", "ours_high")}
    write_table(
        pd.DataFrame({"specification": ["default"], "claim": ["first"], **columns, "verdict": ["partly"]}), folder / "claims.csv"
    )
    found = record({"run": "steering", "seed": 1}, tmp_path, [], {}, [str(folder / "claims.csv")], folder, "record_run")
    assert found["claims"] == []
    assert found["run"] == "multiverse", "named after its folder: the configuration is that of the study it varies"
    assert list(found["products"]) == ["claims.csv"]


def test_every_job_and_the_one_that_records_are_stages(tmp_path):
    costs = [tmp_path / part / "cost.json" for part in ("0/count_distances", "3/score_maps/1", "record_run")]
    for wall_s, path in enumerate(costs, start=1):
        write_json({"wall_s": wall_s, "cpu_s": 0.5, "peak_memory_mb": 100.0 * wall_s}, path)
    found = record({"run": "study", "seed": 1}, tmp_path, list(map(str, costs)), {}, [], tmp_path, "record_run")
    first, second, own = found["stages"]
    cost = {"wall_s": 1, "cpu_s": 0.5, "peak_memory_mb": 100.0}
    assert first == {"stage": "count_distances", "part": "", "replicate": 0, **cost}
    assert (second["stage"], second["part"], second["replicate"]) == ("score_maps", "1", 3)
    assert own["stage"] == "record_run", "that of an earlier record does not count"
    assert own["wall_s"] != 3
    assert found["totals"]["jobs_cpu_s"] == pytest.approx(1.0 + own["cpu_s"], abs=0.06)
    assert found["totals"]["peak_memory_mb"] == max(200.0, own["peak_memory_mb"])


def test_what_has_no_replicates_counts_as_replicate_0(tmp_path):
    path = tmp_path / "evaluate_specification/default/cost.json"
    write_json({"wall_s": 2.5, "cpu_s": 2.0, "peak_memory_mb": 700.0}, path)
    cost = stage_cost(path, tmp_path)
    assert (cost["stage"], cost["part"], cost["replicate"]) == ("evaluate_specification", "default", 0)


def test_outside_of_git_there_is_no_commit(tmp_path, monkeypatch):
    monkeypatch.delenv("WALKLAB_COMMIT", raising=False)
    assert commit(tmp_path) == {}


@pytest.mark.parametrize(("told", "dirty"), [("false", False), ("true", True), ("", True)])
@pytest.mark.parametrize("has_git", [True, False])
def test_in_an_image_the_commit_is_the_one_it_was_built_from(has_git, told, dirty, tmp_path, monkeypatch):
    monkeypatch.setenv("WALKLAB_COMMIT", "0123456789abcdef")
    monkeypatch.setenv("WALKLAB_DIRTY", told)
    if not has_git:
        monkeypatch.setenv("PATH", str(tmp_path))
    assert commit(tmp_path) == {"id": "0123456789abcdef", "dirty": dirty}


def test_git_knows_better_than_the_environment(tmp_path, monkeypatch):
    git = ("git", "-C", str(tmp_path), "-c", "user.name=A", "-c", "user.email=a@example.org")
    for arguments in (["init", "--quiet"], ["commit", "--quiet", "--allow-empty", "--message", "first"]):
        subprocess.run([*git, *arguments], check=True)
    monkeypatch.setenv("WALKLAB_COMMIT", "0123456789abcdef")
    found = commit(tmp_path)
    assert len(found["id"]) == 40
    assert not found["dirty"]
    (tmp_path / "new").touch()
    assert commit(tmp_path) == found | {"dirty": True}


@pytest.mark.parametrize("name", ["WALKLAB_COMMIT", "WALKLAB_DIRTY"])
def test_the_containerfile_passes_the_commit_on(name):
    lines = (Path(__file__).parents[3] / "Containerfile").read_text().splitlines()
    given = lines.index(f"ARG {name}")
    assert any(line.startswith("ENV ") and f"{name}=${name}" in line.split() for line in lines[given:])


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
