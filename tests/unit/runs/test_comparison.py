"""Comparing two records: exactly what differs, in both directions."""

import json

import pandas as pd
import pytest
from typer.testing import CliRunner

from walklab.cli.app import app
from walklab.cli.errors import BAD_INPUT
from walklab.runs.comparison import ABSENT, compare, differences, flat
from walklab.runs.io import read_record


def test_a_run_does_not_differ_from_itself(run):
    found = compare(read_record(run), read_record(run))
    for table in (found.config, found.code, found.versions, found.changed_claims):
        assert table.empty
    assert (found.scores["difference"] == 0).all()
    assert (found.cost["ratio"] == 1).all()


def test_what_differs_is_listed(run, other):
    found = compare(read_record(run), read_record(other))
    assert found.config.to_dict("records") == [
        {"key": "run", "before": "study", "after": "other"},
        {"key": "model.k", "before": 100, "after": 50},
    ]
    assert list(found.code["key"]) == ["score_maps.py"]
    changed = found.changed_claims
    assert list(changed["id"]) == ["first"]
    assert changed[["verdict_before", "verdict_after"]].iloc[0].tolist() == ["reproduced", "not reproduced"]
    crps = found.scores[found.scores["measure"] == "crps_s"].iloc[0]
    assert crps["difference"] == pytest.approx(0.1)
    assert found.cost["ratio"].tolist() == [2.0]


def test_a_key_of_one_run_alone_is_a_difference():
    table = differences({"a": 1}, {"a": 1, "b": 2})
    assert table.to_dict("records") == [{"key": "b", "before": ABSENT, "after": 2}]


def test_nested_keys_are_dotted_and_lists_stay_whole():
    assert flat({"a": {"b": 1, "c": [1, {"d": 2}]}, "e": None}) == {"a.b": 1, "a.c": [1, {"d": 2}], "e": None}


def test_records_from_before_claims_were_kept_compare_too(run, other):
    old = {name: value for name, value in read_record(run).items() if name not in {"claims", "scores", "code"}}
    found = compare(old, read_record(other))
    assert set(found.claims["verdict_before"]) == {ABSENT}
    assert found.scores["before"].isna().all()


def test_the_command_prints_and_draws(run, other, tmp_path):
    result = CliRunner().invoke(app, ["compare", str(run), str(other), "-o", str(tmp_path / "changes.png")])
    assert result.exit_code == 0, result.output
    for words in ("model.k", "score_maps", "claims (of 2): 1 changed", "not reproduced", "P_Prob (calibrated)"):
        assert words in result.stdout
    assert (tmp_path / "changes.png").read_bytes().startswith(b"\x89PNG")


def test_a_folder_without_a_run_ends_in_one_line(run, tmp_path):
    result = CliRunner().invoke(app, ["compare", str(run), str(tmp_path)])
    assert result.exit_code == BAD_INPUT
    assert result.stderr.strip() == (
        f"walklab: {tmp_path / 'run.json'}: no such record; name the folder of a finished run, such as results/steering"
    )


def test_tables_of_a_comparison_have_the_columns_that_are_drawn(run, other):
    found = compare(read_record(run), read_record(other))
    assert {"stage", "before", "after", "ratio"} == set(found.cost)
    assert isinstance(found.scores, pd.DataFrame)


@pytest.mark.parametrize(
    ("key", "value"), [("claims", 5), ("claims", [5]), ("stages", {}), ("products", []), ("commit", "abc"), ("config", None)]
)
def test_a_damaged_record_is_named_with_its_key(run, key, value):
    path = run / "run.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))
    result = CliRunner().invoke(app, ["compare", str(run), str(run)])
    assert result.exit_code == BAD_INPUT
    assert result.stderr.strip() == f"walklab: {path}: damaged, {key} is not what a record has there; run the study again"


def test_numbers_that_are_none_end_in_one_line(run):
    path = run / "run.json"
    record = json.loads(path.read_text())
    path.write_text(json.dumps(record | {"claims": [{"id": "first", "ours": "much", "verdict": "reproduced"}]}))
    result = CliRunner().invoke(app, ["compare", str(run), str(run)])
    assert result.exit_code == BAD_INPUT
    assert "one of them is damaged" in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def test_products_differ_by_checksum(run, other):
    before, after = read_record(run), read_record(other)
    found = compare(
        before | {"products": {"a.csv": "0" * 64, "b.csv": "1" * 64}},
        after | {"products": {"a.csv": "2" * 64, "b.csv": "1" * 64}},
    )
    assert found.products.to_dict("records") == [{"key": "a.csv", "before": "0" * 12, "after": "2" * 12}]


def test_another_kind_of_picture_is_refused_before_anything_is_read(tmp_path):
    result = CliRunner().invoke(app, ["compare", "nowhere", "nowhere", "-o", str(tmp_path / "x.txt")])
    assert result.exit_code == BAD_INPUT
    assert "give a name that ends in .png" in result.stderr


def test_a_record_cannot_command_the_terminal(run, other):
    path = run / "run.json"
    record = json.loads(path.read_text())
    path.write_text(json.dumps(record | {"run": "a\x1b]0;t\x07", "config": {"\x1b]0;t\x07": 1}}))
    told = CliRunner().invoke(app, ["compare", str(run), str(other)], color=True)
    assert told.exit_code == 0
    assert "\x1b" not in told.output
    assert told.output.count("\\x1b]0;t\\x07") == 2
