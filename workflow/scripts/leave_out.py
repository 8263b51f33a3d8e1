"""Leave maps, participants and cells out and see how well the interpolations put them back (8.2)."""

import pandas as pd

from adapter import job
from map_inputs import all_maps, indexed_vectors, settings_of
from walklab.evaluation.leave_one_out import k_nearest_errors, left_out_participant_errors, rbf_errors, summarise_leave_one_out
from walklab.randomness import generator
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.io import read_blending_space
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        names = (params.seed, int(snakemake.wildcards.replicate), "leave_out")
        maps = all_maps(snakemake.input.maps)
        vectors = indexed_vectors(maps.vectors, params.dependencies)
        settings = settings_of(params.blending_space, params.model)
        blending, space = read_blending_space(snakemake.input.space)

        interpolant = GridInterpolant(space.shape, settings.kernel, settings.epsilon)
        errors = pd.concat(
            [
                k_nearest_errors(blending, settings.k, settings.weights, maps.participants),
                left_out_participant_errors(maps.scores, vectors, maps.participants, settings, names[0], names[1]),
                rbf_errors(interpolant, blending.maps, generator(*names, "cells"), params.leave_out["cells"]),
            ],
            ignore_index=True,
        )
        summary = summarise_leave_one_out(errors, generator(*names, "bootstrap"), params.statistics["bootstraps"])
        write_table(errors, snakemake.output.errors)
        write_table(summary, snakemake.output.summary)
