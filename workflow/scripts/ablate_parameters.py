"""Take each dependency and each steering parameter away and see what it contributed (8.1)."""

from adapter import job
from map_inputs import all_maps, indexed_vectors, settings_of
from trial_inputs import trial_inputs
from walk_inputs import all_routes, all_walks
from walklab.evaluation.ablations import ablated_models, ablation_table, calibrated_variants
from walklab.evaluation.calibration_files import read_calibration
from walklab.evaluation.trials import simulate_trials
from walklab.randomness import generator
from walklab.steering.io import read_model, read_static_fit
from walklab.steering.metrics import metric_named
from walklab.steering.routes import pack
from walklab.steering.suitability import score_walks
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        inputs, params, files = trial_inputs(snakemake), snakemake.params, snakemake.input
        maps = all_maps(files.maps)
        vectors = indexed_vectors(maps.vectors, params.dependencies)
        batch = pack(all_walks(files.training_walks, files.training_samples), all_routes(files.training_routes), inputs.planner)
        settings = settings_of(params.blending_space, params.model)
        middle = dict(zip(inputs.space.names, inputs.space.bounds.mean(axis=1), strict=True))
        static = read_static_fit(files.static)
        held = middle if params.ablate_parameters["fixed"] == "middle" else dict(zip(static.names, static.optimum, strict=True))

        def score(cells):
            return score_walks(inputs.planner, batch, cells, metric_named(inputs.metric, inputs.standing), inputs.time_limit_s)

        models = ablated_models(
            maps.scores, vectors, maps.participants, inputs.space, settings, score, held, inputs.seed, inputs.replicate
        )
        full = read_model(files.model)
        models = {"full": full, **models}

        def tabled(variants):
            trials = simulate_trials(variants, **inputs.arguments(), inside=full.inside(inputs.vectors), stream="P_Prob")
            rng = generator(inputs.seed, inputs.replicate, "ablate_parameters")
            return trials, ablation_table(trials, rng, held, params.statistics["bootstraps"])

        trials, table = tabled(models)
        write_table(trials, snakemake.output.trials)
        write_table(table, snakemake.output.ablations)
        calibrated = calibrated_variants(models, read_calibration(files.calibration).law)
        write_table(tabled(calibrated)[1], snakemake.output.calibrated)
