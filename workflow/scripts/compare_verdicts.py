"""Verdicts of this run beside those of another."""

from adapter import job
from walklab.evaluation.verdicts import beside
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        table = beside(read_table(snakemake.input.other), read_table(snakemake.input.claims))
        write_table(table, snakemake.output.verdicts)
