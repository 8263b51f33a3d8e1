"""All tables that describe the errors of the models in one scenario and test their differences."""

from __future__ import annotations

import pandas as pd

from walklab.evaluation.mixed import mixed_model
from walklab.evaluation.signed_rank import compare_pairs
from walklab.evaluation.statistics import describe, percentile_intervals, reductions
from walklab.randomness import generator


def compare_models(trials: pd.DataFrame, seed: int, replicate: int, scenario: str, resamples: int) -> dict[str, pd.DataFrame]:
    """Tables by name: description, description_by_hull, percentiles, reductions, comparisons, mixed.

    Parameters
    ----------
    trials : of one scenario
    seed, replicate, scenario : name the random numbers
    resamples : of the participants, for the intervals
    """
    names = (seed, replicate, "compare_models", scenario)
    return {
        "description": describe(trials),
        "description_by_hull": _by_hull(trials),
        "percentiles": percentile_intervals(trials, generator(*names, "percentiles"), resamples),
        "reductions": reductions(trials, generator(*names, "reductions"), resamples=resamples),
        "comparisons": compare_pairs(trials, generator(*names, "comparisons"), resamples=resamples),
        "mixed": mixed_model(trials),
    }


def _by_hull(trials: pd.DataFrame) -> pd.DataFrame:
    """The description of the walks inside and outside the training dependencies."""
    parts = {bool(inside): describe(group) for inside, group in trials.groupby("inside_hull")}
    return pd.concat([part.assign(inside_hull=inside) for inside, part in parts.items()], ignore_index=True)
