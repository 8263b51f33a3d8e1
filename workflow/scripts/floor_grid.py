"""Simulate every walk of a scenario with the best cell of its own map: the error that the grid alone leaves."""

from adapter import job
from planner_inputs import planner_of
from walklab.capture.walks import read_walks
from walklab.evaluation.floor import grid_floor
from walklab.evaluation.statistics import describe
from walklab.geometry.plans import load_plan
from walklab.geometry.standing import Standing
from walklab.planning.io import read_routes
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        planner, space = planner_of(params.planner, params.space)
        walks = read_walks(files.walks, files.samples)
        standing, limit_s = Standing(**params.standing), params.planner["time_limit_s"]
        # Without the plan there are no obstacles to look for, and no walk counts as collided.
        scene = load_plan(files.plan).scene if files.get("plan") else None
        scenes = None if scene is None else {scene.name: scene}
        routes = read_routes(files.routes)
        trials = grid_floor(planner, walks, routes, space, standing, limit_s, params.metric, scenes=scenes)
        write_table(describe(trials), snakemake.output.floor)
