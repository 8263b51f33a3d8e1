"""Scores of every parameter vector for every walk, and the suitability made of them (section 4.3)."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError
from walklab.geometry.scene import State, Task
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import Planner, SweepingPlanner, WalkBatch
from walklab.steering.metrics import Metric, metric_named

Array = NDArray[np.float64]
Normalisation = Literal["per_map_max", "global_max", "min_max"]


def score_walks(
    planner: Planner, batch: WalkBatch, cells: Array, metric: str | Metric = "euclid", time_limit_s: float = 60.0
) -> Array:
    """The metric between every captured walk and its simulation with every parameter vector.

    Parameters
    ----------
    planner : compiled code is used where it can sweep and the metric is m_Euclid
    batch : W walks, captured positions every ``planner.step_s``
    cells : (C, P) array in the order of ``planner.parameters``
    metric : name of a registered metric, or one of your own; ``metric_named`` gives one that measures by the study's
        own standing speed
    time_limit_s : longest simulated walk, for metrics that look beyond the captured one

    Returns
    -------
    (W, C) array in the metric's unit; smaller is better

    Raises
    ------
    InputError
        If the metric is unknown, the steps differ, or a score is not finite.
    """
    chosen = metric_named(metric) if isinstance(metric, str) else metric
    if not math.isclose(batch.step_s, planner.step_s, rel_tol=1e-9):
        raise InputError(f"walks every {batch.step_s} s, planner every {planner.step_s} s: resample the walks")
    points = np.ascontiguousarray(np.atleast_2d(cells), dtype=float)
    scores = _swept(planner, batch, points, chosen.name, time_limit_s)
    if scores is None:
        scores = np.stack([_score_walk(planner, batch, index, points, chosen, time_limit_s) for index in range(len(batch))])
    if not np.all(np.isfinite(scores)):
        walk, cell = np.argwhere(~np.isfinite(scores))[0]
        raise InputError(
            f"walk {walk} of the batch, parameters {points[cell].tolist()}: {chosen.name} is {scores[walk, cell]}; "
            "check that the walk has a length and the planner gives finite positions"
        )
    return scores


def _swept(planner: Planner, batch: WalkBatch, cells: Array, metric: str, time_limit_s: float) -> Array | None:
    """Scores from compiled code; None for a planner or metric that has none."""
    if metric in ("euclid", "mean_distance") and isinstance(planner, SweepingPlanner):
        scores = np.asarray(planner.sweep_euclid(batch, cells))
        if metric == "euclid":
            return scores
        # The same sum over the frames, divided by their number instead of by length / step.
        return scores * (batch.lengths_m / (np.diff(batch.captured_offsets) * batch.step_s))[:, None]
    if metric == "euclid_until_both_end" and isinstance(planner, PathFollowing):
        return planner.sweep_euclid(batch, cells, beyond_s=time_limit_s)
    return None


def captured_walk(batch: WalkBatch, index: int) -> Array:
    """Captured positions of one walk of a batch, (T, 2) array, metres."""
    return batch.captured_m[batch.captured_offsets[index] : batch.captured_offsets[index + 1]]


def batch_task(batch: WalkBatch, index: int) -> tuple[Array, Task]:
    """Route and task of one walk of a batch; headings follow the route."""
    route = batch.routes_m[batch.route_offsets[index] : batch.route_offsets[index + 1]]
    start = State((float(route[0, 0]), float(route[0, 1])), None, float(batch.start_speeds_m_s[index]))
    end = State((float(route[-1, 0]), float(route[-1, 1])), None, float(batch.end_speeds_m_s[index]))
    return route, Task(start, end)


def _score_walk(planner: Planner, batch: WalkBatch, index: int, cells: Array, metric: Metric, time_limit_s: float) -> Array:
    captured = captured_walk(batch, index)
    route, task = batch_task(batch, index)
    # One step more than the captured walk lasts, so that rounding cannot cost the last frame.
    limit = len(captured) * planner.step_s if metric.horizon == "captured" else time_limit_s
    walks = [planner.follow(route, task, cell, limit).positions_m for cell in cells]
    scores = np.empty(len(walks))
    # Simulated walks of one length at a time: until both have ended is another time for each length.
    longest = np.array([len(captured) if metric.horizon == "captured" else max(len(captured), len(walk)) for walk in walks])
    for frames in np.unique(longest):
        cells_in = np.flatnonzero(longest == frames)
        simulated = np.stack([standing_at_end(walks[cell], frames) for cell in cells_in])
        own = standing_at_end(captured, frames)
        scores[cells_in] = metric(own, simulated, planner.step_s, float(batch.lengths_m[index]))
    return scores


def standing_at_end(points_m: Array, frames: int) -> Array:
    """The first frames of a walk; one with fewer stands at its last point for the rest, (frames, 2) array."""
    if len(points_m) >= frames:
        return points_m[:frames]
    return np.concatenate([points_m, np.repeat(points_m[-1:], frames - len(points_m), axis=0)])


def normalise(scores: Array, how: Normalisation = "per_map_max") -> Array:
    """Suitability, 1 = best, from scores (section 4.3: "normalized to 1 and subtracted from 1").

    Parameters
    ----------
    scores : (..., C) array, one map per row, not negative
    how : ``per_map_max``: ``1 - m / max m`` (the paper); ``global_max``: the maximum over all
        maps, which keeps maps comparable; ``min_max``: ``(max m - m) / (max m - min m)``

    Returns
    -------
    (..., C) array in [0, 1]
    """
    if how not in ("per_map_max", "global_max", "min_max"):
        raise InputError(f"normalisation: there is no {how!r}; choose per_map_max, global_max or min_max")
    values = np.asarray(scores, dtype=float)
    worst = values.max(axis=-1, keepdims=True)
    best = values.min(axis=-1, keepdims=True)
    # ASSUME: A map whose score is the same in every cell says nothing about the parameters and gets suitability 1
    # everywhere, since 1 - m / max m would make it impossible everywhere.
    flat = worst <= best
    if how == "min_max":
        suitability = (worst - values) / np.where(flat, 1.0, worst - best)
    else:
        scale = worst if how == "per_map_max" else np.full_like(worst, values.max())
        suitability = 1.0 - values / np.where(scale > 0, scale, 1.0)
    return np.where(flat, 1.0, suitability)
