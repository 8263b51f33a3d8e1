"""Vary the number of neighbours: error and time (8.2)."""

import pandas as pd

from adapter import job
from trial_inputs import trial_inputs
from walklab.evaluation.calibration_files import read_calibration
from walklab.evaluation.neighbours import models_by_neighbours, neighbour_table, neighbour_trials, time_neighbours
from walklab.evaluation.trials import simulate_trials
from walklab.randomness import generator
from walklab.steering.io import read_model
from walklab.steering.learned import CalibratedModel
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        inputs, params = trial_inputs(snakemake), snakemake.params
        model = read_model(snakemake.input.model)
        inside = model.inside(inputs.vectors)
        models = models_by_neighbours(model, params.sweep_neighbours["k"])
        law = read_calibration(snakemake.input.calibration).law

        def tabled(variants):
            trials = neighbour_trials(variants, lambda named: simulate_trials(named, **inputs.arguments(), inside=inside))
            rng = generator(inputs.seed, inputs.replicate, "sweep_neighbours")
            return trials, neighbour_table(trials, rng, params.statistics["bootstraps"])

        trials, errors = tabled(models)
        write_table(pd.concat([trial.assign(k=k) for k, trial in trials.items()], ignore_index=True), snakemake.output.trials)
        write_table(errors, snakemake.output.errors)
        calibrated = {k: CalibratedModel(variant, law) for k, variant in models.items()}
        write_table(tabled(calibrated)[1], snakemake.output.calibrated)
        write_table(time_neighbours(models, inputs.vectors, inputs.seed), snakemake.output.timings)
