"""Rules by name, which say what must hold between the numbers of a run's tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from walklab.errors import InputError

Selector = Mapping[str, Any]
Tables = Mapping[str, pd.DataFrame]
Number = tuple[float, float, float]

TIE = 1e-9  # times are multiples of the step: a difference below this is rounding, not a direction

_SELECTOR_KEYS = {"table", "where", "value", "low", "high"}


class MissingRow(LookupError):
    """A table or a row that this run does not have."""


def select(tables: Tables, selector: Selector) -> pd.DataFrame:
    """The rows of ``selector["table"]`` whose columns equal ``selector["where"]``."""
    name = selector["table"]
    if name not in tables:
        raise MissingRow(f"no table {name}")
    table = tables[name]
    chosen = np.ones(len(table), dtype=bool)
    for column, value in selector.get("where", {}).items():
        if column not in table:
            raise InputError(f"claims: table {name} has no column {column}; correct the verdict's selector")
        chosen &= np.isclose(table[column], value) if isinstance(value, int | float) else (table[column] == value).to_numpy()
    if not chosen.any():
        raise MissingRow(f"no row {_where(selector)} in table {name}")
    return table[chosen]


def lookup(tables: Tables, selector: Selector) -> Number:
    """Value, low and high of the one row that a selector names; NaN where the table has no interval.

    Raises
    ------
    MissingRow
        If the run has no such table or row.
    InputError
        If the selector names several rows or an unknown column.
    """
    rows = select(tables, selector)
    if len(rows) > 1:
        raise InputError(f"claims: {_where(selector)} names {len(rows)} rows of table {selector['table']}; make it name one")
    row = rows.iloc[0]
    value = selector.get("value", "value")
    if value not in row:
        raise InputError(f"claims: table {selector['table']} has no column {value}; correct the verdict's selector")
    low, high = selector.get("low", "low"), selector.get("high", "high")
    return float(row[value]), float(row.get(low, np.nan)), float(row.get(high, np.nan))


def merged(base: Selector | None, change: Any) -> Selector:
    """A selector with some of its conditions replaced: ``{model: P_Stat}`` or a whole ``{table, where, ...}``."""
    if isinstance(change, Mapping) and "table" in change:
        return change
    own = base or {}
    if isinstance(change, Mapping) and set(change) <= _SELECTOR_KEYS and change:
        return {**own, **change, "where": {**own.get("where", {}), **change.get("where", {})}}
    return {**own, "where": {**own.get("where", {}), **(change or {})}}


def _where(selector: Selector) -> str:
    return ", ".join(f"{key}={value}" for key, value in selector.get("where", {}).items()) or "(any)"


def _number(tables: Tables, selector: Selector) -> float:
    value = lookup(tables, selector)[0]
    if not np.isfinite(value):
        raise MissingRow(f"no finite value for {_where(selector)} in table {selector['table']}")
    return value


def _less_than(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value, other = _number(tables, own), _number(tables, merged(own, argument))
    return value < other - TIE, f"{_where(own)}: {value:.4g} is not less than {other:.4g} ({_where(merged(own, argument))})"


def _greater_than(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value, other = _number(tables, own), _number(tables, merged(own, argument))
    return value > other + TIE, f"{_where(own)}: {value:.4g} is not greater than {other:.4g} ({_where(merged(own, argument))})"


def _below(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value = _number(tables, own)
    return value < argument, f"{_where(own)}: {value:.4g} is not below {argument}"


def _above(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value = _number(tables, own)
    return value > argument, f"{_where(own)}: {value:.4g} is not above {argument}"


def _magnitude_below(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value = _number(tables, own)
    return abs(value) < argument, f"{_where(own)}: |{value:.4g}| is not below {argument}"


def _every_below(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    values = select(tables, own)[own.get("value", "value")]
    return bool((values < argument).all()), f"{_where(own)}: the largest, {values.max():.4g}, is not below {argument}"


def _every_above(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    values = select(tables, own)[own.get("value", "value")]
    return bool((values > argument).all()), f"{_where(own)}: the smallest, {values.min():.4g}, is not above {argument}"


def _largest_of(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value = _number(tables, own)
    others = {_where(merged(own, change)): _number(tables, merged(own, change)) for change in argument}
    largest = max(others, key=lambda name: others[name])
    return value > others[largest] + TIE, f"{_where(own)}: {value:.4g} is not the largest ({largest}: {others[largest]:.4g})"


def _within_share_of(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value, other = _number(tables, own), _number(tables, merged(own, argument["of"]))
    off = abs(value / other - 1)
    return off <= argument["share"], f"{_where(own)}: {value:.4g} is {off:.1%} off {other:.4g}"


def _differs_at_most(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    value, other = _number(tables, own), _number(tables, merged(own, argument["from"]))
    return abs(value - other) <= argument[
        "by"
    ], f"{_where(own)}: {value:.4g} and {other:.4g} differ by more than {argument['by']}"


def _interval_contains(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    _, low, high = lookup(tables, own)
    other = _number(tables, merged(own, argument))
    return bool(low <= other <= high), f"{_where(own)}: interval {low:.4g} to {high:.4g} does not contain {other:.4g}"


def _gain_shrinks(argument: Any, own: Selector, tables: Tables) -> tuple[bool, str]:
    first, middle, last = (_number(tables, merged(own, change)) for change in argument)
    return first - middle > middle - last, f"falls by {first - middle:.4g}, then by {middle - last:.4g}"


# Rule name -> what it asks of the number (or rows) it is applied to, "ours" unless the rule brings its own selector.
RULES: dict[str, Callable[[Any, Selector, Tables], tuple[bool, str]]] = {
    "less_than": _less_than,  # another row of the table, named by what differs
    "greater_than": _greater_than,
    "below": _below,  # a constant
    "above": _above,
    "magnitude_below": _magnitude_below,
    "every_below": _every_below,  # all rows that the selector names
    "every_above": _every_above,
    "largest_of": _largest_of,  # a list of other rows
    "within_share_of": _within_share_of,  # {of: another row, share: relative distance}
    "differs_at_most": _differs_at_most,  # {from: another row, by: distance}
    "interval_contains": _interval_contains,  # our interval contains the value of another row
    "gain_shrinks": _gain_shrinks,  # three rows: the first step down is larger than the second
}


_NUMBERS = {"below", "above", "magnitude_below", "every_below", "every_above"}
_ROWS = {"less_than", "greater_than", "interval_contains"}
_LISTS = {"largest_of": 1, "gain_shrinks": 3}
_PAIRS = {"within_share_of": ("of", "share"), "differs_at_most": ("from", "by")}


def rule_problem(rule: Any) -> str:
    """What is wrong with a rule's form, or nothing. A rule is ``{<name>: argument}``, with ``at: selector`` if not on ours."""
    if not isinstance(rule, Mapping):
        return "is no mapping"
    names = set(rule) - {"at"}
    if len(names) != 1 or not names <= set(RULES):
        return f"needs exactly one of {sorted(RULES)}"
    name = names.pop()
    return _argument_problem(name, rule[name]) or (selector_problem(rule["at"], whole=False) if "at" in rule else "")


