"""Scores of the leave-one-subject-out evaluation."""

from adapter import job
from walklab.figures.real import fig_scores
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        save(fig_scores(read_table(snakemake.input.scores), read_table(snakemake.input.summary)), *snakemake.output)
