"""Describe the errors of the models in one scenario and test their differences."""

import pandas as pd

from adapter import job
from walklab.evaluation.mixed import mixed_model
from walklab.evaluation.signed_rank import compare_pairs
from walklab.evaluation.statistics import describe, percentile_intervals, reductions
from walklab.randomness import generator
from walklab.storage import read_table, write_table


def by_hull(trials: pd.DataFrame) -> pd.DataFrame:
    """The description of the walks inside and outside the training dependencies."""
    parts = {bool(inside): describe(group) for inside, group in trials.groupby("inside_hull")}
    return pd.concat([part.assign(inside_hull=inside) for inside, part in parts.items()], ignore_index=True)


if __name__ == "__main__":
    with job(snakemake):
        trials = read_table(snakemake.input.trials)
        resamples = snakemake.params.statistics["bootstraps"]
        names = (snakemake.params.seed, int(snakemake.wildcards.replicate), "compare_models", snakemake.wildcards.scenario)
        tables = {
            "description": describe(trials),
            "description_by_hull": by_hull(trials),
            "percentiles": percentile_intervals(trials, generator(*names, "percentiles"), resamples),
            "reductions": reductions(trials, generator(*names, "reductions"), resamples=resamples),
            "comparisons": compare_pairs(trials, generator(*names, "comparisons"), resamples=resamples),
            "mixed": mixed_model(trials),
        }
        for name, table in tables.items():
            write_table(table, snakemake.output[name])
