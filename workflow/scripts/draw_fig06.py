"""Figure 6: the dependency blending space."""

from adapter import job
from walklab.evaluation.illustrations import example_entries
from walklab.figures.blending import fig06
from walklab.figures.style import save
from walklab.steering.io import read_blending_space

if __name__ == "__main__":
    with job(snakemake):
        blending, space = read_blending_space(snakemake.input.space)
        insets = {int(entry): blending.maps[entry] for entry in example_entries(blending.vectors)}
        save(fig06(blending.vectors, blending.is_blend, blending.names, blending.units, insets, space), *snakemake.output)
