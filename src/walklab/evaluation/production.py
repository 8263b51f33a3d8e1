"""What the models' errors mean for a production line: the example of Agethen et al. 2017, section 7.5."""

from __future__ import annotations

import numpy as np
import pandas as pd

from walklab.evaluation.bootstrap import (
    RESAMPLES,
    Array,
    cluster_codes,
    cluster_counts,
    interval,
    resampled_quantiles,
    resampled_sums,
)
from walklab.evaluation.pairs import paired


def production_example(
    trials: pd.DataFrame,
    rng: np.random.Generator,
    cycle_s: float = 100.0,
    walking_share: float = 0.2,
    pair: tuple[str, str] = ("P_Stat", "P_Prob"),
    resamples: int = RESAMPLES,
) -> pd.DataFrame:
    """Error a car with the first and the second model, and by how much it falls.

    A car leaves ``cycle_s * walking_share`` seconds of walking, that is
    ``walks = walking time / mean captured duration``. Three readings of "the error":

    - ``absolute``: the walks' absolute errors add up, ``walks * mean |dt|``;
    - ``net``: errors of opposite sign cancel, ``walks * |mean dt|``;
    - ``paper``: the arithmetic that gives the paper's 2-3 s, ``walking time * (1 - median |dt|_2 / median |dt|_1)``
      (12-15 % of 20 s). It is a share of the walking time, not of an error.

    Returns
    -------
    DataFrame[quantity, unit, value, low, high]: walks_per_car, absolute_first, absolute_second, absolute_reduction,
    net_first, net_second, net_reduction, paper_reduction; 95 % intervals over participants
    """
    walking_s = cycle_s * walking_share
    absolute = paired(trials, *pair)
    signed = paired(trials, *pair, column="dt_s")
    captured = paired(trials, *pair, column="captured_s")["first"].to_numpy()
    columns = [captured, *(absolute[side].to_numpy() for side in ("first", "second"))]
    columns += [signed[side].to_numpy() for side in ("first", "second")]
    codes, clusters = cluster_codes(absolute["participant"])
    counts = cluster_counts(clusters, resamples, rng)
    resampled = _quantities(resampled_sums(np.column_stack([np.ones(len(captured)), *columns]), codes, counts), walking_s)
    values = _quantities(np.array([[len(captured), *(column.sum() for column in columns)]]), walking_s)
    medians = [resampled_quantiles(column, codes, counts, [0.5])[:, 0] for column in columns[1:3]]
    resampled["paper_reduction"] = walking_s * _relative(*medians)
    values["paper_reduction"] = walking_s * _relative(*(np.array([np.median(column)]) for column in columns[1:3]))
    rows = []
    for name, value in values.items():
        low, high = interval(resampled[name], clusters)
        unit = "walks" if name == "walks_per_car" else "s"
        rows.append({"quantity": name, "unit": unit, "value": float(value[0]), "low": low, "high": high})
    return pd.DataFrame(rows)


def _quantities(sums: Array, walking_s: float) -> dict[str, Array]:
    """Quantities per car from sums over walks: count, captured time, |dt| of both models, dt of both models."""
    per_second = walking_s / sums[:, 1]
    first, second = per_second * sums[:, 2], per_second * sums[:, 3]
    net_first, net_second = np.abs(per_second * sums[:, 4]), np.abs(per_second * sums[:, 5])
    return {
        "walks_per_car": per_second * sums[:, 0],
        "absolute_first": first,
        "absolute_second": second,
        "absolute_reduction": first - second,
        "net_first": net_first,
        "net_second": net_second,
        "net_reduction": net_first - net_second,
    }


def _relative(first: Array, second: Array) -> Array:
    return 1 - np.divide(second, first, out=np.full_like(second, np.nan), where=first > 0)
