"""Train and test the long-distance model, once split by repetition and once by participant (8.3)."""

from dataclasses import replace

import pandas as pd

from adapter import job
from planner_inputs import planner_of
from walklab.capture.io import read_travel_times
from walklab.evaluation.long_distance import SETTINGS, study_long_distances
from walklab.geometry.standing import Standing
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        chosen = params.long_distance
        planner, space = planner_of(chosen["planner"], chosen["space"])
        studies = [
            study_long_distances(
                read_travel_times(snakemake.input.times),
                planner,
                space,
                Standing(**params.standing),
                params.seed,
                int(snakemake.wildcards.replicate),
                split,
                replace(SETTINGS, k=chosen["k"], exponent=chosen["exponent"]),
                chosen["planner"]["time_limit_s"],
                resamples=params.statistics["bootstraps"],
            )
            for split in ("repetition", "participant")
        ]
        for name, parts in zip(("table", "draws", "optimum", "sharpness"), zip(*studies, strict=True), strict=True):
            write_table(pd.concat(parts, ignore_index=True), snakemake.output[name])
