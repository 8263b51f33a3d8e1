"""Two models' errors on the same walks, side by side."""

from __future__ import annotations

import pandas as pd

from walklab.errors import InputError

PAIRS = (("P_Stat", "P_Adapt"), ("P_Adapt", "P_Prob"), ("P_Stat", "P_Prob"))


def paired(trials: pd.DataFrame, first: str, second: str, column: str = "abs_dt_s") -> pd.DataFrame:
    """The errors of two models side by side: DataFrame[walk, participant, first, second].

    Raises
    ------
    InputError
        If a model is missing or a walk was simulated by only one of them.
    """
    table = trials.pivot_table(index=["walk", "participant"], columns="model", values=column, sort=True)
    if absent := {first, second} - set(table.columns):
        raise InputError(f"trials: model {sorted(absent)[0]} has no rows; simulate it first")
    chosen = table[[first, second]]
    if chosen.isna().any(axis=None):
        walk = chosen.index[chosen.isna().any(axis=1)][0][0]
        raise InputError(f"trials: walk {walk} was not simulated by both {first} and {second}; simulate the trials again")
    return chosen.set_axis(["first", "second"], axis=1).reset_index()
