"""List every assumption, and our reading of every inconsistency of the paper."""

from adapter import job
from walklab.evaluation.assumptions import list_assumptions
from walklab.evaluation.claims import inconsistency_table, load_paper
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        write_table(list_assumptions(snakemake.params.root), snakemake.output.assumptions)
        write_table(inconsistency_table(load_paper(snakemake.input.paper)), snakemake.output.inconsistencies)
