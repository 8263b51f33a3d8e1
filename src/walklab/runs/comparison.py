"""What changed between two runs: configuration, code, versions, products, claims, scores and cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from walklab.errors import InputError
from walklab.runs.record import SCORE_KEYS, SCORE_VALUES

ABSENT = "(absent)"


@dataclass(frozen=True)
class Comparison:
    """Differences of two run records; every table has the columns ``before`` and ``after``.

    Attributes
    ----------
    names : the two runs' names
    config : a row per configuration key that differs
    code : a row per script whose code digest differs, and one for the commit
    versions : a row per package whose version differs
    products : a row per product whose bytes differ, by the first digits of its SHA-256
    claims : a row per claim of either run: id, ours before and after, verdict before and after, changed
    scores : a row per score of either run, with ``measure`` and ``difference`` (after - before)
    cost : a row per stage: wall time (s) summed over its jobs, and ``ratio`` (after / before)
    """

    names: tuple[str, str]
    config: pd.DataFrame
    code: pd.DataFrame
    versions: pd.DataFrame
    products: pd.DataFrame
    claims: pd.DataFrame
    scores: pd.DataFrame
    cost: pd.DataFrame

    @property
    def changed_claims(self) -> pd.DataFrame:
        """The claims whose number or verdict differs."""
        return self.claims[self.claims["changed"]]


def compare(before: Mapping[str, Any], after: Mapping[str, Any]) -> Comparison:
    """Compare two records, as :func:`walklab.runs.io.read_record` gives them.

    Raises
    ------
    InputError
        If a record holds something else than a run writes there.
    """
    names = str(before["run"]), str(after["run"])
    try:
        return Comparison(
            names,
            differences(flat(before["config"]), flat(after["config"])),
            differences(before.get("code", {}) | _commit(before), after.get("code", {}) | _commit(after)),
            differences(before["versions"], after["versions"]),
            differences(_digests(before), _digests(after)),
            _claims(before.get("claims", []), after.get("claims", [])),
            _scores(before.get("scores", []), after.get("scores", [])),
            _cost(before["stages"], after["stages"]),
        )
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"the records of {names[0]} and {names[1]}: one of them is damaged ({error}); run its study again"
        ) from error


def flat(value: Any, prefix: str = "") -> dict[str, Any]:
    """Nested mappings as one, with dotted keys; lists stay whole."""
    if not isinstance(value, Mapping):
        return {prefix: value}
    found: dict[str, Any] = {}
    for name, part in value.items():
        found |= flat(part, f"{prefix}.{name}" if prefix else str(name))
    return found


def differences(before: Mapping[str, Any], after: Mapping[str, Any]) -> pd.DataFrame:
    """The keys whose values differ: key, before, after."""
    keys = [*before, *(key for key in after if key not in before)]
    rows = [(key, before.get(key, ABSENT), after.get(key, ABSENT)) for key in keys]
    return pd.DataFrame([row for row in rows if row[1] != row[2]], columns=["key", "before", "after"])


def _commit(record: Mapping[str, Any]) -> dict[str, str]:
    commit = record["commit"]
    return {"commit": f"{commit['id'][:12]}{' with local changes' if commit['dirty'] else ''}" if commit else "(no git)"}


def _digests(record: Mapping[str, Any]) -> dict[str, str]:
    return {name: str(digest)[:12] for name, digest in sorted(record.get("products", {}).items())}


def _claims(before: list[dict[str, Any]], after: list[dict[str, Any]]) -> pd.DataFrame:
    columns = ["id", "ours", "verdict"]
    merged = pd.DataFrame(before, columns=columns).merge(
        pd.DataFrame(after, columns=columns), on="id", how="outer", suffixes=("_before", "_after"), sort=False
    )
    verdicts = merged[["verdict_before", "verdict_after"]].fillna(ABSENT)
    numbers = merged[["ours_before", "ours_after"]].astype(float)
    # Two missing numbers are alike.
    same = numbers["ours_before"].eq(numbers["ours_after"]) | numbers.isna().all(axis=1)
    return pd.concat([merged[["id"]], numbers, verdicts], axis=1).assign(
        changed=~same | verdicts["verdict_before"].ne(verdicts["verdict_after"])
    )


def _scores(before: list[dict[str, Any]], after: list[dict[str, Any]]) -> pd.DataFrame:
    def tall(rows: list[dict[str, Any]]) -> pd.DataFrame:
        table = pd.DataFrame(rows).reindex(columns=[*SCORE_KEYS, *SCORE_VALUES]).astype(dict.fromkeys(SCORE_VALUES, float))
        table[list(SCORE_KEYS)] = table[list(SCORE_KEYS)].astype(object).fillna("")
        return table.melt(list(SCORE_KEYS), list(SCORE_VALUES), var_name="measure", value_name="value").dropna(subset="value")

    keys = [*SCORE_KEYS, "measure"]
    merged = tall(before).merge(tall(after), on=keys, how="outer", suffixes=("_before", "_after"), sort=False)
    merged = merged.rename(columns={"value_before": "before", "value_after": "after"})
    return merged.assign(difference=merged["after"] - merged["before"])


def _cost(before: list[dict[str, Any]], after: list[dict[str, Any]]) -> pd.DataFrame:
    def total(stages: list[dict[str, Any]]) -> pd.Series:
        return pd.DataFrame(stages, columns=["stage", "wall_s"]).groupby("stage")["wall_s"].sum()

    table = pd.DataFrame({"before": total(before), "after": total(after)}).rename_axis("stage").reset_index()
    return table.assign(ratio=table["after"] / table["before"])
