"""How sharp the density has to be, learned from experiment 1 alone: leave-one-participant-out, by proper scores.

A left-out participant's walks are forecast from blends in which none of that person's maps has a part. Of the walk
that is forecast, its task and dependencies are used, never its map.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.errors import InputError
from walklab.evaluation.baselines import levels
from walklab.evaluation.folds import by_participant
from walklab.evaluation.grid_scores import captured_distances, grid_crps, grid_energy, grid_quantiles
from walklab.evaluation.pace import PaceEffect, fit_pace, paced
from walklab.evaluation.subject_scores import forecast_scores
from walklab.evaluation.tracing import trace_walks
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.planning.tracing import Traces
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.scaling import ScalingRule, fit_scaling
from walklab.steering.sharpness import Sharpness, cell_volumes
from walklab.steering.space import ParameterSpace
from walklab.steering.suitability import Normalisation, normalise
from walklab.steering.weighting import Weighting

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

MEMBERS = 200
CANDIDATES = {
    "exponent": (1.0, 2.0, 4.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0, 80.0),
    "threshold": (0.5, 0.7, 0.8, 0.85, 0.9, 0.95),
    "temperature": (0.03, 0.05, 0.07, 0.1, 0.14, 0.2),
}
EXTENDED_EXPONENTS = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)


@dataclass(frozen=True)
class Evidence:
    """Training walks to learn the sharpness from, with what their cells and others' maps say.

    Attributes
    ----------
    participants : (W,) who walked
    captured_s : (W,) travel times
    suitability, metric, bare : (W, C) blends of *other* participants' suitability and metric, and their mean suitability
    traces : of the W walks
    distances_m : (W, C) of every cell's trajectory from the captured one
    volumes : (C,)
    """

    participants: Sequence[str]
    captured_s: Array
    suitability: Array
    metric: Array
    bare: Array
    traces: Traces
    distances_m: NDArray[np.float32]
    volumes: Array


def choose_walks(participants: Sequence[str], most: int, rng: np.random.Generator) -> Rows:
    """At most so many walks of every participant, at random, in the order given."""
    owners = np.asarray(participants, dtype=str)
    parts = [rng.permutation(np.flatnonzero(owners == owner))[:most] for owner in np.unique(owners)]
    return np.sort(np.concatenate(parts))


def blend_others(
    blending: BlendingSpace,
    participants: Sequence[str],
    asked: Rows,
    vectors: Array,
    maps: Iterable[Array],
    k: int,
    how: Weighting,
    scaling_rule: ScalingRule = "standard_deviation",
) -> list[Array]:
    """Blends for training walks, each from entries in which the walk's participant has no part.

    The scaling of the dependencies is that of the others, too. Which blends fill the sparse regions of the space was
    decided with everybody's dependency vectors; no map or time has a part in that.

    Parameters
    ----------
    blending : of all N captured training walks, in the order of ``participants``, and its up-sampled entries
    asked : (W,) rows of the captured walks to forecast
    vectors : (W, D) their run-time dependencies
    maps : one or more (N, C) arrays over the captured walks, to be blended alike

    Returns
    -------
    list of (W, C) arrays, one per array of maps
    """
    owners = np.asarray(participants, dtype=str)
    if int((~blending.is_blend).sum()) != len(owners):
        raise InputError(f"calibration: {len(owners)} training walks do not fit the blending space; build it again")
    shares = np.zeros((len(asked), len(owners)))
    used = blending.parents >= 0
    for participant, (known, own) in by_participant(owners).items():
        rows = np.flatnonzero(owners[asked] == participant)
        if not len(rows):
            continue
        foreign = ~(np.isin(blending.parents, own) & used).any(axis=1)
        scaling = fit_scaling(blending.vectors[known], owners[known].tolist(), scaling_rule)
        # Entries keep their parents' numbers, which are rows of all captured walks.
        others = replace(
            blending,
            vectors=blending.vectors[foreign],
            scaling=scaling,
            maps=blending.maps[foreign],
            parents=blending.parents[foreign],
            parent_weights=blending.parent_weights[foreign],
        )
        near, weights = others.neighbours(vectors[rows], min(k, len(others)), how)
        for row, entries, weight in zip(rows, near, weights, strict=True):
            parents = others.parents[entries]
            spread = weight[:, None] * others.parent_weights[entries]
            np.add.at(shares[row], parents[parents >= 0], spread[parents >= 0])
    return [shares @ np.asarray(values, dtype=float) for values in maps]


def mean_of_others(participants: Sequence[str], asked: Rows, maps: Array) -> Array:
    """(W, C) mean map of everybody else, for each walk asked for: what is left without any dependency."""
    owners = np.asarray(participants, dtype=str)
    means = {name: maps[known].mean(axis=0) for name, (known, _) in by_participant(owners).items()}
    return np.stack([means[owner] for owner in owners[asked]])


def candidate_table(evidence: Evidence, candidates: dict[str, tuple[float, ...]] | None = None) -> pd.DataFrame:
    """Scores of every kind and value of sharpness, every participant counting once.

    Returns
    -------
    DataFrame[model, kind, value, crps_s, energy_m, coverage_90, loss]; ``loss`` is the mean of CRPS and energy score, each
    relative to the smallest of its model and kind
    """
    rows = []
    for kind, values in (candidates or CANDIDATES).items():
        rows += [scored(evidence, "P_Prob", Sharpness(kind, value)) for value in values]  # type: ignore[arg-type]
    rows += [
        scored(evidence, "P_Prob without dependencies", Sharpness("exponent", value))
        for value in (candidates or CANDIDATES)["exponent"]
    ]
    table = pd.DataFrame(rows)
    best = table.groupby(["model", "kind"])[["crps_s", "energy_m"]].transform("min")
    return table.assign(loss=((table["crps_s"] / best["crps_s"] + table["energy_m"] / best["energy_m"]) / 2))


def scored(evidence: Evidence, model: str, sharpness: Sharpness) -> dict[str, Any]:
    """One row of :func:`candidate_table`, without its loss."""
    maps = evidence.metric if sharpness.kind == "temperature" else evidence.suitability
    density = sharpness.density(evidence.bare if model != "P_Prob" else maps, evidence.volumes)
    travel_s = evidence.traces.travel_s
    low, high = grid_quantiles(travel_s, density, (0.05, 0.95))[0].T
    scores = pd.DataFrame(
        {
            "crps_s": grid_crps(travel_s, density, evidence.captured_s),
            "energy_m": grid_energy(evidence.distances_m, density, evidence.traces.places_m, travel_s),
            "coverage_90": (low <= evidence.captured_s) & (evidence.captured_s <= high),
        }
    )
    means = scores.groupby(np.asarray(evidence.participants)).mean().mean()
    row: dict[str, Any] = {"model": model, "kind": sharpness.kind, "value": sharpness.value}
    return row | {str(name): float(value) for name, value in means.items()}


def best_value(table: pd.DataFrame, model: str = "P_Prob", kind: str = "exponent", by: str = "loss") -> float:
    """The value with the smallest loss; the flattest among equals."""
    rows = table[(table["model"] == model) & (table["kind"] == kind)]
    return float(rows.sort_values([by, "value"], kind="stable")["value"].iloc[0])


def extended_table(evidence: Evidence, exponents: Sequence[float] = EXTENDED_EXPONENTS) -> pd.DataFrame:
    """Scores of the model with a pace effect, its walks in the order given, and the effect fitted to all.

    The effect that forecasts a participant is fitted to the others' residuals.

    Returns
    -------
    DataFrame[model, kind, value, crps_s, coverage_90, loss (the CRPS), mean, person_sd, walk_sd]
    """
    rows = []
    for exponent in exponents:
        density = Sharpness("exponent", exponent).density(evidence.suitability, evidence.volumes)
        cells = grid_quantiles(evidence.traces.travel_s, density, levels(MEMBERS))[0]
        residuals = log_residuals(evidence.captured_s, cells)
        owners = np.asarray(evidence.participants, dtype=str)
        mean, sd, walk_sd = (np.empty(len(owners)) for _ in range(3))
        for known, own in by_participant(owners, least=3).values():
            effect = fit_pace(residuals[known], owners[known].tolist())
            mean[own], sd[own] = effect.posterior(residuals[own], owners[own].tolist())
            walk_sd[own] = effect.walk_sd
        scores = forecast_scores(evidence.captured_s, paced(cells, mean, sd, walk_sd, levels(MEMBERS)))
        means = scores[["crps_s", "covered"]].groupby(owners).mean().mean()
        effect = fit_pace(residuals, owners.tolist())
        row = {"model": "P_Prob (extended)", "kind": "exponent", "value": exponent, "crps_s": means["crps_s"]}
        row |= {"coverage_90": means["covered"], "loss": means["crps_s"]}
        rows.append(row | {"mean": effect.mean, "person_sd": effect.person_sd, "walk_sd": effect.walk_sd})
    return pd.DataFrame(rows)


def log_residuals(captured_s: Array, members_s: Array) -> Array:
    """(W,) logarithm of the captured travel time over the forecast's median."""
    return np.asarray(np.log(captured_s / np.median(members_s, axis=1)))


