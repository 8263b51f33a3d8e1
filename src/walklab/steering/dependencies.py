"""Dependencies ``d`` of a walk: what is known before it is walked (sections 4.4 and 7.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry import curves
from walklab.steering.domain import DomainOfValidity, fit_domain
from walklab.steering.scaling import Scaling, fit_scaling

__all__ = [
    "DEPENDENCIES",
    "Dependency",
    "DomainOfValidity",
    "Scaling",
    "dependency_vectors",
    "fit_domain",
    "fit_scaling",
    "planned_vectors",
    "smoothed_route",
]

Array = NDArray[np.float64]
Index = Literal["planned", "captured"]
CurvatureKind = Literal["mean", "sample_sum"]


@dataclass(frozen=True)
class Dependency:
    """One dependency.

    Attributes
    ----------
    name, unit : what results call it
    column : where the walks table keeps its captured value
    of_the_path : whether its run-time value is computed from the planned route
    minimum : smallest value that is physically possible
    """

    name: str
    unit: str
    column: str
    of_the_path: bool
    minimum: float = 0.0


DEPENDENCIES: dict[str, Dependency] = {
    dependency.name: dependency
    for dependency in (
        Dependency("length", "m", "length_m", of_the_path=True),
        Dependency("curvature", "1/m", "curvature_1_m", of_the_path=True),
        Dependency("height", "m", "height_m", of_the_path=False),
        Dependency("start_speed", "m/s", "start_speed_m_s", of_the_path=False),
    )
}


def dependency_vectors(
    walks: pd.DataFrame,
    routes: Mapping[str, Array] | None,
    names: Sequence[str],
    index: Index = "planned",
    curvature_scale_m: float = 0.1,
    route_sigma: float = 2.0,
    curvature: CurvatureKind = "mean",
    samples: Mapping[str, Array] | None = None,
) -> pd.DataFrame:
    """Dependency vectors of walks.

    ``index="planned"`` gives run-time vectors: of the walk they read its id, the person's height
    and the task's start speed, and the planned route; nothing of how it was walked.

    Parameters
    ----------
    walks : walks table
    routes : walk id -> planned polyline (n, 2), metres; None only for ``index="captured"``
    names : which dependencies, in this order
    index : of the planned route, or of the captured path (the paper's reading for training)
    curvature_scale_m : smoothing of the curvature, the same as for the captured paths
    route_sigma : Gaussian smoothing of the planned route, in its samples of 1 cm (section 7.3: 2)
    curvature : ``mean`` is ``(1/l) integral |kappa| ds`` (1/m); ``sample_sum`` is ``sum |c_i| / l``
        over samples, section 4.4 to the letter
    samples : walk id -> captured positions (n, 2); only for captured sample-sum curvature

    Returns
    -------
    DataFrame, one row per walk, indexed by walk id; columns ``names``

    Raises
    ------
    InputError
        If a dependency, a column or a route is missing.
    """
    for name in names:
        if name not in DEPENDENCIES:
            raise InputError(f"dependencies: there is no {name!r}; choose from {', '.join(DEPENDENCIES)}")
    chosen = [DEPENDENCIES[name] for name in names]
    columns: dict[str, Array] = {d.name: _column(walks, d.column) for d in chosen if index == "captured" or not d.of_the_path}
    if index == "captured" and curvature == "sample_sum" and "curvature" in columns:
        paths = _paths_of(walks, samples, "samples")
        columns["curvature"] = np.array([curves.sample_sum_curvature(path) for path in paths])
    elif index == "planned" and any(d.of_the_path for d in chosen):
        paths = [smoothed_route(route, route_sigma) for route in _paths_of(walks, routes, "routes")]
        columns["length"] = np.array([curves.length(path) for path in paths])
        if "curvature" in names:
            columns["curvature"] = np.array([_curvature(path, curvature, curvature_scale_m) for path in paths])
    return pd.DataFrame({name: columns[name] for name in names}, index=pd.Index(walks["walk"], name="walk"), dtype=float)


def planned_vectors(table: pd.DataFrame, names: Sequence[str], walks: Sequence[str]) -> Array:
    """(W, D) run-time vectors of some walks, in the order asked for: the planned ones, also where a table holds both.

    Parameters
    ----------
    table : DataFrame[walk, planned_<name>, captured_<name>]
    """
    return table.set_index("walk").loc[list(walks), [f"planned_{name}" for name in names]].to_numpy(dtype=float)


def smoothed_route(route_m: Array, sigma_samples: float = 2.0) -> Array:
    """The planned route every 1 cm, smoothed as section 7.3 says (``gaussian_filter1d``, sigma 2)."""
    # ASSUME: Section 7.3 does not say on which samples of the route sigma = 2 acts; points every 1 cm are taken, the
    # cell of the planning grid, since a route of Lazy Theta* has no other natural sampling.
    return curves.smooth(curves.resample(np.asarray(route_m, dtype=float)), sigma_samples)


def _curvature(path_m: Array, kind: CurvatureKind, scale_m: float) -> float:
    if kind == "sample_sum":
        return curves.sample_sum_curvature(path_m)
    return curves.mean_curvature(path_m, scale_m)


def _column(walks: pd.DataFrame, column: str) -> Array:
    if column not in walks:
        raise InputError(f"walks table: column {column} is missing; extract the walks again")
    return walks[column].to_numpy(dtype=float)


def _paths_of(walks: pd.DataFrame, paths: Mapping[str, Array] | None, what: str) -> list[Array]:
    missing = [walk for walk in walks["walk"] if paths is None or walk not in paths]
    if paths is None or missing:
        raise InputError(f"{what}: walk {missing[0] if missing else '(any)'} has none; plan or extract it first")
    return [paths[walk] for walk in walks["walk"]]
