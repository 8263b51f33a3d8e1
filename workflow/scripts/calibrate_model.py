"""Learn how sharp the density has to be from the training walks alone."""

import numpy as np
import pandas as pd

from adapter import job
from calibration_inputs import training_inputs
from walklab.evaluation.calibration import choose_walks, evidence_of, learn_calibration
from walklab.evaluation.calibration_files import write_calibration
from walklab.evaluation.simulated_times import travel_times
from walklab.randomness import generator
from walklab.steering.interpolation import interpolant_named
from walklab.steering.io import read_blending_space, read_static_fit
from walklab.steering.modes import highest_points
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        known = training_inputs(snakemake)
        blending, space = read_blending_space(files.space)
        rng = generator(params.seed, int(snakemake.wildcards.replicate), "calibrate_model")
        asked = choose_walks(known.maps.participants, params.calibrate_model["walks_per_participant"], rng)
        model, follow = params.model, (known.standing, params.planner["time_limit_s"])
        evidence = evidence_of(
            known.walks,
            known.routes,
            known.vectors,
            known.maps.scores,
            params.blending_space["normalisation"],
            blending,
            asked,
            known.planner,
            space,
            *follow,
            model["k"],
            model["weights"],
            params.blending_space["scaling"],
        )
        calibration, table = learn_calibration(evidence)
        write_table(table, snakemake.output.candidates)
        write_calibration(calibration, snakemake.output.calibration)
        # What P_Stat and P_Adapt are off by on training walks is their spread as forecasts.
        grid = interpolant_named(model["basis"], space.shape, model["kernel"], model["epsilon"])
        adaptive = space.from_unit(
            highest_points(grid, grid.coefficients(evidence.suitability), *space.to_unit(space.bounds.T))[0]
        )
        static = np.tile(read_static_fit(files.static).optimum, (len(asked), 1))
        walks = [known.walks[row] for row in asked]
        residuals = pd.DataFrame({"walk": [str(walk.row["walk"]) for walk in walks], "participant": evidence.participants})
        for name, parameters in (("static", static), ("adaptive", adaptive)):
            times_s = travel_times(known.planner, walks, known.routes, parameters, *follow)
            residuals[f"{name}_residual_s"] = evidence.captured_s - times_s
        write_table(residuals, snakemake.output.residuals)
