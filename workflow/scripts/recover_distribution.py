"""Walks made by the planner from a known distribution, and what the method makes of them."""

from adapter import job
from capture_inputs import plans_by_scene
from map_inputs import settings_of
from planner_inputs import planner_of
from walklab.capture.training import TrainingDesign, configurations
from walklab.evaluation.planner_walks import known_distribution, walk_by_planner
from walklab.evaluation.recovery import Setup, recover_all
from walklab.geometry.scene import Body
from walklab.geometry.standing import Standing
from walklab.randomness import generator
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        wanted, standing, limit_s = params.recover_distribution, Standing(**params.standing), params.planner["time_limit_s"]
        planner, space = planner_of(params.planner, params.space)
        known = known_distribution(wanted["known"], space.names, space.bounds)
        design = configurations(TrainingDesign(**params.record_training), plans_by_scene(snakemake.input.plans))
        rng = generator(params.seed, "recover_distribution", "planner_walks")
        how = (known, planner, Body(**params.body), standing, limit_s, wanted["participants"])
        made = walk_by_planner(max(wanted["walks"]), design, *how, rng)
        settings = settings_of(params.blending_space, params.model)
        setup = Setup(planner, standing, limit_s, params.metric, settings, wanted["tasks"], wanted["draws"])
        table, densities = recover_all(made, space, wanted["walks"], wanted["resolutions"], known, setup, params.seed)
        write_table(table, snakemake.output.recovery)
        write_table(densities, snakemake.output.densities)
