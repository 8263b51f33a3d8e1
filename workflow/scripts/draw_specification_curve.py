"""Draw how the main claims depend on the choices."""

from adapter import job
from walklab.figures.multiverse import fig_specification_curve
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        files = snakemake.input
        figure = fig_specification_curve(read_table(files.claims), read_table(files.specifications), snakemake.params.scenarios)
        save(figure, *snakemake.output)
