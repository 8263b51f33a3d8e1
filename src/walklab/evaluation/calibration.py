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
from walklab.evaluation.extended import LEAST_PEOPLE, extended_table, personal_columns
from walklab.evaluation.folds import by_participant
from walklab.evaluation.grid_scores import captured_distances, grid_crps, grid_energy, grid_quantiles
from walklab.evaluation.sharpness_law import ExponentScores, choose_law
from walklab.evaluation.tracing import trace_walks
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.planning.tracing import Traces
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.learned import Pace
from walklab.steering.pace import PaceEffect, Trend
from walklab.steering.scaling import ScalingRule, fit_scaling
from walklab.steering.sharpness import LADDER, Kind, Sharpness, SharpnessLaw, cell_volumes
from walklab.steering.space import ParameterSpace
from walklab.steering.suitability import Normalisation, normalise
from walklab.steering.weighting import Weighting

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

MEMBERS = 200
CANDIDATES: dict[Kind, tuple[float, ...]] = {
    "exponent": LADDER,
    "threshold": (0.5, 0.7, 0.8, 0.85, 0.9, 0.95),
    "temperature": (0.03, 0.05, 0.07, 0.1, 0.14, 0.2),
}
BARE = "P_Prob without dependencies"


@dataclass(frozen=True)
class Evidence:
    """Training walks to learn the sharpness from, with what their cells and others' maps say.

    Attributes
    ----------
    participants : (W,) who walked
    captured_s : (W,) travel times
    vectors, names : (W, D) run-time dependencies and their names
    suitability, metric, bare : (W, C) blends of *other* participants' suitability and metric, and their mean suitability
    impersonal : suitability blended without the dependencies that a person carries along (see ``personal_columns``)
    traces : of the W walks
    distances_m : (W, C) of every cell's trajectory from the captured one
    volumes : (C,)
    """

    participants: Sequence[str]
    captured_s: Array
    vectors: Array
    names: Sequence[str]
    suitability: Array
    metric: Array
    bare: Array
    impersonal: Array
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
    ignored: Sequence[int] = (),
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
    ignored : dependencies (columns) without which neighbours are searched

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
        scaling.scale[list(ignored)] = np.inf
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


@dataclass(frozen=True)
class _WalkScores:
    """Scores of a density on every training walk: (W,) each."""

    crps_s: Array
    energy_m: Array
    covered: NDArray[np.bool_]


def candidate_table(
    evidence: Evidence, candidates: Mapping[Kind, Sequence[float]] | None = None
) -> tuple[pd.DataFrame, SharpnessLaw]:
    """Scores of every kind and value of sharpness, every participant counting once, and the law for new people.

    Returns
    -------
    table : DataFrame[model, kind, value, crps_s, energy_m, coverage_90, loss]; ``loss`` is the mean of CRPS and energy score,
        each relative to the smallest of its model and kind; then the rows of :func:`walklab.evaluation.sharpness_law.choose_law`
    law : from there
    """
    order = np.argsort(evidence.traces.travel_s.astype(float), axis=1, kind="stable")
    rows, ladder = [], []
    for kind, values in (candidates or CANDIDATES).items():
        for value in values:
            maps = evidence.metric if kind == "temperature" else evidence.suitability
            scores = _scores_of(evidence, maps, Sharpness(kind, value), order)
            rows.append(_row(evidence, "P_Prob", kind, value, scores))
            if kind == "exponent":
                ladder.append((value, scores))
    for value, _ in ladder:
        rows.append(
            _row(evidence, BARE, "exponent", value, _scores_of(evidence, evidence.bare, Sharpness("exponent", value), order))
        )
    table = pd.DataFrame(rows)
    best = table.groupby(["model", "kind"])[["crps_s", "energy_m"]].transform("min")
    table["loss"] = (table["crps_s"] / best["crps_s"] + table["energy_m"] / best["energy_m"]) / 2
    stacks = (np.stack([getattr(scores, name) for _, scores in ladder], axis=1) for name in ("crps_s", "energy_m", "covered"))
    law, laws = choose_law(ExponentScores(evidence.participants, evidence.vectors, *stacks))
    return pd.concat([table, laws], ignore_index=True), law


