"""Every published figure beside ours, coloured by verdict."""

from adapter import job
from walklab.figures.claims import fig_claims
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        save(fig_claims(read_table(snakemake.input.claims)), *snakemake.output)
