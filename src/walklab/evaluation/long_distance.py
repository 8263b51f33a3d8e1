"""Walks of 10, 25 and 50 m with a model of their own (Agethen et al. 2017, section 8.3, figure 15)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import pandas as pd

from walklab.errors import InputError
from walklab.evaluation.bootstrap import RESAMPLES, Array, cluster_codes, cluster_counts, interval, resampled_quantiles
from walklab.evaluation.calibration import blend_others
from walklab.evaluation.grid_scores import grid_crps
from walklab.geometry.scene import State, Task
from walklab.geometry.standing import Standing
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.protocol import Planner
from walklab.randomness import generator
from walklab.steering.models import ProbabilisticModel
from walklab.steering.sharpness import Sharpness, cell_volumes
from walklab.steering.space import ParameterSpace
from walklab.steering.training import TrainingSettings, train

CALIBRATED = "P_Prob (calibrated)"

Split = Literal["repetition", "participant"]

DEPENDENCIES = ("length", "height")
LARGEST_K = 20
DRAWS = ["split", "walk", "participant", "height_m", "distance_m", "source", "travel_time_s"]

# ASSUME: Section 8.3 does not give its k; it is 20 without up-sampling, since the 60 training walks are 20 of each
# distance, so that a walk's neighbours are walks of its own distance.
# Thirds of octaves, 1 to 1290: people differ little over so long a way, and the densities of travel time are broad.
EXPONENTS = tuple(float(2.0 ** (step / 3)) for step in range(32))
SETTINGS = TrainingSettings(count=None, k=LARGEST_K)

_FINE = 151**2  # vectors, at most, of the grid on which P_Stat is fitted to a resample
_CHUNK = 100  # resamples fitted at once, which bounds the memory


def straight_travel_time_s(distance_m: float, v: float, a: float) -> float:
    """Time from standing to standing over a straight distance with speed at most v and acceleration and braking a.

    ``d / v + v / a`` where v is reached (d >= v^2 / a), else ``2 sqrt(d / a)``; what a simulation tends to.
    """
    return distance_m / v + v / a if distance_m >= v**2 / a else 2 * float(np.sqrt(distance_m / a))


def simulated_times_s(planner: Planner, distance_m: float, cells: Array, standing: Standing, time_limit_s: float) -> Array:
    """Travel time along a straight route for each parameter vector, (C,) seconds; the time limit where it is reached."""
    task = Task(State((0.0, 0.0)), State((float(distance_m), 0.0)))
    route = np.array([[0.0, 0.0], [float(distance_m), 0.0]])
    walks = (planner.follow(route, task, cell, time_limit_s) for cell in np.atleast_2d(cells))
    return np.array([min(trajectory_travel_time_s(walk, task, standing.standing_speed_m_s), time_limit_s) for walk in walks])


def study_long_distances(
    walks: pd.DataFrame,
    planner: Planner,
    space: ParameterSpace,
    standing: Standing,
    seed: int,
    replicate: int,
    split: Split = "repetition",
    settings: TrainingSettings = SETTINGS,
    time_limit_s: float = 600.0,
    maxfun: int = 1000,
    resamples: int = RESAMPLES,
) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Train on one half of the walks, predict the travel times of the other.

    The map of a walk is ``|T_simulated(v, a) - T_captured|`` over the space; the dependencies are
    distance and height. P_Prob draws once per test walk, P_Stat is the optimum of the mean |dt|
    over the training walks.

    95 % intervals: for Ref and P_Prob the test participants are resampled, the training walks stay. P_Stat is one
    parameter vector, so all its walks of one distance take one time, whoever makes them; there the training
    participants are resampled and P_Stat is fitted to each resample, on a fine grid with interpolated travel times. Its
    iqr is 0 by construction and has no interval (NaN): a verdict on it rests on the value.

    Parameters
    ----------
    walks : DataFrame[walk, participant, height_m, distance_m, repetition, travel_time_s]
    planner : with the parameters of the space
    split : by ``repetition`` both halves share participants, by ``participant`` they do not
    settings : of the model; k at most 20 unless ``count`` up-samples

    Returns
    -------
    table : DataFrame[split, distance_m, source (Ref, P_Prob, P_Stat, P_Prob (calibrated)), statistic (median, iqr),
        walks, value, low, high]
    draws : DataFrame[split, walk, participant, height_m, distance_m, source, travel_time_s, <parameters; NaN for Ref>]
    optimum : DataFrame[split, parameter, unit, value, on_edge] of P_Stat
    sharpness : DataFrame[split, exponent, crps_s, chosen] of the training walks, see :func:`exponent_table`

    Raises
    ------
    InputError
        If a half is empty, k is too large, or the planner's parameters are not the space's.
    """
    if tuple(planner.parameters) != space.names:
        raise InputError(f"long distance: axes {', '.join(space.names)} are not the planner's {', '.join(planner.parameters)}")
    if settings.count is None and settings.k > LARGEST_K:
        raise InputError(f"long_distance.k = {settings.k}: at most {LARGEST_K} without up-sampling; lower k or set a count")
    training, test = split_walks(walks, split)
    times = {
        float(distance): simulated_times_s(planner, distance, space.cells, standing, time_limit_s)
        for distance in np.unique(walks["distance_m"])
    }
    captured = training["travel_time_s"].to_numpy()
    scores = np.abs(np.stack([times[float(distance)] for distance in training["distance_m"]]) - captured[:, None])
    rng = generator(seed, replicate, "long_distance", split)
    model = train(scores, _vectors(training), training["participant"].tolist(), space, settings, rng)
    rng = generator(seed, replicate, "long_distance", split, "P_Stat")
    best = _static_optimum(training, planner, space, standing, time_limit_s, maxfun, rng)
    sharpness = exponent_table(model, training, np.stack([times[float(d)] for d in training["distance_m"]]))
    chosen = float(sharpness.loc[sharpness["chosen"], "exponent"].iloc[0])

    def drawn(exponent: float) -> Array:
        generators = [generator(seed, replicate, "long_distance", split, "P_Prob", str(name)) for name in test["walk"]]
        return replace(model, exponent=exponent).parameters(_vectors(test).to_numpy(), generators)

    parameters = {
        "P_Prob": drawn(model.exponent),
        "P_Stat": np.tile(best, (len(test), 1)),
        CALIBRATED: drawn(chosen),
    }
    draws = _draws(test, parameters, planner, space.names, split, standing, time_limit_s)
    rng = generator(seed, replicate, "long_distance", split, "P_Stat", "bootstrap")
    refitted = static_intervals_s(training, times, space, time_limit_s, rng, resamples)
    table = _table(draws, refitted, generator(seed, replicate, "long_distance", split, "bootstrap"), resamples)
    edges = space.on_edge(best)
    optimum = pd.DataFrame({"split": split, "parameter": list(space.names), "unit": [axis.unit for axis in space.axes]})
    return table, draws, optimum.assign(value=best, on_edge=edges), sharpness.assign(split=split)


