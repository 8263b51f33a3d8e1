"""Error and time as the number of neighbours grows (Agethen et al. 2017, section 8.2, figure 14)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from walklab.evaluation.bootstrap import RESAMPLES, Array
from walklab.evaluation.statistics import percentile_intervals
from walklab.randomness import generator
from walklab.steering.models import MotionModel, ProbabilisticModel

NEIGHBOURS = (10, 20, 50, 100, 200, 500)


def models_by_neighbours(model: ProbabilisticModel, ks: Sequence[int] = NEIGHBOURS) -> dict[int, ProbabilisticModel]:
    """The same model with each number of neighbours that its blending space has entries for."""
    return {k: replace(model, k=k) for k in ks if k <= len(model.blending)}


def neighbour_trials(
    models: Mapping[int, MotionModel], simulate: Callable[[Mapping[str, MotionModel]], pd.DataFrame]
) -> dict[int, pd.DataFrame]:
    """Trials of each number of neighbours.

    Parameters
    ----------
    simulate : :func:`walklab.evaluation.trials.simulate_trials` with everything but its models; every model is
        passed as ``P_Prob``, so that all draw with the same random numbers and the row of the default k is the main result
    """
    return {k: simulate({"P_Prob": model}) for k, model in models.items()}


def neighbour_table(trials: Mapping[int, pd.DataFrame], rng: np.random.Generator, resamples: int = RESAMPLES) -> pd.DataFrame:
    """Percentiles of |dt| for each k, from trials that drew under one name.

    Returns
    -------
    DataFrame[k, n, not_arrived, statistic (p05, p25, median, p75, p95, iqr), value, low, high]
    """
    frames = []
    for k, table in trials.items():
        frame = percentile_intervals(table, rng, resamples)
        frame = frame.assign(k=k, n=len(table), not_arrived=int((table["arrival"] != "arrived").sum()))
        frames.append(frame[["k", "n", "not_arrived", "statistic", "value", "low", "high"]])
    return pd.concat(frames, ignore_index=True)


def time_neighbours(
    models: Mapping[int, ProbabilisticModel],
    vectors: Array,
    seed: int,
    repeats: int = 20,
    clock: Callable[[], float] = time.perf_counter,
) -> pd.DataFrame:
    """Time of one interpolation of maps and of one sample for each k; measured, so no deterministic result.

    Each is timed for one vector at a time, as a simulation would ask for it, after a first
    call that compiles; the median over ``repeats`` vectors is given.

    Returns
    -------
    DataFrame[k, interpolation_ms, sample_ms]
    """
    rows: list[dict[str, Any]] = []
    chosen = np.asarray(vectors)[np.linspace(0, len(vectors) - 1, min(repeats, len(vectors))).astype(int)]
    for k, model in models.items():
        model.blend(chosen[:1])
        model.parameters(chosen[:1], [generator(seed, "timing")])
        blends, samples = [], []
        for index, vector in enumerate(chosen):
            start = clock()
            model.blend(vector[None])
            middle = clock()
            model.parameters(vector[None], [generator(seed, "timing", index)])
            blends.append(middle - start)
            samples.append(clock() - middle)
        rows.append({"k": k, "interpolation_ms": 1e3 * np.median(blends), "sample_ms": 1e3 * np.median(samples)})
    return pd.DataFrame(rows)
