"""Fit P_Stat: the steering parameters that suit all training walks best."""

from adapter import job
from map_inputs import all_maps
from planner_inputs import planner_of
from walk_inputs import all_routes, all_walks
from walklab.evaluation.optimum import optimum_table
from walklab.geometry.standing import Standing
from walklab.randomness import generator
from walklab.steering.io import write_static_fit
from walklab.steering.metrics import metric_named
from walklab.steering.routes import pack
from walklab.steering.static_fit import fit_static
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        planner, space = planner_of(params.planner, params.space)
        walks = all_walks(snakemake.input.walks, snakemake.input.samples)
        maps = all_maps(snakemake.input.maps)
        names = (params.seed, int(snakemake.wildcards.replicate), "fit_static")
        fit = fit_static(
            planner,
            pack(walks, all_routes(snakemake.input.routes), planner),
            space,
            generator(*names),
            scores=maps.scores,
            metric=metric_named(params.metric, Standing(**params.standing)),
            starts=params.fit_static["starts"],
            maxfun=params.fit_static["evaluations"],
            checks=params.fit_static["checks"],
            time_limit_s=params.planner["time_limit_s"],
        )
        write_static_fit(fit, snakemake.output.static)
        rng = generator(*names, "bootstrap")
        resamples = params.statistics["bootstraps"]
        table = optimum_table(fit.optimum, fit.on_edge, fit.spread, maps.scores, maps.participants, space, rng, resamples)
        write_table(table, snakemake.output.optimum)
