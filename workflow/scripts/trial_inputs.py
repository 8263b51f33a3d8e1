"""What the scripts of the evaluation make of the files and parameters they share."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from planner_inputs import planner_of
from walklab.capture.walks import Walk, read_walks
from walklab.geometry.plans import load_plan
from walklab.geometry.scene import Scene
from walklab.geometry.standing import Standing
from walklab.planning.io import read_routes
from walklab.planning.protocol import Planner
from walklab.steering.dependencies import planned_vectors
from walklab.steering.space import ParameterSpace
from walklab.storage import read_table


@dataclass(frozen=True)
class TrialInputs:
    """The walks of a scenario, their routes and run-time dependencies, and the planner that re-simulates them."""

    walks: list[Walk]
    routes: dict[str, NDArray]
    vectors: NDArray
    planner: Planner
    space: ParameterSpace
    standing: Standing
    time_limit_s: float
    metric: str
    scenes: dict[str, Scene]
    seed: int
    replicate: int

    def arguments(self) -> dict[str, Any]:
        """All but the models, as ``simulate_trials`` takes them."""
        names = (
            "planner",
            "walks",
            "routes",
            "vectors",
            "standing",
            "time_limit_s",
            "metric",
            "seed",
            "replicate",
            "space",
            "scenes",
        )
        return {name: getattr(self, name) for name in names}


def trial_inputs(snakemake: Any) -> TrialInputs:
    """Read what the rule names. Run-time dependencies are always the planned ones (7.3)."""
    params, files = snakemake.params, snakemake.input
    planner, space = planner_of(params.planner, params.space)
    walks = read_walks(files.walks, files.samples)
    names = [walk.row["walk"] for walk in walks]
    vectors = planned_vectors(read_table(files.vectors), params.dependencies["names"], names)
    scene = load_plan(files.plan).scene
    return TrialInputs(
        walks,
        read_routes(files.routes),
        vectors,
        planner,
        space,
        Standing(**params.standing),
        params.planner["time_limit_s"],
        params.metric,
        {scene.name: scene},
        params.seed,
        int(snakemake.wildcards.get("replicate", 0)),
    )
