"""Figure 10: plan views of both scenarios, captured walks and one simulated walk per model."""

import pandas as pd

from adapter import job
from map_inputs import indexed_vectors
from planner_inputs import planner_of
from walklab.capture.walks import read_walks
from walklab.evaluation.illustrations import most_bent, simulated_paths
from walklab.figures.capture import fig10
from walklab.figures.style import save
from walklab.geometry.plans import load_plan
from walklab.planning.io import read_routes
from walklab.randomness import generator
from walklab.steering.io import read_model, read_static_fit
from walklab.steering.models import AdaptiveModel, StaticModel
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        planner, _ = planner_of(params.planner, params.space)
        model, static = read_model(files.model), read_static_fit(files.static)
        models = {"P_Stat": StaticModel(static.names, static.optimum), "P_Adapt": AdaptiveModel(model), "P_Prob": model}
        captured, simulated, plans = {}, {}, {}
        for index, (name, plan) in enumerate(params.scenarios.items()):
            walks = read_walks(files.walks[index], files.samples[index])
            routes = read_routes(files.routes[index])
            shown = most_bent(walks, routes)
            identity = walks[shown].row["walk"]
            table = read_table(files.vectors[index]).set_index("walk").loc[[identity]]
            vector = indexed_vectors(table, params.dependencies, index="planned").to_numpy()[0]
            rng = generator(params.seed, 0, "draw_fig10", name)
            plans[name] = load_plan(plan)
            captured[name] = pd.concat(
                [pd.DataFrame({"walk": w.row["walk"], "x_m": w.position_m[:, 0], "y_m": w.position_m[:, 1]}) for w in walks],
                ignore_index=True,
            )
            simulated[name] = simulated_paths(
                walks[shown], routes[identity], vector, models, planner, rng, params.planner["time_limit_s"]
            )
        save(fig10(plans, captured, simulated), *snakemake.output)
