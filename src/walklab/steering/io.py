"""Reading and writing the products of this room: maps, blending space, model, static fit.

All numbers stay float64 (bounds of the interpolant: float32, rounded up), so that a run that
reads its own files computes what it would have computed without them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.model_file import read_model, write_model
from walklab.steering.scaling import Scaling
from walklab.steering.space import Axis, ParameterSpace
from walklab.steering.static_fit import StaticFit
from walklab.storage import read_dataset, read_json, write_dataset, write_json

__all__ = [
    "SuitabilityMaps",
    "concatenate_maps",
    "read_blending_space",
    "read_maps",
    "read_model",
    "read_static_fit",
    "write_blending_space",
    "write_maps",
    "write_model",
    "write_static_fit",
]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SuitabilityMaps:
    """Raw scores of walks over a parameter space, with what describes the walks.

    Attributes
    ----------
    walks, participants : (W,) ids
    scores : (W, C) metric, smaller is better
    space : the C cells
    metric, metric_unit : what was measured
    vectors : (W, n) dependencies, one row per walk; any columns, e.g. planned_length and captured_length
    units : unit of each column of ``vectors``
    """

    walks: tuple[str, ...]
    participants: tuple[str, ...]
    scores: Array
    space: ParameterSpace
    metric: str
    metric_unit: str
    vectors: pd.DataFrame
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        counts = {len(self.walks), len(self.participants), len(self.scores), len(self.vectors)}
        if len(counts) != 1 or self.scores.shape[1] != len(self.space.cells):
            raise InputError(f"maps: {sorted(counts)} walks or {self.scores.shape} scores do not fit; score the walks again")


def concatenate_maps(parts: Sequence[SuitabilityMaps]) -> SuitabilityMaps:
    """Maps of several shards as one, in the order given.

    Raises
    ------
    InputError
        If they were made with different spaces, metrics or dependencies.
    """
    first = parts[0]
    for part in parts[1:]:
        if (part.space, part.metric, tuple(part.vectors)) != (first.space, first.metric, tuple(first.vectors)):
            raise InputError("maps: the shards differ in parameter space, metric or dependencies; score all walks again")
    return SuitabilityMaps(
        tuple(walk for part in parts for walk in part.walks),
        tuple(person for part in parts for person in part.participants),
        np.concatenate([part.scores for part in parts]),
        first.space,
        first.metric,
        first.metric_unit,
        pd.concat([part.vectors for part in parts], ignore_index=True),
        first.units,
    )


def write_maps(maps: SuitabilityMaps, path: str | Path) -> None:
    """NetCDF: variable ``score`` over (walk, one dimension per parameter); dependencies are coordinates of ``walk``."""
    import xarray as xr  # late: a process that only samples must not pay for this import

    coordinates: dict[str, Any] = {axis.name: (axis.name, list(axis.values), {"units": axis.unit}) for axis in maps.space.axes}
    coordinates |= {"walk": ("walk", np.array(maps.walks, dtype=object))}
    coordinates |= {"participant": ("walk", np.array(maps.participants, dtype=object))}
    for name in maps.vectors:
        attributes = {"units": maps.units.get(str(name), ""), "role": "dependency"}
        coordinates[str(name)] = ("walk", maps.vectors[name].to_numpy(dtype=float), attributes)
    values = maps.scores.reshape(len(maps.walks), *maps.space.shape)
    score = (("walk", *maps.space.names), values, {"units": maps.metric_unit, "metric": maps.metric})
    write_dataset(xr.Dataset({"score": score}, coordinates), path)


def read_maps(path: str | Path) -> SuitabilityMaps:
    """Maps written by :func:`write_maps`; InputError for any other file."""
    dataset = read_dataset(path)
    try:
        score = dataset["score"]
        space = _space_from(dataset, score.dims[1:])
        names = [str(name) for name, values in dataset.coords.items() if values.attrs.get("role") == "dependency"]
        # The order of coordinates in a file is not kept by every reader; dependencies are sorted to be sure.
        vectors = pd.DataFrame({name: dataset[name].to_numpy() for name in sorted(names)}, index=range(len(score)))
        return SuitabilityMaps(
            tuple(str(walk) for walk in dataset["walk"].to_numpy()),
            tuple(str(person) for person in dataset["participant"].to_numpy()),
            score.to_numpy().reshape(len(score), -1),
            space,
            score.attrs["metric"],
            score.attrs["units"],
            vectors,
            {name: dataset[name].attrs["units"] for name in sorted(names)},
        )
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(f"{path}: not a file of suitability maps ({error}); score the walks again") from error


def _space_from(dataset: Any, names: Sequence[Any]) -> ParameterSpace:
    columns = ((str(name), dataset[name]) for name in names)
    return ParameterSpace(tuple(Axis(name, c.attrs["units"], tuple(float(v) for v in c.to_numpy())) for name, c in columns))


def write_blending_space(blending: BlendingSpace, space: ParameterSpace, path: str | Path) -> None:
    """NetCDF: suitability over (entry, one dimension per parameter), vectors, scaling, parents and their weights."""
    import xarray as xr

    coordinates: dict[str, Any] = {axis.name: (axis.name, list(axis.values), {"units": axis.unit}) for axis in space.axes}
    coordinates["dependency"] = ("dependency", np.array(blending.names, dtype=object))
    coordinates["unit"] = ("dependency", np.array(blending.units, dtype=object))
    values = blending.maps.reshape(len(blending), *space.shape)
    dataset = xr.Dataset(
        {
            "suitability": (("entry", *space.names), values, {"units": "1"}),
            "vector": (("entry", "dependency"), blending.vectors),
            "offset": ("dependency", blending.scaling.offset),
            "scale": ("dependency", blending.scaling.scale),
            "parent": (("entry", "part"), blending.parents),
            "parent_weight": (("entry", "part"), blending.parent_weights),
        },
        coordinates,
    )
    write_dataset(dataset, path)


def read_blending_space(path: str | Path) -> tuple[BlendingSpace, ParameterSpace]:
    """Blending space and its parameter space; InputError for a file that is none."""
    dataset = read_dataset(path)
    try:
        suitability = dataset["suitability"]
        blending = BlendingSpace(
            tuple(str(name) for name in dataset["dependency"].to_numpy()),
            tuple(str(unit) for unit in dataset["unit"].to_numpy()),
            dataset["vector"].to_numpy(),
            Scaling(dataset["offset"].to_numpy(), dataset["scale"].to_numpy()),
            suitability.to_numpy().reshape(len(suitability), -1),
            dataset["parent"].to_numpy(),
            dataset["parent_weight"].to_numpy(),
        )
        return blending, _space_from(dataset, suitability.dims[1:])
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(f"{path}: not a blending space ({error}); build it again") from error


def write_static_fit(fit: StaticFit, path: str | Path) -> None:
    """JSON of all fields."""
    write_json({"format": "walklab static fit", "version": 1, **asdict(fit)}, path)


def read_static_fit(path: str | Path) -> StaticFit:
    """Static fit written by :func:`write_static_fit`; InputError for any other file."""
    content = read_json(path)
    try:
        if content.pop("format") != "walklab static fit" or content.pop("version") != 1:
            raise ValueError("another format or version")
        fields: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in content.items()}
        return StaticFit(**fields)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: not a static fit ({error}); fit it again") from error
