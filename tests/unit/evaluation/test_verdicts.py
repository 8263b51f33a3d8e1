"""Verdicts of two runs side by side."""

from __future__ import annotations

import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.evaluation.verdicts import beside


def claims(*rows: tuple[str, float, str]) -> pd.DataFrame:
    table = pd.DataFrame(rows, columns=["id", "ours", "verdict"])
    return table.assign(section="7.4", statement="says " + table["id"], published=1.0)


def test_claims_of_either_run_are_there_once() -> None:
    other = claims(("a", 1.0, "reproduced"), ("b", 2.0, "partly"), ("old", 3.0, "partly"))
    own = claims(("b", 4.0, "partly"), ("a", 5.0, "not reproduced"), ("new", 6.0, "reproduced"))
    table = beside(other, own).set_index("id")
    assert sorted(table.index) == ["a", "b", "new", "old"]
    assert [name for name in table.index if name != "old"] == ["b", "a", "new"]
    assert table["agrees"].to_dict() == {"b": True, "a": False, "new": False, "old": False}
    assert (table.loc["a", "ours_other"], table.loc["a", "ours"]) == (1.0, 5.0)
    assert table.loc["old", "statement"] == "says old"


def test_tables_that_are_no_claims_are_refused() -> None:
    one = claims(("a", 1.0, "partly"))
    with pytest.raises(InputError, match="column verdict"):
        beside(one, one.drop(columns="verdict"))
    with pytest.raises(InputError, match="no claim in common"):
        beside(one, claims(("b", 1.0, "partly")))
