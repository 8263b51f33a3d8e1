"""Build the dependency blending space and say how its density changed."""

import pandas as pd

from adapter import job
from map_inputs import all_maps, indexed_vectors, settings_of
from walklab.randomness import generator
from walklab.steering.density import density
from walklab.steering.io import write_blending_space
from walklab.steering.training import train_blending_space
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        maps = all_maps(snakemake.input.maps)
        params = snakemake.params
        blending = train_blending_space(
            maps.scores,
            indexed_vectors(maps.vectors, params.dependencies),
            maps.participants,
            settings_of(params.blending_space),
            generator(params.seed, int(snakemake.wildcards.replicate), "build_space"),
        )
        write_blending_space(blending, maps.space, snakemake.output.space)
        before, after = (
            density(vectors, blending.scaling) for vectors in (blending.vectors[~blending.is_blend], blending.vectors)
        )
        write_table(pd.DataFrame([{"when": "before", **before}, {"when": "after", **after}]), snakemake.output.density)
