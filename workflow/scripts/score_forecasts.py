"""Score all forecasts of the held-out scenarios by proper scores."""

import pandas as pd

from adapter import job
from calibration_inputs import training_inputs
from walklab.capture.walks import read_walks
from walklab.evaluation.calibration import CANDIDATES
from walklab.evaluation.calibration_files import read_calibration
from walklab.evaluation.forecasts import by_exponent
from walklab.evaluation.scenario_forecasts import Learned, asked_walks, forecast_scenario, known_walks
from walklab.evaluation.score_tables import calibration_table, score_table, walk_scores
from walklab.evaluation.sharpness_law import law_table
from walklab.planning.io import read_routes
from walklab.randomness import generator
from walklab.steering.io import read_model
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        training = training_inputs(snakemake)
        known = known_walks(
            training.walks,
            training.routes,
            training.vectors,
            training.maps.scores,
            read_table(files.residuals),
            params.blending_space["normalisation"],
        )
        learned = Learned(
            read_model(files.model),
            read_calibration(files.calibration),
            known,
            training.planner,
            training.standing,
            params.planner["time_limit_s"],
            params.metric,
        )
        seed, replicate = params.seed, int(snakemake.wildcards.replicate)
        rows, curves_found = [], []
        for index, scenario in enumerate(params.scenarios):
            # The names of the walks give the order in which a person walked them.
            walks = sorted(read_walks(files.walks[index], files.samples[index]), key=lambda walk: walk.row["walk"])
            routes = read_routes(files.routes[index])
            asked = asked_walks(walks, routes, read_table(files.vectors[index]), read_table(files.trials[index]), learned)
            inside = learned.model.inside(asked.vectors)
            names = [walk.row["walk"] for walk in walks]
            identity = pd.DataFrame({"walk": names, "participant": asked.participants, "inside_hull": inside})
            forecasts = forecast_scenario(walks, routes, asked, learned, seed, replicate)
            scored = walk_scores(asked.captured_s, forecasts, identity)
            rows.append(scored.assign(scenario=scenario))
            curves_found.append(by_exponent(asked, CANDIDATES["exponent"], learned.volumes).assign(scenario=scenario))
            del asked  # the traces of one scenario are enough to hold
        rows = pd.concat(rows, ignore_index=True)
        write_table(rows, snakemake.output.predictions)
        rng = generator(seed, replicate, "score_forecasts")
        write_table(score_table(rows, rng, params.statistics["bootstraps"]), snakemake.output.scores)
        law, people = learned.calibration.law, len(set(known.participants))
        chosen = law_table(read_table(files.candidates), law, learned.model.dependencies, known.vectors, people)
        exponents = pd.concat(curves_found, ignore_index=True).rename(columns={"value": "at", "crps_s": "value"})
        exponents = exponents.assign(model="P_Prob", quantity="crps_by_exponent")
        calibrated = pd.concat([calibration_table(rows), chosen, exponents], ignore_index=True)
        write_table(calibrated[["scenario", "model", "quantity", "at", "value"]], snakemake.output.calibration)
