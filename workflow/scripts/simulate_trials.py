"""Simulate every walk of a scenario with the three motion models, P_Prob as the paper reads it and with learned sharpness."""

from adapter import job
from trial_inputs import trial_inputs
from walklab.evaluation.calibration_files import read_calibration
from walklab.evaluation.trials import simulate_trials
from walklab.steering.io import read_model, read_static_fit
from walklab.steering.learned import CalibratedModel
from walklab.steering.models import AdaptiveModel, StaticModel
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        inputs = trial_inputs(snakemake)
        model = read_model(snakemake.input.model)
        static = read_static_fit(snakemake.input.static)
        models = {"P_Stat": StaticModel(static.names, static.optimum), "P_Adapt": AdaptiveModel(model), "P_Prob": model}
        models["P_Prob (calibrated)"] = CalibratedModel(model, read_calibration(snakemake.input.calibration).law)
        inside = model.inside(inputs.vectors)
        write_table(simulate_trials(models, **inputs.arguments(), inside=inside), snakemake.output.trials)
