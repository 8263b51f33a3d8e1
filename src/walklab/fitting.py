"""A motion model from one table of walks, in one call: the study's chain with its defaults, without its DAG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from walklab.capture.own import OwnColumns, import_walks
from walklab.capture.walks import ACCEPTED, Walk, pair
from walklab.errors import InputError
from walklab.geometry.scene import Body, Scene
from walklab.planning.registry import make_planner
from walklab.steering.dependencies import dependency_vectors
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.routes import find_routes, pack
from walklab.steering.space import ParameterSpace, space_from_config
from walklab.steering.suitability import score_walks
from walklab.steering.training import TrainingSettings, train

# Agethen et al. 2017, eq. 6-9.
_AXIS = {"start": 0.1, "step": 0.21, "count": 10}
PAPER_SPACE = [{"name": name, "unit": unit, **_AXIS} for name, unit in (("v", "m/s"), ("a", "m/s²"), ("omega", "1/m"))]
STEP_S = 1 / 60
ROUNDING = 1e-9  # the curvature of a straight path comes out as 1e-17 or so, which would be shown as a range of training
DEPENDENCIES = ("length", "curvature", "height")


def fit_walks(
    path: str | Path,
    columns: OwnColumns | None = None,
    *,
    length_unit: str = "m",
    height_unit: str | None = None,
    time_unit: str = "s",
    rate_hz: float | None = None,
    scenes: Mapping[str, Scene] | None = None,
    dependencies: Sequence[str] = DEPENDENCIES,
    space: ParameterSpace | None = None,
    settings: TrainingSettings | None = None,
    seed: int = 0,
) -> ProbabilisticModel:
    """Train a model on a CSV or Parquet table of positions over time; the table is described in ``docs/own-walks.md``.

    Parameters
    ----------
    columns, length_unit, height_unit, time_unit, rate_hz : how to read the table
    scenes : name -> plan view, for tables with a scene column
    dependencies : which, in this order
    space : grid of steering parameters; default the paper's 10 x 10 x 10 of v, a and omega
    settings : of the model; default those of the study without up-sampling. k is lowered to the number of maps if these are fewer
    seed : of the up-sampling of the blending space

    Raises
    ------
    InputError
        If the table cannot be read, or the walks are too few.
    """
    table, samples = import_walks(path, columns, length_unit, time_unit, rate_hz, height_unit=height_unit)
    walks = _accepted(table, samples, path)
    grid = space_from_config(PAPER_SPACE) if space is None else space
    planner = make_planner("path_following", grid.names, STEP_S)
    routes = find_routes(walks, {"open": Scene("open"), **(scenes or {})}, planner, Body())
    scores = score_walks(planner, pack(walks, routes, planner), grid.cells)
    rows = pd.DataFrame([walk.row for walk in walks])
    vectors = dependency_vectors(rows, routes, dependencies).reset_index(drop=True)
    vectors = vectors.mask(vectors.abs() < ROUNDING, 0.0)
    chosen = TrainingSettings(count=None) if settings is None else settings
    chosen = replace(chosen, k=min(chosen.k, chosen.count or len(walks)))
    people = rows["participant"].tolist()
    provenance = {"source": Path(path).name, "walks": len(walks), "participants": len(set(people)), "seed": seed}
    return train(scores, vectors, people, grid, chosen, np.random.default_rng(seed), provenance=provenance)


def _accepted(table: pd.DataFrame, samples: pd.DataFrame, path: str | Path) -> list[Walk]:
    accepted = int((table["rejection"] == ACCEPTED).sum())
    if accepted < 2:
        raise InputError(f"{accepted} walks were accepted; a model needs at least 2")
    return pair(table, samples, path)
