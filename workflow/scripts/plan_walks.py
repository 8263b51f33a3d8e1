"""Plan the route of every walk and derive its dependencies, planned and captured."""

import pandas as pd

from adapter import job
from planner_inputs import planner_of
from walklab.capture.walks import read_walks
from walklab.geometry.plans import load_plan
from walklab.geometry.scene import Body, Scene
from walklab.planning.io import write_routes
from walklab.steering.dependencies import dependency_vectors
from walklab.steering.routes import find_routes
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        walks = read_walks(snakemake.input.walks, snakemake.input.samples)
        scenes = {plan.scene.name: plan.scene for plan in map(load_plan, snakemake.input.plans)}
        planner, _ = planner_of(snakemake.params.planner, snakemake.params.space)
        routes = find_routes(walks, {"open": Scene("open"), **scenes}, planner, Body(**snakemake.params.body))
        write_routes(routes, snakemake.output.routes)

        wanted = snakemake.params.dependencies
        table = pd.DataFrame([walk.row for walk in walks])
        samples = {walk.row["walk"]: walk.position_m for walk in walks}
        vectors = [
            dependency_vectors(
                table,
                routes,
                wanted["names"],
                index,
                wanted["curvature_scale_m"],
                wanted["route_sigma_samples"],
                wanted["curvature"],
                samples,
            ).add_prefix(f"{index}_")
            for index in ("planned", "captured")
        ]
        write_table(pd.concat(vectors, axis=1).reset_index(), snakemake.output.vectors)
