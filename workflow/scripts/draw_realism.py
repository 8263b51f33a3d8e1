"""Synthetic walks beside recorded ones."""

from adapter import job
from walklab.figures.realism import fig_realism
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        save(fig_realism(read_table(snakemake.input.values)), *snakemake.output)
