"""The report of the run: one self-contained page, and a PDF of figures and tables."""

import numpy as np

from adapter import job
from paper_inputs import whole_paper
from planner_inputs import planner_of
from walklab.capture.walks import read_walks
from walklab.evaluation.calibration_files import read_calibration
from walklab.geometry.plans import load_plan
from walklab.planning.io import read_routes
from walklab.randomness import generator
from walklab.report.contents import Contents
from walklab.report.io import read_figure, read_tables, write_pdf
from walklab.report.map_lattice import map_lattice
from walklab.report.page import render
from walklab.report.pdf import pdf_of
from walklab.report.shown_walks import scene_data
from walklab.runs.record import record
from walklab.steering.io import read_model
from walklab.storage import read_table, write_text


def maps_of(files, seed):
    """The view of maps: with the exponent of the model as it was read, and, where there is one, with what was learned."""
    model = read_model(files.model)
    sharpness = {"P_Prob": lambda points: np.full(len(points), model.exponent)}
    if "calibration" in files.keys():  # noqa: SIM118 (Snakemake's named list)
        sharpness["P_Prob (calibrated)"] = read_calibration(files.calibration).law.exponents
    return map_lattice(model, sharpness, generator(seed, 0, "build_report"))


def scenes_of(files, params):
    """The players: one per scenario; none for walks that were captured elsewhere."""
    if "trials" not in files.keys():  # noqa: SIM118
        return []
    planner, space = planner_of(params.planner, params.space)
    return [
        scene_data(
            name,
            load_plan(files.plans[index]),
            read_walks(files.walks[index], files.samples[index]),
            read_routes(files.routes[index]),
            read_table(files.trials[index]),
            planner,
            space.names,
            params.planner["time_limit_s"],
        )
        for index, name in enumerate(params.scenarios)
    ]


if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        contents = Contents(
            record(params.config, params.root, params.costs, params.digests, list(files.products), params.folder, "build_report"),
            whole_paper(files.paper) if "paper" in files.keys() else {},  # noqa: SIM118
            {
                name: read_figure(name, about["category"], about["drawing"], about["caption"])
                for name, about in params.figures.items()
            },
            read_tables(params.tables),
            maps_of(files, params.seed),
            scenes_of(files, params),
        )
        write_text(render(contents), snakemake.output.page)
        write_pdf(pdf_of(contents), snakemake.output.pdf)
