"""In how many replicates each claim held, and the forecasts' scores over the replicates."""

from adapter import job
from walklab.figures.replicates import fig_counted_claims, fig_pooled_scores
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        save(fig_counted_claims(read_table(snakemake.input.claims)), *snakemake.output[:2])
        save(fig_pooled_scores(read_table(snakemake.input.scores)), *snakemake.output[2:])