def exponent_table(model: ProbabilisticModel, training: pd.DataFrame, times_s: Array) -> pd.DataFrame:
    """How well each exponent forecasts the training walks, each by the maps of other participants, and which is chosen.

    The smallest CRPS is chosen, every participant counting once; no test walk is read.

    Parameters
    ----------
    model : of the training walks, its captured maps in their order
    times_s : (N, C) travel time of each training walk with each parameter vector

    Returns
    -------
    DataFrame[exponent, crps_s, chosen, on_edge]; ``on_edge`` where the choice is the first or last of :data:`EXPONENTS`
    """
    owners, captured_s = training["participant"].tolist(), training["travel_time_s"].to_numpy(dtype=float)
    blending = model.blending
    asked, maps = np.arange(len(training)), blending.maps[~blending.is_blend]
    blends = blend_others(blending, owners, asked, blending.vectors[~blending.is_blend], [maps], model.k, model.weights)[0]
    volumes = cell_volumes(model.space)
    rows = []
    for exponent in EXPONENTS:
        scores = pd.Series(grid_crps(times_s, Sharpness("exponent", exponent).density(blends, volumes), captured_s))
        rows.append({"exponent": exponent, "crps_s": float(scores.groupby(np.asarray(owners)).mean().mean())})
    table = pd.DataFrame(rows)
    chosen = table.index == table["crps_s"].idxmin()
    return table.assign(chosen=chosen, on_edge=chosen & ((table.index == 0) | (table.index == len(table) - 1)))


