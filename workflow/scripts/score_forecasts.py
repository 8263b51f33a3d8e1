"""Score all forecasts of the held-out scenarios by proper scores."""

from dataclasses import replace

import numpy as np
import pandas as pd

from adapter import job
from calibration_inputs import training_inputs
from map_inputs import indexed_vectors
from walklab.capture.walks import read_walks
from walklab.evaluation.calibration import CANDIDATES
from walklab.evaluation.calibration_files import read_calibration
from walklab.evaluation.forecasts import Asked, Known, all_forecasts, by_exponent, effects_before, sharpened
from walklab.evaluation.grid_scores import captured_distances
from walklab.evaluation.score_tables import calibration_table, score_table, walk_scores
from walklab.evaluation.tracing import drawn_energy, trace_walks
from walklab.geometry import curves
from walklab.planning.io import read_routes
from walklab.randomness import generator
from walklab.steering.io import read_model
from walklab.steering.learned import ExtendedModel
from walklab.steering.routes import pack
from walklab.steering.sharpness import cell_volumes
from walklab.steering.suitability import normalise, score_walks
from walklab.storage import read_table, write_table

DRAWS = 8  # of P_Prob (extended) per walk; the energy score of so many is without bias, if not without noise


def route_lengths(walks, routes):
    """(W,) lengths of the planned routes."""
    return np.array([curves.length(routes[str(walk.row["walk"])]) for walk in walks])


def known_walks(training, residuals, normalisation):
    """The training walks as the baselines see them."""
    few = np.flatnonzero(np.isin(training.maps.walks, residuals["walk"]))
    return Known(
        np.array([float(walk.row["duration_s"]) for walk in training.walks]),
        route_lengths(training.walks, training.routes),
        training.vectors,
        training.maps.participants,
        few,
        residuals["static_residual_s"].to_numpy(),
        residuals["adaptive_residual_s"].to_numpy(),
        normalise(training.maps.scores, normalisation).mean(axis=0),
    )


def asked_walks(training, walks, routes, vectors, model, paced, trials, params):
    """The walks of a scenario with what their forecasts need."""
    follow = (training.standing, params.planner["time_limit_s"])
    traces, places = trace_walks(walks, routes, training.planner, model.space, *follow)
    # The oracle alone reads the captured walks.
    own = score_walks(training.planner, pack(walks, routes, training.planner), model.space.cells, params.metric, follow[1])
    names = [walk.row["walk"] for walk in walks]
    times_s = [trials[trials["model"] == name].set_index("walk").loc[names, "simulated_s"] for name in ("P_Stat", "P_Adapt")]
    return Asked(
        np.array([float(walk.row["duration_s"]) for walk in walks]),
        route_lengths(walks, routes),
        vectors,
        [str(walk.row["participant"]) for walk in walks],
        model.blend(vectors),
        paced.density_model().blend(vectors),
        *(values.to_numpy() for values in times_s),
        traces.travel_s[np.arange(len(walks)), own.argmin(axis=1)].astype(float),
        traces,
        captured_distances(traces, places),
    )


def with_trajectories(forecasts, asked, walks, routes, paced, planner, time_limit_s, names):
    """The forecasts, P_Prob (extended) with the energy score of what its public model draws."""
    volumes = cell_volumes(paced.model.space)
    density = sharpened(asked.paced_suitability, paced.pace.exponent, volumes)
    found = dict(forecasts)
    for model, effect in effects_before(paced.pace, asked, density).items():
        rngs = [generator(*names, model, str(walk.row["walk"])) for walk in walks]
        drawn = paced.sample_batch(asked.vectors, DRAWS, rngs, effect)
        energy_m = drawn_energy(walks, routes, planner, drawn, time_limit_s)
        found[model] = replace(found[model], energy_m=energy_m)
    return found


if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        training, model = training_inputs(snakemake), read_model(files.model)
        calibration, residuals = read_calibration(files.calibration), read_table(files.residuals)
        known = known_walks(training, residuals, params.blending_space["normalisation"])
        volumes = cell_volumes(model.space)
        paced = ExtendedModel(model, calibration.pace)
        names_of_run = (params.seed, int(snakemake.wildcards.replicate), "score_forecasts")
        rows, curves_found = [], []
        for index, scenario in enumerate(params.scenarios):
            # The names of the walks give the order in which a person walked them.
            walks = sorted(read_walks(files.walks[index], files.samples[index]), key=lambda walk: walk.row["walk"])
            names = [walk.row["walk"] for walk in walks]
            table = read_table(files.vectors[index]).set_index("walk").loc[names]
            vectors = indexed_vectors(table, params.dependencies, index="planned").to_numpy(dtype=float)
            trials = read_table(files.trials[index])
            routes = read_routes(files.routes[index])
            asked = asked_walks(training, walks, routes, vectors, model, paced, trials, params)
            identity = {"walk": names, "participant": asked.participants, "inside_hull": model.inside(vectors)}
            forecasts = all_forecasts(known, asked, calibration, volumes)
            limit_s = params.planner["time_limit_s"]
            forecasts = with_trajectories(forecasts, asked, walks, routes, paced, training.planner, limit_s, names_of_run)
            scored = walk_scores(asked.captured_s, forecasts, pd.DataFrame(identity))
            rows.append(scored.assign(scenario=scenario))
            curves_found.append(by_exponent(asked, CANDIDATES["exponent"], volumes).assign(scenario=scenario))
            del asked  # the traces of one scenario are enough to hold
        rows = pd.concat(rows, ignore_index=True)
        rng = generator(*names_of_run)
        write_table(rows, snakemake.output.predictions)
        write_table(score_table(rows, rng, params.statistics["bootstraps"]), snakemake.output.scores)
        learned = read_table(files.candidates)
        learned = learned[(learned["model"] == "P_Prob") & (learned["kind"] == "exponent")][["value", "crps_s"]]
        exponents = pd.concat([learned.assign(scenario="training"), *curves_found], ignore_index=True)
        exponents = exponents.assign(model="P_Prob", quantity="crps_by_exponent")
        exponents = exponents.rename(columns={"value": "at", "crps_s": "value"})
        calibrated = pd.concat([calibration_table(rows), exponents], ignore_index=True)
        write_table(calibrated[["scenario", "model", "quantity", "at", "value"]], snakemake.output.calibration)
