"""Forecast each participant's walks from everybody else's."""

from adapter import job
from map_inputs import all_maps, indexed_vectors, settings_of
from planner_inputs import planner_of
from walk_inputs import all_routes, all_walks
from walklab.evaluation.cross_validation import CrossValidationOptions, Study, leave_one_subject_out
from walklab.geometry.standing import Standing
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        maps = all_maps(files.maps)
        planner, space = planner_of(params.planner, params.space)
        # Run-time dependencies are always the planned ones; the captured ones would hand the answer over.
        vectors = indexed_vectors(maps.vectors, params.dependencies, index="planned").set_axis(list(maps.walks))
        study = Study(
            all_walks(files.walks, files.samples),
            all_routes(files.routes),
            vectors,
            maps.scores,
            planner,
            space,
            Standing(**params.standing),
        )
        options = CrossValidationOptions(
            time_limit_s=params.planner["time_limit_s"],
            metric=params.metric,
            static_starts=params.fit_static["starts"],
            static_maxfun=params.fit_static["evaluations"],
            bootstraps=params.statistics["bootstraps"],
        )
        settings = settings_of(params.blending_space, params.model)
        result = leave_one_subject_out(study, settings, options, params.seed, int(snakemake.wildcards.replicate))
        for name in ("predictions", "scores", "summary", "calibration"):
            write_table(getattr(result, name), snakemake.output[name])
