"""What the scripts that learn from or compare with the training walks read."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from map_inputs import all_maps, indexed_vectors
from planner_inputs import planner_of
from walk_inputs import all_routes, all_walks
from walklab.capture.walks import Walk
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.steering.io import SuitabilityMaps


@dataclass(frozen=True)
class TrainingInputs:
    """Training walks, routes, maps and run-time dependencies in one order."""

    walks: list[Walk]
    routes: dict[str, NDArray]
    maps: SuitabilityMaps
    vectors: NDArray
    planner: Planner
    standing: Standing


def training_inputs(snakemake: Any) -> TrainingInputs:
    """Read what the rule names. Run-time dependencies are always the planned ones (7.3)."""
    params, files = snakemake.params, snakemake.input
    maps = all_maps(files.maps)
    planner, _ = planner_of(params.planner, params.space)
    return TrainingInputs(
        all_walks(files.training_walks, files.training_samples),
        all_routes(files.training_routes),
        maps,
        indexed_vectors(maps.vectors, params.dependencies, index="planned").to_numpy(dtype=float),
        planner,
        Standing(**params.standing),
    )
