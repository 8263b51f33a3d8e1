"""Test pairs of forecasts by their CRPS, participants counting as what is independent."""

from adapter import job
from walklab.evaluation.paired_tests import pair_table
from walklab.randomness import generator
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        rng = generator(params.seed, int(snakemake.wildcards.replicate), "compare_forecasts")
        rows = read_table(snakemake.input.predictions)
        write_table(pair_table(rows, rng, resamples=params.statistics["bootstraps"]), snakemake.output.tests)
