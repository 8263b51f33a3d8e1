"""The verdict on every published claim, by rules fixed before the first run (``config/papers/*.yaml``),
which the history, one commit for both, cannot prove.

The rule (DESIGN, principle 9). A claim with a figure is *reproduced* if its direction holds and our 95 %
interval contains the published figure, *partly* reproduced if only the direction holds, and *not reproduced*
otherwise; where the paper states no direction, the interval alone decides between the first and the last.
A statement is *reproduced* if all its parts hold, *partly* if some do. *Not checkable* carries its reason.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

from walklab.errors import InputError
from walklab.evaluation.rules import MissingRow, holds, lookup, rule_problem, selector_problem

REPRODUCED, PARTLY, NOT_REPRODUCED, NOT_CHECKABLE = "reproduced", "partly", "not reproduced", "not checkable"

# The C loader is safe as well and 10 times as fast; not every build of PyYAML has it.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_TOP_KEYS = {"paper", "inputs", "claims", "inconsistencies", "verdicts"}
_VERDICT_KEYS = {"id", "section", "statement", "published", "reading", "compare"}
_VERDICT_KEYS |= {"ours", "direction", "parts", "not_checkable", "note"}
_COMPARISONS = ("contains", "at_most")


@dataclass(frozen=True)
class Claim:
    """One published claim and the rule of its verdict.

    Attributes
    ----------
    id, section, statement : what is claimed, and where
    published : paths of the published figures under ``claims``; the verdict is on the first
    figure : the published value as it stands (number, range or words)
    reading : (low, high) that the published figure stands for, where it is rounded or a range
    compare : ``contains``: our interval must meet the reading; ``at_most``: must reach down to it
    ours : where our value is: ``{table, where, value, low, high}``
    direction : rules that must all hold (see ``rules.py``); empty where no direction is stated
    parts : of a statement: rules of which all, some or none hold
    not_checkable : why no run can decide it
    note : printed beside the verdict
    """

    id: str
    section: str
    statement: str
    published: tuple[str, ...]
    figure: Any
    reading: tuple[float, float] | None = None
    compare: str = "contains"
    ours: Mapping[str, Any] | None = None
    direction: tuple[Mapping[str, Any], ...] = ()
    parts: tuple[Mapping[str, Any], ...] = ()
    not_checkable: str = ""
    note: str = ""


@dataclass(frozen=True)
class Paper:
    """A paper's published inputs and claims, our verdict rules and our reading of its inconsistencies."""

    name: str
    inputs: Mapping[str, Any]
    claims: tuple[Claim, ...]
    inconsistencies: tuple[Mapping[str, str], ...] = field(default=())


def load_paper(path: str | Path) -> Paper:
    """Read and check the file of a paper.

    Raises
    ------
    InputError
        If the file is missing or no YAML, a key is unknown or absent, an id stands twice, a path leads to no
        published figure, a rule is malformed, or a published figure has no verdict.
    """
    try:
        data = yaml.load(Path(path).read_text(), Loader=_LOADER)
    except OSError as error:
        raise InputError(f"{path}: no such file; the papers' figures are under config/papers/") from error
    except yaml.YAMLError as error:
        raise InputError(f"{path}: not valid YAML ({str(error).splitlines()[0]})") from error
    if not isinstance(data, dict) or set(data) != _TOP_KEYS:
        found = sorted(data) if isinstance(data, dict) else type(data).__name__
        raise InputError(f"{path}: needs exactly the keys {sorted(_TOP_KEYS)}, has {found}")
    claims = tuple(_claim(entry, data["claims"], f"{path}: verdicts[{index}]") for index, entry in enumerate(data["verdicts"]))
    ids = [claim.id for claim in claims]
    if twice := sorted({name for name in ids if ids.count(name) > 1}):
        raise InputError(f"{path}: verdicts: id {twice[0]} stands twice; rename one")
    covered = {at for claim in claims for at in claim.published}
    if missing := [at for at, _ in published_figures(data["claims"]) if at not in covered]:
        raise InputError(
            f"{path}: verdicts: published figure claims.{missing[0]} has no verdict ({len(missing)} in all); add one"
        )
    for index, entry in enumerate(data["inconsistencies"]):
        if not isinstance(entry, dict) or set(entry) != {"text", "reading"} or not all(entry.values()):
            raise InputError(f"{path}: inconsistencies[{index}]: needs exactly text and reading")
    return Paper(data["paper"], data["inputs"], claims, tuple(data["inconsistencies"]))


