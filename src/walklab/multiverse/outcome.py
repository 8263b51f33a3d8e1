"""The outcome of one specification, and of all."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from walklab.errors import InputError
from walklab.evaluation.claims import Paper
from walklab.multiverse.population import Population
from walklab.multiverse.specifications import Specification
from walklab.multiverse.study import StudySettings, run_study
from walklab.multiverse.verdicts import verdicts

RAN, FAILED = "ran", "failed"
Outcome = dict[str, Any]


def evaluate(
    specification: Specification, population: Population, settings: StudySettings, paper: Paper, ablate: bool
) -> tuple[pd.DataFrame, Outcome]:
    """Claims (see :func:`walklab.multiverse.verdicts.verdicts`) with the specification's name and kind, and its outcome.

    The outcome is plain data: specification, outcome, reason (empty), walks of training and of each scenario, P_Stat's
    optimum, the learned exponent (its level), and P_Stat's and P_Prob's shares of simulated walks that did not arrive.
    """
    study = run_study(population, specification.choices, settings, ablate)
    found = verdicts(study, paper, settings.seed, settings.replicate, settings.bootstraps)
    found.insert(0, "specification", specification.name)
    found.insert(1, "kind", specification.kind)
    outcome: Outcome = {"specification": specification.name, "outcome": RAN, "reason": ""}
    outcome["walks_training"] = len(population.training)
    outcome |= {f"walks_{name}": len(walks) for name, walks in population.scenarios.items()}
    outcome |= {f"static_{name}": value for name, value in zip(study.static.names, study.static.optimum, strict=True)}
    outcome["exponent"] = study.exponent
    description = study.tables["description"]
    for model in ("P_Stat", "P_Prob"):
        rows = description[description["model"] == model]
        outcome[f"not_arrived_{model}"] = float(np.round(rows["not_arrived"].sum() / rows["n"].sum(), 9))
    return found, outcome


def attempt(specification: Specification, run: Callable[[], tuple[pd.DataFrame, Outcome]]) -> tuple[pd.DataFrame, Outcome]:
    """What ``run`` returns, or no claims and the reason: a specification that nobody tried before may fail in any way."""
    try:
        return run()
    except Exception as error:
        logging.getLogger(__name__).exception("specification %s", specification.name)
        return pd.DataFrame(), failed(specification, error)


def failed(specification: Specification, error: Exception) -> Outcome:
    """The outcome of a specification that could not be run, with the reason in one line."""
    words = " ".join(str(error).split()) or "no message"
    reason = words if isinstance(error, InputError) else f"{type(error).__name__}: {words}"
    return {"specification": specification.name, "outcome": FAILED, "reason": reason}


def collect(
    table: pd.DataFrame, claims: Sequence[pd.DataFrame], outcomes: Sequence[Mapping[str, Any]]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Claims of all specifications, each with what its specification changed, and the specifications with their outcomes.

    Parameters
    ----------
    table : from :func:`walklab.multiverse.table.specification_table`
    claims, outcomes : of every specification, in its order; a failed one has no claims

    Raises
    ------
    InputError
        If not a single specification could be run.
    """
    specifications = table.merge(pd.DataFrame(list(outcomes)), on="specification", how="left", validate="one_to_one")
    found = [rows for rows in claims if len(rows)]
    if not found:
        raise InputError(f"multiverse: none of {len(table)} specifications could be run; the first: {outcomes[0]['reason']}")
    every = pd.concat(found, ignore_index=True)
    every.insert(2, "changed", every["specification"].map(table.set_index("specification")["changed"]).fillna(""))
    return every, specifications
