"""The exponent as a law of the dependencies: chosen by proper scores among what covers a new person, all on training walks.

"Sharpest subject to calibration" (Gneiting, Balabdaoui & Raftery 2007), with the level that a 90 % interval must hold in
training raised to ``0.9 (n + 1) / n`` for n people: that of conformal prediction when a new person is one more of the same kind
and all walks of a person share that person's weight (Lee, Barber & Willett 2023, hierarchical data).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.steering.sharpness import LADDER, SharpnessLaw

Array = NDArray[np.float64]

SLOPES = (-0.75, -0.5, -0.25, 0.25, 0.5, 0.75)
NOMINAL = 0.9


@dataclass(frozen=True)
class ExponentScores:
    """Scores of W training walks for every exponent of the ladder.

    Attributes
    ----------
    participants : (W,)
    vectors : (W, D) dependencies
    crps_s, energy_m, covered : (W, E)
    """

    participants: Sequence[str]
    vectors: Array
    crps_s: Array
    energy_m: Array
    covered: Array


def required_coverage(people: int) -> float:
    """Share of training walks that a 90 % interval must hold to hold 90 % of a new person's.

    Nine people or fewer can promise nothing, since it would have to hold all; then the nominal share itself is asked for.
    """
    asked = NOMINAL * (people + 1) / people
    return asked if asked < 1 - 1e-9 else NOMINAL


def laws_of(vectors: Array) -> list[SharpnessLaw]:
    """Every law that is tried: constants, and slopes over each dependency that varies."""
    found = [SharpnessLaw(level) for level in LADDER]
    spread = vectors.std(axis=0)
    for column in np.flatnonzero(spread > 1e-9 * np.maximum(np.abs(vectors).max(axis=0), 1.0)):
        centre, scale = float(vectors[:, column].mean()), float(spread[column])
        found += [SharpnessLaw(level, int(column), slope, centre, scale) for slope in SLOPES for level in LADDER]
    return found


def choose_law(scores: ExponentScores) -> tuple[SharpnessLaw, pd.DataFrame]:
    """The law for new people, and what each way of choosing one is worth.

    Returns
    -------
    law : the smallest mean of CRPS and energy score, each relative to the best constant, among the laws that hold
        :func:`required_coverage`; if none does, among those that hold most
    table : DataFrame[model, kind, crps_s, energy_m, coverage_90, loss], nested: every participant is scored by a law chosen
        without that participant's walks. Kinds: ``constant`` and ``law`` are chosen by the scores alone, ``covering constant``
        and ``covering law`` among what covers.
    """
    laws = laws_of(scores.vectors)
    rungs = np.stack([law.rungs(scores.vectors) for law in laws])
    walks = np.arange(len(scores.participants))
    names, owner = np.unique(np.asarray(scores.participants, dtype=str), return_inverse=True)
    shares = np.zeros((len(walks), len(names)))
    shares[walks, owner] = 1 / np.bincount(owner)[owner]
    # (laws, people): the mean of each person's walks
    crps, energy, covered = (
        values[walks, rungs] @ shares for values in (scores.crps_s, scores.energy_m, scores.covered.astype(float))
    )
    constant = np.array([law.column is None for law in laws])

    def best(known: NDArray[np.bool_], among: NDArray[np.bool_], covering: bool) -> int:
        means = [values[:, known].mean(axis=1) for values in (crps, energy, covered)]
        loss = (means[0] / means[0][constant].min() + means[1] / means[1][constant].min()) / 2
        enough = min(required_coverage(int(known.sum())), float(means[2][among].max())) if covering else 0.0
        allowed = among & (means[2] >= enough - 1e-9)
        return int(np.argmin(np.where(allowed, loss, np.inf)))

    everybody, every_law = np.ones(len(names), dtype=bool), np.ones(len(laws), dtype=bool)
    rows = []
    for kind, among, covering in (
        ("constant", constant, False),
        ("covering constant", constant, True),
        ("law", every_law, False),
        ("covering law", every_law, True),
    ):
        picks = [best(everybody & (np.arange(len(names)) != person), among, covering) for person in range(len(names))]
        means = [float(values[picks, np.arange(len(names))].mean()) for values in (crps, energy, covered)]
        rows.append({"model": "P_Prob", "kind": kind, "crps_s": means[0], "energy_m": means[1], "coverage_90": means[2]})
    table = pd.DataFrame(rows)
    table["loss"] = (table["crps_s"] / table["crps_s"].min() + table["energy_m"] / table["energy_m"].min()) / 2
    return laws[best(everybody, every_law, True)], table


def law_table(candidates: pd.DataFrame, law: SharpnessLaw, names: Sequence[str], vectors: Array, people: int) -> pd.DataFrame:
    """What the law was chosen by, and what it says, for figures.

    Parameters
    ----------
    candidates : DataFrame[model, kind, value, crps_s, coverage_90] of training
    names, vectors : (D,) and (N, D) of the training walks
    people : in training

    Returns
    -------
    DataFrame[scenario, model, quantity, at, value], scenario ``training``: ``crps_by_exponent`` and ``coverage_by_exponent`` (of
    90 % intervals); ``required_coverage`` at 0.9; ``crps_of_law`` and ``coverage_of_law``, nested, at the law's middle exponent;
    ``exponent_by_<dependency>`` over that dependency's range in training
    """
    constants = candidates[(candidates["model"] == "P_Prob") & (candidates["kind"] == "exponent")]
    nested = candidates[(candidates["model"] == "P_Prob") & (candidates["kind"] == "covering law")].iloc[0]
    column = law.column or 0
    places = np.linspace(vectors[:, column].min(), vectors[:, column].max(), 41)
    asked = np.zeros((len(places), vectors.shape[1]))
    asked[:, column] = places
    parts = {
        "crps_by_exponent": (constants["value"], constants["crps_s"]),
        "coverage_by_exponent": (constants["value"], constants["coverage_90"]),
        "required_coverage": ([NOMINAL], [required_coverage(people)]),
        "crps_of_law": ([law.level], [nested["crps_s"]]),
        "coverage_of_law": ([law.level], [nested["coverage_90"]]),
        f"exponent_by_{names[column]}": (places, law.exponents(asked)),
    }
    frames = [
        pd.DataFrame({"quantity": name, "at": np.asarray(at), "value": np.asarray(value)}) for name, (at, value) in parts.items()
    ]
    return pd.concat(frames, ignore_index=True).assign(scenario="training", model="P_Prob")
