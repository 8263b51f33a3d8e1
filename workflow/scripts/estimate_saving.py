"""What a smaller error is worth a car: the production example of 7.5."""

from adapter import job
from walklab.evaluation.production import production_example
from walklab.randomness import generator
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        rng = generator(params.seed, int(snakemake.wildcards.replicate), "estimate_saving")
        saving = production_example(read_table(snakemake.input.trials), rng, resamples=params.statistics["bootstraps"])
        write_table(saving, snakemake.output.saving)
