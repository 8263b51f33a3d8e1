"""Count in how many replicates each claim held."""

from adapter import job
from walklab.evaluation.claims import load_paper
from walklab.evaluation.replicates import count_claims
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        verdicts = [read_table(path) for path in snakemake.input.claims]
        write_table(count_claims(load_paper(snakemake.input.paper), verdicts), snakemake.output.claims)
