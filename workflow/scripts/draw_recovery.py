"""How near the method comes to a known distribution."""

from adapter import job
from walklab.figures.recovery import fig_recovery
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        save(fig_recovery(read_table(snakemake.input.recovery), read_table(snakemake.input.densities)), *snakemake.output)
