"""Test pairs of forecasts by their CRPS and pairs of models by |dt|, participants counting as what is independent."""

import pandas as pd

from adapter import job
from walklab.evaluation.paired_tests import pair_table
from walklab.evaluation.pairs import PAIRS
from walklab.randomness import generator
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        params, files = snakemake.params, snakemake.input
        names, resamples = (params.seed, int(snakemake.wildcards.replicate), "compare_forecasts"), params.statistics["bootstraps"]
        rows = read_table(files.predictions)
        write_table(pair_table(rows, generator(*names), resamples=resamples), snakemake.output.tests)
        if files.get("trials"):
            scenarios = zip(params.scenarios, files.trials, strict=True)
            trials = pd.concat([read_table(path).assign(scenario=name) for name, path in scenarios], ignore_index=True)
            table = pair_table(trials, generator(*names, "trials"), PAIRS, "abs_dt_s", resamples)
            write_table(table, snakemake.output.trial_tests)
