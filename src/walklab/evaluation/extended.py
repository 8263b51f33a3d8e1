"""What P_Prob (extended) learns from training walks, leave-one-participant-out: neighbours, exponent, and people's pace."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.evaluation.folds import by_participant
from walklab.evaluation.scoring_rules import scoring_rules
from walklab.steering.learned import Pace
from walklab.steering.pace import fit_pace, fit_trend, rest_of, student
from walklab.steering.sharpness import Sharpness

Array = NDArray[np.float64]

EXPONENTS = (20.0, 40.0, 80.0, 160.0)
DEGREES = (0, 1, 2)
LEAST_S = 0.05  # a logarithm needs more than none; the shortest walks take ten times as long
LEAST_PEOPLE = 3


@dataclass(frozen=True)
class LogTimes:
    """Mean and variance of the logarithm of the travel time under a density, (W,) each."""

    mean: Array
    variance: Array


def log_times(travel_s: NDArray, density: Array) -> LogTimes:
    """Moments over the cells, (W, C) each."""
    logs = np.log(np.maximum(np.asarray(travel_s, dtype=float), LEAST_S))
    mean = (logs * density).sum(axis=1)
    return LogTimes(mean, np.maximum((logs**2 * density).sum(axis=1) - mean**2, 0.0))


def personal_columns(vectors: Array, participants: Sequence[str]) -> tuple[int, ...]:
    """Dependencies that never change within a person, but do between people: height is one.

    They have as many values as there are people; whether they help must be learned, too.
    """
    owners = np.asarray(participants, dtype=str)
    within = np.max([np.ptp(vectors[owners == owner], axis=0) for owner in np.unique(owners)], axis=0)
    return tuple(int(column) for column in np.flatnonzero((within < 1e-9) & (np.ptp(vectors, axis=0) > 1e-9)))


def extended_table(
    travel_s: NDArray,
    captured_s: Array,
    participants: Sequence[str],
    vectors: Array,
    names: Sequence[str],
    maps: Mapping[tuple[int, ...], Array],
    volumes: Array,
    exponents: Sequence[float] = EXPONENTS,
) -> tuple[pd.DataFrame, list[Pace]]:
    """Scores of every way to extend the model, its walks in the order given, and what each learns from all walks.

    The pace that forecasts a participant is learned from the others. Forecasts are scored as log-normal.

    Parameters
    ----------
    travel_s, captured_s, participants, vectors, names : (W, C), (W,), (W,), (W, D) and (D,) of the training walks
    maps : ignored columns -> (W, C) blends of *other* participants' suitability
    volumes : (C,)

    Returns
    -------
    table : DataFrame[model, kind, value (exponent), ignored, degree, crps_s, coverage_90, crps_earlier_s, coverage_earlier_90,
        loss]: of somebody new, and with the person's earlier walks; loss is the mean of both CRPS, each relative to the smallest
    paces : one per row
    """
    rows, paces = [], []
    for ignored, blended in maps.items():
        personal = personal_columns(vectors, participants)
        columns = [column for column in range(vectors.shape[1]) if column not in personal]
        for exponent in exponents:
            moments = log_times(travel_s, Sharpness("exponent", exponent).density(blended, volumes))
            for degree in DEGREES:
                learner = _Learner(
                    moments, captured_s, np.asarray(participants, dtype=str), vectors, columns, list(names), degree
                )
                row = {"model": "P_Prob (extended)", "kind": "exponent", "value": exponent, "degree": degree}
                row["ignored"] = " ".join(names[column] for column in ignored)
                rows.append(row | learner.scores())
                paces.append(learner.learn(np.arange(len(captured_s)), exponent, ignored))
    table = pd.DataFrame(rows)
    table["loss"] = sum(table[name] / table[name].min() for name in ("crps_s", "crps_earlier_s")) / 2
    return table, paces


@dataclass(frozen=True)
class _Learner:
    """One way to extend the model, on the training walks."""

    moments: LogTimes
    captured_s: Array
    owners: NDArray[np.str_]
    vectors: Array
    columns: list[int]
    names: list[str]
    degree: int

    def learn(self, known: NDArray[np.int64], exponent: float, ignored: tuple[int, ...]) -> Pace:
        """The pace from some of the walks."""
        residuals = np.log(self.captured_s[known]) - self.moments.mean[known]
        people = self.owners[known].tolist()
        logged = [self.names[column] == "length" for column in self.columns]
        trend = fit_trend(residuals, self.vectors[known], people, self.columns, logged, self.degree)
        left = residuals - trend(self.vectors[known])
        return Pace(exponent, ignored, trend, fit_pace(left, people), rest_of(left, people, self.moments.variance[known]))

    def scores(self) -> dict[str, float]:
        """Leave-one-participant-out, without and with the person's earlier walks; participants count the same."""
        mean, spread = np.empty((2, len(self.owners))), np.empty((2, len(self.owners)))
        freedom = np.empty((2, len(self.owners)))
        for known, own in by_participant(self.owners, least=LEAST_PEOPLE).values():
            pace = self.learn(known, 1.0, ())
            start = self.moments.mean[own] + pace.trend(self.vectors[own])
            earlier = pace.effect.posterior(np.log(self.captured_s[own]) - start, self.owners[own].tolist())
            nobody = np.full(len(own), pace.effect.mean), np.full(len(own), pace.effect.new_person_sd)
            for place, (effect, sd) in enumerate((nobody, earlier)):
                mean[place, own] = start + effect
                rest = np.sqrt(self.moments.variance[own] + pace.rest_sd**2)
                spread[place, own], freedom[place, own] = np.hypot(sd, rest), pace.effect.freedom(sd, float(rest.mean()))
        found: dict[str, float] = {}
        rules = scoring_rules()
        for place, suffix in enumerate(("", "_earlier")):
            crps = np.asarray(rules.crps_lognormal(self.captured_s, mean[place], spread[place], backend="numpy"))
            reach = student(0.95, freedom[place]) * spread[place]
            covered = np.abs(np.log(self.captured_s) - mean[place]) <= reach
            by_person = pd.DataFrame({"crps": crps, "covered": covered}).groupby(self.owners).mean().mean()
            found |= {f"crps{suffix}_s": float(by_person["crps"]), f"coverage{suffix}_90": float(by_person["covered"])}
        return found
