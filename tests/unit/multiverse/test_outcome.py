"""Outcomes: a failure is one line and costs nobody else anything; the summary counts and compares."""

import numpy as np
import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.multiverse.choices import Choices
from walklab.multiverse.outcome import attempt, collect, failed
from walklab.multiverse.specifications import specifications
from walklab.multiverse.table import specification_table
from walklab.multiverse.verdicts import summary
from walklab.randomness import generator

LISTED = specifications(Choices(), 0, generator(1), vary=["weights", "start"])


def claims(index, ours, held):
    one = LISTED[index]
    row = {"specification": one.name, "kind": one.kind, "claim": "better", "statement": "it is", "ours": ours, "held": held}
    return pd.DataFrame([row])


def test_a_failure_is_told_in_one_line():
    assert failed(LISTED[1], InputError("no\nway"))["reason"] == "no way"
    assert failed(LISTED[1], ValueError("x is\n nothing"))["reason"] == "ValueError: x is nothing"
    assert failed(LISTED[1], KeyError())["reason"] == "KeyError: no message"


def test_a_failed_specification_is_listed_and_the_others_stay():
    outcomes = [{"specification": one.name, "outcome": "ran", "reason": ""} for one in LISTED]
    outcomes[2] = failed(LISTED[2], ValueError("no"))
    found = [claims(index, 0.1 * index, True) if index != 2 else pd.DataFrame() for index in range(len(LISTED))]
    every, table = collect(specification_table(LISTED), found, outcomes)
    assert list(table["specification"]) == [one.name for one in LISTED]
    assert table.loc[2, ["outcome", "reason"]].tolist() == ["failed", "ValueError: no"]
    assert len(every) == len(LISTED) - 1
    assert every["changed"].tolist() == ["", "weights: inverse", "start: 0.00 of its range", "start: 1.00 of its range"]


def test_if_none_could_be_run_the_first_reason_is_told():
    outcomes = [failed(one, InputError("no walks")) for one in LISTED]
    with pytest.raises(InputError, match=r"none of 5 specifications could be run; the first: no walks"):
        collect(specification_table(LISTED), [pd.DataFrame()] * 5, outcomes)


def test_the_summary_counts_and_names_what_moved_a_claim_most():
    values = [0.2, 0.3, -0.4, 0.1, 0.25]
    rows = pd.concat([claims(index, value, value > 0) for index, value in enumerate(values)], ignore_index=True)
    row = summary(rows).iloc[0]
    assert (row["specifications"], row["held"], row["held_share"]) == (5, 4, 0.8)
    assert (row["default"], row["smallest"], row["largest"], row["median"]) == (0.2, -0.4, 0.3, 0.2)
    assert (row["moved_most_by"], row["moved_to"]) == ("weights-uniform", -0.4)


def test_a_statement_without_a_value_is_counted_too():
    rows = pd.concat([claims(index, np.nan, index < 2) for index in range(3)], ignore_index=True)
    row = summary(rows).iloc[0]
    assert (row["held"], row["moved_most_by"]) == (2, "")


def test_whatever_goes_wrong_in_one_specification_ends_there():
    def broken():
        raise ZeroDivisionError("by\nnothing")

    rows, outcome = attempt(LISTED[3], broken)
    assert rows.empty
    assert outcome == {"specification": "start-low", "outcome": "failed", "reason": "ZeroDivisionError: by nothing"}
    assert attempt(LISTED[3], lambda: (claims(3, 1.0, True), {"outcome": "ran"}))[1] == {"outcome": "ran"}