def published_figures(claims: Any, at: str = "") -> Iterator[tuple[str, Any]]:
    """Every published figure with its path: keys and list positions joined by dots, a statement by its id."""
    if isinstance(claims, dict) and set(claims) == {"id", "section", "text"}:
        yield at, claims["text"]
    elif isinstance(claims, dict):
        for key, value in claims.items():
            yield from published_figures(value, f"{at}.{key}" if at else str(key))
    elif isinstance(claims, list):
        for index, value in enumerate(claims):
            key = value["id"] if isinstance(value, dict) and "id" in value else index
            yield from published_figures(value, f"{at}.{key}")
    else:
        yield at, claims


def _claim(entry: Any, published: Mapping[str, Any], place: str) -> Claim:
    if not isinstance(entry, dict):
        raise InputError(f"{place}: is no mapping; see the other verdicts")
    if unknown := set(entry) - _VERDICT_KEYS:
        raise InputError(f"{place}: unknown key {sorted(unknown)[0]}; known are {sorted(_VERDICT_KEYS)}")
    if missing := {"id", "section", "statement", "published"} - set(entry):
        raise InputError(f"{place}: needs {sorted(missing)[0]}")
    place = f"{place} ({entry['id']})"
    paths = tuple([entry["published"]] if isinstance(entry["published"], str) else entry["published"])
    figures = dict(published_figures(published))
    for at in paths:
        if at not in figures:
            raise InputError(f"{place}: published: there is no figure claims.{at}")
    if sum(key in entry for key in ("ours", "parts", "not_checkable")) != 1 and "not_checkable" not in entry:
        raise InputError(f"{place}: needs one of ours (a figure), parts (a statement) or not_checkable (a reason)")
    if "direction" not in entry and "ours" in entry and "not_checkable" not in entry:
        raise InputError(f"{place}: needs direction: a list of rules, empty where the paper states none")
    if "ours" in entry and (problem := selector_problem(entry["ours"])):
        raise InputError(f"{place}: ours: {problem}")
    for rule in [*entry.get("direction", []), *entry.get("parts", [])]:
        if problem := rule_problem(rule):
            raise InputError(f"{place}: rule {rule}: {problem}")
    if entry.get("compare", "contains") not in _COMPARISONS:
        raise InputError(f"{place}: compare: {entry['compare']!r} is not one of {_COMPARISONS}")
    reading = entry.get("reading")
    if reading is not None and not (isinstance(reading, list) and len(reading) == 2 and reading[0] <= reading[1]):
        raise InputError(f"{place}: reading: {reading!r} is not [low, high]")
    if reading is None and "ours" in entry and not isinstance(figures[paths[0]], int | float):
        raise InputError(f"{place}: reading: [low, high] is needed, since the published figure is no number")
    return Claim(
        entry["id"],
        str(entry["section"]),
        entry["statement"],
        paths,
        figures[paths[0]],
        None if reading is None else (float(reading[0]), float(reading[1])),
        entry.get("compare", "contains"),
        entry.get("ours"),
        tuple(entry.get("direction", ())),
        tuple(entry.get("parts", ())),
        entry.get("not_checkable", ""),
        entry.get("note", ""),
    )


