"""Figure 5: one suitability map."""

import numpy as np

from adapter import job
from map_inputs import all_maps
from walklab.figures.maps import fig05
from walklab.figures.style import save
from walklab.steering.suitability import normalise

if __name__ == "__main__":
    with job(snakemake):
        maps = all_maps(snakemake.input.maps)
        # The longest planned walk: there all parameters matter.
        longest = int(np.argmax(maps.vectors["planned_length"].to_numpy()))
        suitability = normalise(maps.scores, snakemake.params.blending_space["normalisation"])[longest]
        save(fig05(suitability, maps.space), *snakemake.output)
