"""Verdicts of one run beside those of another: which of them survive another generator of walks."""

from __future__ import annotations

import pandas as pd

from walklab.errors import InputError

COLUMNS = ("id", "section", "statement", "published", "ours", "verdict")


def beside(other: pd.DataFrame, own: pd.DataFrame) -> pd.DataFrame:
    """Both runs' value and verdict for every claim of either.

    Parameters
    ----------
    other, own : claims tables of both runs, with at least the columns id, section, statement, published, ours, verdict

    Returns
    -------
    DataFrame[id, section, statement, published, ours_other, ours, verdict_other, verdict, agrees], in the order of ``own``;
    a claim that one run lacks has NaN there and does not agree

    Raises
    ------
    InputError
        If a table lacks a column or both have no claim in common.
    """
    for name, table in (("other", other), ("own", own)):
        if missing := [column for column in COLUMNS if column not in table.columns]:
            raise InputError(
                f"compare_verdicts: the {name} claims lack the column {missing[0]}; check the claims of that run again"
            )
    if not set(other["id"]) & set(own["id"]):
        raise InputError("compare_verdicts: both runs have no claim in common; compare runs of the same paper")
    theirs = other[["id", "section", "statement", "published", "ours", "verdict"]]
    both = own[list(COLUMNS)].merge(theirs, on="id", how="outer", suffixes=("", "_other"), sort=False)
    for column in ("section", "statement", "published"):
        both[column] = both[column].where(both[column].notna(), both[f"{column}_other"])
    order = {claim: number for number, claim in enumerate([*own["id"], *other["id"]][::-1])}
    both = both.sort_values("id", key=lambda ids: -ids.map(order), kind="stable").reset_index(drop=True)
    both["agrees"] = both["verdict"] == both["verdict_other"]
    return both[["id", "section", "statement", "published", "ours_other", "ours", "verdict_other", "verdict", "agrees"]]
