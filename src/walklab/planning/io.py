"""Reading and writing routes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.storage import read_table, write_table

Array = NDArray[np.float64]

COLUMNS = ["walk", "x_m", "y_m"]


def write_routes(routes: Mapping[str, Array], path: str | Path) -> None:
    """Write planned polylines as one table: a row per corner, in walking order."""
    walks = np.repeat(np.array(list(routes), dtype=object), [len(route) for route in routes.values()])
    points = np.concatenate(list(routes.values())) if routes else np.empty((0, 2))
    write_table(pd.DataFrame({"walk": walks, "x_m": points[:, 0], "y_m": points[:, 1]}), path)


def read_routes(path: str | Path) -> dict[str, Array]:
    """Routes by walk id.

    Raises
    ------
    InputError
        If the table lacks a column or holds a value that is not finite.
    """
    table = read_table(path)
    if list(table.columns) != COLUMNS:
        raise InputError(f"{path}: columns are {list(table.columns)}, a table of routes has {COLUMNS}; plan the walks again")
    points = table[["x_m", "y_m"]].to_numpy(dtype=float)
    if not np.isfinite(points).all():
        row = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise InputError(f"{path}: row {row}: a corner is not finite; plan the walks again")
    return {str(walk): points[rows] for walk, rows in table.groupby("walk", sort=False).indices.items()}