@dataclass(frozen=True)
class Calibration:
    """What was learned from the training walks.

    Attributes
    ----------
    exponent : of P_Prob (calibrated)
    bare_exponent : of P_Prob without dependencies
    extended_exponent, pace : of P_Prob (extended)
    """

    exponent: float
    bare_exponent: float
    extended_exponent: float
    pace: PaceEffect


def chosen(table: pd.DataFrame) -> Calibration:
    """The calibration that the tables of :func:`candidate_table` and :func:`extended_table`, stacked, speak for."""
    extended = best_value(table, "P_Prob (extended)")
    row = table[(table["model"] == "P_Prob (extended)") & (table["value"] == extended)].iloc[0]
    pace = PaceEffect(float(row["mean"]), float(row["person_sd"]), float(row["walk_sd"]))
    return Calibration(best_value(table), best_value(table, "P_Prob without dependencies"), extended, pace)


def evidence_of(
    walks: Sequence[Walk],
    routes: Mapping[str, Array],
    vectors: Array,
    scores: Array,
    normalisation: Normalisation,
    blending: BlendingSpace,
    asked: Rows,
    planner: Planner,
    space: ParameterSpace,
    standing: Standing,
    time_limit_s: float,
    k: int,
    how: Weighting,
    scaling_rule: ScalingRule = "standard_deviation",
) -> Evidence:
    """The evidence of the training walks ``asked`` (rows).

    Parameters
    ----------
    walks, vectors, scores : N training walks, their (N, D) run-time dependencies and (N, C) maps, in the order of ``blending``
    """
    people = [str(walk.row["participant"]) for walk in walks]
    suitability = normalise(scores, normalisation)
    blended, metric = blend_others(blending, people, asked, vectors[asked], (suitability, scores), k, how, scaling_rule)
    chosen_walks = [walks[row] for row in asked]
    traces, places = trace_walks(chosen_walks, routes, planner, space, standing, time_limit_s)
    return Evidence(
        [people[row] for row in asked],
        np.array([float(walk.row["duration_s"]) for walk in chosen_walks]),
        blended,
        metric,
        mean_of_others(people, asked, suitability),
        traces,
        captured_distances(traces, places),
        cell_volumes(space),
    )