def _scores_of(evidence: Evidence, maps: Array, sharpness: Sharpness, order: Rows) -> _WalkScores:
    density, travel_s = sharpness.density(maps, evidence.volumes), evidence.traces.travel_s
    low, high = grid_quantiles(travel_s, density, (0.05, 0.95), order)[0].T
    return _WalkScores(
        grid_crps(travel_s, density, evidence.captured_s, order),
        grid_energy(evidence.distances_m, density, evidence.traces.places_m, travel_s, order),
        (low <= evidence.captured_s) & (evidence.captured_s <= high),
    )


def _row(evidence: Evidence, model: str, kind: Kind, value: float, scores: _WalkScores) -> dict[str, Any]:
    columns = {"crps_s": scores.crps_s, "energy_m": scores.energy_m, "coverage_90": scores.covered.astype(float)}
    means = pd.DataFrame(columns).groupby(np.asarray(evidence.participants)).mean().mean()
    return {"model": model, "kind": kind, "value": value} | {str(name): float(mean) for name, mean in means.items()}


def best_value(table: pd.DataFrame, model: str = "P_Prob", kind: str = "exponent", by: str = "loss") -> float:
    """The value with the smallest loss; the flattest among equals."""
    rows = table[(table["model"] == model) & (table["kind"] == kind)]
    return float(rows.sort_values([by, "value"], kind="stable")["value"].iloc[0])


@dataclass(frozen=True)
class Calibration:
    """What was learned from the training walks.

    Attributes
    ----------
    law : exponent of P_Prob (calibrated)
    bare_exponent : of P_Prob without dependencies
    pace : of P_Prob (extended)
    """

    law: SharpnessLaw
    bare_exponent: float
    pace: Pace


def learn_calibration(
    evidence: Evidence, candidates: Mapping[Kind, Sequence[float]] | None = None
) -> tuple[Calibration, pd.DataFrame]:
    """Everything that is learned, and the table of all candidates it was chosen from.

    With fewer than three participants no pace can be told from a walk's own spread; the extended model then has none.
    """
    table, law = candidate_table(evidence, candidates)
    bare = best_value(table, BARE)
    people = len(set(evidence.participants))
    if people < LEAST_PEOPLE:
        flat = Trend((), (), (), (), (), (), 0, (0.0,))
        return Calibration(law, bare, Pace(best_value(table), (), flat, PaceEffect(0.0, 0.0, 0.0), 0.0)), table
    maps: dict[tuple[int, ...], Array] = {(): evidence.suitability}
    if personal := personal_columns(evidence.vectors, evidence.participants):
        maps[personal] = evidence.impersonal
    walks = (evidence.traces.travel_s, evidence.captured_s, evidence.participants, evidence.vectors, evidence.names)
    extended, paces = extended_table(*walks, maps, evidence.volumes)
    return Calibration(law, bare, paces[int(np.argmin(extended["loss"]))]), pd.concat([table, extended], ignore_index=True)


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
    ask = (blending, people, asked, vectors[asked])
    blended, metric = blend_others(*ask, (suitability, scores), k, how, scaling_rule)
    impersonal = blended
    if personal := personal_columns(vectors, people):
        (impersonal,) = blend_others(*ask, (suitability,), k, how, scaling_rule, personal)
    chosen_walks = [walks[row] for row in asked]
    traces, places = trace_walks(chosen_walks, routes, planner, space, standing, time_limit_s)
    return Evidence(
        [people[row] for row in asked],
        np.array([float(walk.row["duration_s"]) for walk in chosen_walks]),
        vectors[asked],
        blending.names,
        blended,
        metric,
        mean_of_others(people, asked, suitability),
        impersonal,
        traces,
        captured_distances(traces, places),
        cell_volumes(space),
    )
