"""Describe the errors of the models in one scenario and test their differences."""

from adapter import job
from walklab.evaluation.comparison import compare_models
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        params, wildcards = snakemake.params, snakemake.wildcards
        tables = compare_models(
            read_table(snakemake.input.trials),
            params.seed,
            int(wildcards.replicate),
            wildcards.scenario,
            params.statistics["bootstraps"],
        )
        for name, table in tables.items():
            write_table(table, snakemake.output[name])
