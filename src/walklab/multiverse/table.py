"""The specifications as a table, which a job reads its settings from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from walklab.capture.ranges import RANGES
from walklab.errors import InputError
from walklab.multiverse.choices import READINGS, Choices
from walklab.multiverse.specifications import Specification


def specification_table(found: Sequence[Specification]) -> pd.DataFrame:
    """DataFrame[specification, kind, changed, a column per ambiguity, ``place_<uncertainty>`` (NaN: own value)], a row each."""
    rows: list[dict[str, Any]] = []
    for one in found:
        row: dict[str, Any] = {"specification": one.name, "kind": one.kind, "changed": one.changed(found[0].choices)}
        row |= asdict(one.choices) | {f"place_{name}": one.positions.get(name, np.nan) for name in RANGES}
        rows.append(row)
    return pd.DataFrame(rows)


def specification_named(table: pd.DataFrame, name: str) -> Specification:
    """The specification of that name from :func:`specification_table`.

    Raises
    ------
    InputError
        If the table has not exactly one of that name.
    """
    rows = table[table["specification"] == name]
    if len(rows) != 1:
        raise InputError(f"specifications: {len(rows)} rows are called {name!r}, needed is one; list the specifications again")
    row = rows.iloc[0]
    values: dict[str, Any] = {key: row[key] for key in READINGS}
    values["braking"] = bool(values["braking"])
    positions = {key: float(row[f"place_{key}"]) for key in RANGES if np.isfinite(row[f"place_{key}"])}
    return Specification(name, str(row["kind"]), Choices(**values), positions)
