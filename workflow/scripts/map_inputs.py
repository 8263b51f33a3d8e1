"""What the training scripts make of the suitability maps and their parameters."""

from collections.abc import Iterable, Mapping
from typing import Any

import pandas as pd

from walklab.steering.io import SuitabilityMaps, concatenate_maps, read_maps
from walklab.steering.training import TrainingSettings


def all_maps(paths: Iterable[str]) -> SuitabilityMaps:
    """The maps of all shards, in the order of the walks' names, so that shards leave no trace."""
    maps = concatenate_maps([read_maps(path) for path in paths])
    order = sorted(range(len(maps.walks)), key=maps.walks.__getitem__)
    return SuitabilityMaps(
        tuple(maps.walks[i] for i in order),
        tuple(maps.participants[i] for i in order),
        maps.scores[order],
        maps.space,
        maps.metric,
        maps.metric_unit,
        maps.vectors.iloc[order].reset_index(drop=True),
        maps.units,
    )


def indexed_vectors(vectors: pd.DataFrame, dependencies: Mapping[str, Any], index: str | None = None) -> pd.DataFrame:
    """The dependency vectors of one index (that of the configuration, or the one named), columns by dependency."""
    prefix = index or dependencies["index"]
    return vectors[[f"{prefix}_{name}" for name in dependencies["names"]]].set_axis(dependencies["names"], axis=1)


def settings_of(blending_space: Mapping[str, Any], model: Mapping[str, Any] | None = None) -> TrainingSettings:
    """The choices of the blending space, and of the model where one is made of it."""
    space = {"count": blending_space["entries"], **{key: value for key, value in blending_space.items() if key != "entries"}}
    return TrainingSettings(**space, **(model or {}))
