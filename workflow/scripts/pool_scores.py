"""Pool the scores of all replicates."""

from adapter import job
from walklab.evaluation.replicates import pool_scores
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        write_table(pool_scores([read_table(path) for path in snakemake.input.scores]), snakemake.output.scores)