def split_walks(walks: pd.DataFrame, split: Split) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Training and test half.

    Raises
    ------
    InputError
        If the split is unknown or a half would be empty.
    """
    # ASSUME: Section 8.3 does not say how the walks were halved; by repetition, every other repetition of each distance
    # trains, so that the order of walking separates nothing; by participant, every other participant does.
    if split not in ("repetition", "participant"):
        raise InputError(f"long_distance.split: {split!r} is neither repetition nor participant")
    names = np.sort(walks[split].unique())
    chosen = walks[split].isin(names[::2])
    training, test = walks[chosen].reset_index(drop=True), walks[~chosen].reset_index(drop=True)
    if len(training) == 0 or len(test) == 0:
        raise InputError(f"long distance: {len(walks)} walks with {len(names)} {split}s cannot be halved; record at least two")
    return training, test


def _vectors(walks: pd.DataFrame) -> pd.DataFrame:
    return pd.DataFrame({"length": walks["distance_m"].astype(float), "height": walks["height_m"].astype(float)})[[*DEPENDENCIES]]


def _static_optimum(
    training: pd.DataFrame,
    planner: Planner,
    space: ParameterSpace,
    standing: Standing,
    time_limit_s: float,
    maxfun: int,
    rng: np.random.Generator,
) -> Array:
    distances = training["distance_m"].to_numpy(dtype=float)
    captured_s = training["travel_time_s"].to_numpy(dtype=float)
    groups = {float(distance): captured_s[distances == distance] for distance in np.unique(distances)}

    from scipy.optimize import dual_annealing  # late: half a second of imports

    def mean_error_s(parameters: Array) -> float:
        total = 0.0
        for distance, captured in groups.items():
            total += np.abs(simulated_times_s(planner, distance, parameters, standing, time_limit_s)[0] - captured).sum()
        return total / len(training)

    return np.asarray(dual_annealing(mean_error_s, space.bounds, maxfun=maxfun, rng=rng).x)


def static_intervals_s(
    training: pd.DataFrame,
    times: Mapping[float, Array],
    space: ParameterSpace,
    time_limit_s: float,
    rng: np.random.Generator,
    resamples: int = RESAMPLES,
) -> dict[float, tuple[float, float]]:
    """Intervals of P_Stat's travel times: fitted to resamples of the training participants on a fine grid, by mean |dt|.

    Parameters
    ----------
    times : distance -> (C,) simulated travel times of the cells of the space

    Returns
    -------
    distance -> (low, high), seconds; NaN where there are fewer than two training participants
    """
    distances = training["distance_m"].to_numpy(dtype=float)
    captured_s = training["travel_time_s"].to_numpy(dtype=float)
    codes, clusters = cluster_codes(training["participant"])
    fine = {distance: np.minimum(fine_times_s(distance, found, space), time_limit_s) for distance, found in times.items()}
    errors = np.zeros((clusters, len(next(iter(fine.values())))))
    for code, distance, captured in zip(codes, distances, captured_s, strict=True):
        errors[code] += np.abs(fine[float(distance)] - captured)
    counts = cluster_counts(clusters, resamples, rng).astype(float)
    # A resample's mean has the same denominator for all vectors, so its sum has the same optimum.
    best = np.concatenate([np.argmin(counts[i : i + _CHUNK] @ errors, axis=1) for i in range(0, resamples, _CHUNK)])
    return {distance: interval(found[best], clusters) for distance, found in fine.items()}


def fine_times_s(distance_m: float, times_s: Array, space: ParameterSpace) -> Array:
    """Travel times on a finer grid from those of the cells, interpolated linearly in what they are off the closed form."""
    axes = fine_axes(space)
    fine = np.column_stack([grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")])
    off = (times_s - _closed_form_s(distance_m, space.cells, space.names)).reshape(space.shape)
    from scipy.interpolate import RegularGridInterpolator  # late: half a second of imports

    interpolate = RegularGridInterpolator([axis.values for axis in space.axes], off)
    return np.asarray(interpolate(fine)) + _closed_form_s(distance_m, fine, space.names)


def fine_axes(space: ParameterSpace) -> list[Array]:
    """Equally many values on each axis of the finer grid: 151 where there are two."""
    count = max(int(round(_FINE ** (1 / len(space.axes)), 6)), 2)
    return [np.linspace(low, high, count) for low, high in space.bounds]


def _closed_form_s(distance_m: float, cells: Array, names: Sequence[str]) -> Array:
    """:func:`straight_travel_time_s` of many cells; 0 where the parameters are others than v and a."""
    if not {"v", "a"} <= set(names):
        return np.zeros(len(cells))
    v, a = (cells[:, names.index(name)] for name in ("v", "a"))
    return np.where(distance_m >= v**2 / a, distance_m / v + v / a, 2 * np.sqrt(distance_m / a))


def _draws(
    test: pd.DataFrame,
    parameters: Mapping[str, Array],
    planner: Planner,
    names: Sequence[str],
    split: str,
    standing: Standing,
    time_limit_s: float,
) -> pd.DataFrame:
    base = test[["walk", "participant", "height_m", "distance_m"]].assign(split=split)
    frames = [base.assign(source="Ref", travel_time_s=test["travel_time_s"], **dict.fromkeys(names, np.nan))]
    for source, rows in parameters.items():
        times = [
            simulated_times_s(planner, distance, row, standing, time_limit_s)[0]
            for distance, row in zip(test["distance_m"], rows, strict=True)
        ]
        columns = {name: rows[:, index] for index, name in enumerate(names)}
        frames.append(base.assign(source=source, travel_time_s=times, **columns))
    return pd.concat(frames, ignore_index=True)[[*DRAWS, *names]]


def _table(
    draws: pd.DataFrame, refitted: Mapping[float, tuple[float, float]], rng: np.random.Generator, resamples: int
) -> pd.DataFrame:
    rows = []
    for (distance, source), group in draws.groupby(["distance_m", "source"], sort=False):
        values = group["travel_time_s"].to_numpy(dtype=float)
        codes, clusters = cluster_codes(group["participant"])
        resampled = resampled_quantiles(values, codes, cluster_counts(clusters, resamples, rng), [0.25, 0.5, 0.75])
        exact = np.quantile(values, [0.25, 0.5, 0.75])
        for name, value, of_draws in (
            ("median", exact[1], resampled[:, 1]),
            ("iqr", exact[2] - exact[0], resampled[:, 2] - resampled[:, 0]),
        ):
            low, high = interval(of_draws, clusters)
            if source == "P_Stat":
                low, high = refitted[group["distance_m"].iloc[0]] if name == "median" else (np.nan, np.nan)
            rows.append([group["split"].iloc[0], distance, source, name, len(values), value, low, high])
    return pd.DataFrame(rows, columns=["split", "distance_m", "source", "statistic", "walks", "value", "low", "high"])