def _argument_problem(name: str, argument: Any) -> str:
    if name in _NUMBERS:
        return "" if _is_number(argument) else f"{name} needs a number, has {argument!r}"
    if name in _ROWS:
        good = isinstance(argument, Mapping) and len(argument) > 0
        return "" if good else f"{name} needs what differs in the other row, e.g. {{model: P_Stat}}"
    if name in _LISTS:
        good = isinstance(argument, list) and len(argument) >= _LISTS[name] and all(isinstance(row, Mapping) for row in argument)
        return "" if good else f"{name} needs a list of at least {_LISTS[name]} rows"
    row, number = _PAIRS[name]
    good = isinstance(argument, Mapping) and set(argument) == {row, number}
    good = good and isinstance(argument[row], Mapping) and _is_number(argument[number])
    return "" if good else f"{name} needs {row} and {number}"


def selector_problem(selector: Any, whole: bool = True) -> str:
    """What is wrong with a selector's form, or nothing; one that is not whole only changes conditions of ours."""
    if not isinstance(selector, Mapping):
        return "a selector is a mapping"
    if whole and "table" not in selector:
        return "a selector needs table"
    if "table" in selector and not set(selector) <= _SELECTOR_KEYS:
        return f"a selector has only the keys {sorted(_SELECTOR_KEYS)}"
    return "" if isinstance(selector.get("where", {}), Mapping) else "where: needs column: value"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def holds(rule: Mapping[str, Any], tables: Tables, ours: Selector | None) -> tuple[bool, str]:
    """Whether a rule holds, and the words for when it does not."""
    name = next(key for key in rule if key != "at")
    own = merged(ours, rule["at"]) if "at" in rule else (ours or {})
    return RULES[name](rule[name], own, tables)
