"""The counts of faults say what was tried, also when it failed, and of which commit they are."""

import json

import pytest
from tally import Tally, keep

COMMIT = {"id": "1234", "dirty": False}
ONCE, LOST = {"tried": 1, "survived": 1}, {"tried": 1, "survived": 0}


def test_an_attempt_that_fails_was_tried():
    tally = Tally()
    with tally.attempt("a"):
        pass
    with pytest.raises(AssertionError), tally.attempt("b"):
        raise AssertionError
    assert tally.counts == {"a": ONCE, "b": LOST}


def test_attempts_of_the_same_commit_are_kept_together(tmp_path):
    path = tmp_path / "faults.json"
    keep({"b": ONCE}, path, COMMIT)
    keep({"a": LOST}, path, COMMIT)
    assert json.loads(path.read_text()) == {"commit": COMMIT, "a": LOST, "b": ONCE}


@pytest.mark.parametrize("other", [{"id": "5678", "dirty": False}, {"id": "1234", "dirty": True}])
def test_counts_of_another_commit_are_dropped(tmp_path, other):
    path = tmp_path / "faults.json"
    keep({"b": ONCE}, path, COMMIT)
    keep({"a": ONCE}, path, other)
    assert json.loads(path.read_text()) == {"commit": other, "a": ONCE}


def test_counts_without_a_commit_are_dropped(tmp_path):
    path = tmp_path / "faults.json"
    path.write_text(json.dumps({"b": ONCE}))
    keep({"a": ONCE}, path, COMMIT)
    assert json.loads(path.read_text()) == {"commit": COMMIT, "a": ONCE}
