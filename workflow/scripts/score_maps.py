"""Re-simulate every walk with every parameter vector: one suitability map per walk."""

from adapter import job
from planner_inputs import planner_of
from walklab.capture.walks import read_walks
from walklab.geometry.standing import Standing
from walklab.planning.io import read_routes
from walklab.steering.dependencies import DEPENDENCIES
from walklab.steering.io import SuitabilityMaps, write_maps
from walklab.steering.metrics import metric_named
from walklab.steering.routes import pack
from walklab.steering.suitability import score_walks
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        walks = read_walks(snakemake.input.walks, snakemake.input.samples)
        planner, space = planner_of(snakemake.params.planner, snakemake.params.space)
        metric = metric_named(snakemake.params.metric, Standing(**snakemake.params.standing))
        batch = pack(walks, read_routes(snakemake.input.routes), planner)
        scores = score_walks(planner, batch, space.cells, metric, snakemake.params.planner["time_limit_s"])
        names = [walk.row["walk"] for walk in walks]
        vectors = read_table(snakemake.input.vectors).set_index("walk").loc[names].reset_index(drop=True)
        maps = SuitabilityMaps(
            tuple(names),
            tuple(walk.row["participant"] for walk in walks),
            scores,
            space,
            metric.name,
            metric.unit,
            vectors,
            {column: DEPENDENCIES[column.split("_", 1)[1]].unit for column in vectors},
        )
        write_maps(maps, snakemake.output.maps)
