"""Figure 15: long distances."""

import pandas as pd

from adapter import job
from paper_inputs import published
from walklab.figures.evaluation import fig15
from walklab.figures.style import save
from walklab.storage import read_table


def published_times(inputs, claims):
    """Published medians and interquartile ranges: DataFrame[distance_m, model, median_s, iqr_s]."""
    sources = {"Ref": inputs["long_distance"]["reference_travel_time_s"], **claims["long_distance_s"]}
    return pd.DataFrame(
        [
            {"distance_m": distance, "model": model, "median_s": figures["median"], "iqr_s": figures.get("iqr", float("nan"))}
            for model, distances in sources.items()
            for distance, figures in distances.items()
        ]
    )


if __name__ == "__main__":
    with job(snakemake):
        draws = read_table(snakemake.input.draws)
        times = draws[draws["split"] == "repetition"].rename(columns={"source": "model"})
        save(fig15(times, published_times(*published(snakemake.input.paper))), *snakemake.output)