def check_claims(paper: Paper, tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Hold every claim against the tables of a run.

    Parameters
    ----------
    tables : name -> table, as the verdicts' ``ours`` and rules name them; a run without one of them
        makes its claims not checkable

    Returns
    -------
    DataFrame[id, section, statement, published, ours, ours_low, ours_high, verdict, note]
    """
    return pd.DataFrame([_check(claim, tables) for claim in paper.claims])


def _check(claim: Claim, tables: Mapping[str, pd.DataFrame]) -> dict[str, Any]:
    ours, verdict, notes = (np.nan, np.nan, np.nan), NOT_CHECKABLE, [claim.note]
    try:
        if claim.not_checkable:
            notes.append(claim.not_checkable)
        elif claim.parts:
            verdict, failed = _judge_statement(claim, tables)
            notes.append(f"{len(claim.parts) - len(failed)} of {len(claim.parts)} parts hold")
            notes += [f"does not hold: {text}" for text in failed]
        elif claim.ours is not None:
            ours = lookup(tables, claim.ours)
            verdict, failed = _judge_figure(claim, ours, tables)
            notes += [f"direction does not hold: {text}" for text in failed]
            if verdict == REPRODUCED and _includes_no_effect(claim, ours):
                notes.append(f"the interval is wide and includes no effect ({ours[1]:.3g} to {ours[2]:.3g})")
    except MissingRow as missing:
        ours, verdict = (np.nan, np.nan, np.nan), NOT_CHECKABLE
        notes.append(f"this run has {missing}")
    return {
        "id": claim.id,
        "section": claim.section,
        "statement": claim.statement,
        "published": "" if claim.published[0].startswith("statements.") else _words(claim.figure),
        "ours": ours[0],
        "ours_low": ours[1],
        "ours_high": ours[2],
        "verdict": verdict,
        "note": "; ".join(text for text in notes if text),
    }


def _judge_figure(claim: Claim, ours: tuple[float, float, float], tables: Mapping[str, pd.DataFrame]) -> tuple[str, list[str]]:
    value, low, high = ours
    if not np.isfinite(value):
        raise MissingRow("no value for it (not a number)")
    failed = [text for rule in claim.direction for ok, text in [holds(rule, tables, claim.ours)] if not ok]
    if failed:
        return NOT_REPRODUCED, failed
    # Without an interval (one participant, or a quantity without variation) the value has to meet the figure by itself.
    low, high = (low, high) if np.isfinite(low) and np.isfinite(high) else (value, value)
    smallest, largest = claim.reading or (float(claim.figure), float(claim.figure))
    met = low <= largest if claim.compare == "at_most" else low <= largest and high >= smallest
    if met:
        return REPRODUCED, []
    return (PARTLY if claim.direction else NOT_REPRODUCED), []


def _includes_no_effect(claim: Claim, ours: tuple[float, float, float]) -> bool:
    """Whether an effect is claimed (above zero) that our interval leaves open."""
    return any(rule.get("above") == 0 and "at" not in rule for rule in claim.direction) and ours[1] <= 0


def _judge_statement(claim: Claim, tables: Mapping[str, pd.DataFrame]) -> tuple[str, list[str]]:
    outcomes = [holds(rule, tables, claim.ours) for rule in claim.parts]
    failed = [text for ok, text in outcomes if not ok]
    if not failed:
        return REPRODUCED, []
    return (PARTLY if len(failed) < len(outcomes) else NOT_REPRODUCED), failed


def _words(figure: Any) -> str:
    return f"{figure:g}" if isinstance(figure, int | float) else str(figure)


def inconsistency_table(paper: Paper) -> pd.DataFrame:
    """What does not fit together in the paper, and how we read it: DataFrame[number, text, reading]."""
    rows = [{"number": i, "text": entry["text"], "reading": entry["reading"]} for i, entry in enumerate(paper.inconsistencies, 1)]
    return pd.DataFrame(rows, columns=["number", "text", "reading"])
