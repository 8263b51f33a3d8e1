"""The closed configuration schema: validation with defaults, and the manual made from it."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import yaml
from jsonschema import Draft202012Validator, validators
from jsonschema.exceptions import ValidationError, best_match

from walklab.errors import InputError


def load_schema(path: str | Path) -> dict[str, Any]:
    """Read a JSON schema written in YAML."""
    return yaml.safe_load(Path(path).read_text())


def complete(config: Mapping[str, Any], schema: Mapping[str, Any]) -> dict[str, Any]:
    """The configuration with the schema's defaults filled in.

    Raises
    ------
    InputError
        One line with the path of the first offending key, what is wrong and, for an
        unknown key, the closest known one.
    """
    completed = copy.deepcopy(dict(config))
    error = best_match(_FillingValidator(schema).iter_errors(completed))
    if error is not None:
        raise InputError(_explain(error))
    return completed


def _fill_defaults(validator: Any, properties: Mapping[str, Any], instance: Any, schema: Any) -> Iterator[ValidationError]:
    if isinstance(instance, dict):
        for name, subschema in properties.items():
            if "default" in subschema:
                instance.setdefault(name, copy.deepcopy(subschema["default"]))
    yield from Draft202012Validator.VALIDATORS["properties"](validator, properties, instance, schema)


_FillingValidator = validators.extend(Draft202012Validator, {"properties": _fill_defaults})


def _explain(error: ValidationError) -> str:
    path = ".".join(str(part) for part in error.absolute_path)
    where = f"config key {path}" if path else "config"
    if error.validator == "additionalProperties" and isinstance(error.instance, dict):
        known = list(error.schema.get("properties", {}))
        unknown = next(key for key in error.instance if key not in known)
        close = get_close_matches(str(unknown), known, n=1)
        hint = f"did you mean {close[0]!r}?" if close else f"known keys are {', '.join(known)}"
        return f"config key {path + '.' if path else ''}{unknown}: unknown; {hint}"
    if error.validator == "pattern":
        # A pattern is no sentence; the schema's description says it in words.
        return f"{where}: {error.instance!r} is not allowed: {' '.join(error.schema.get('description', '').split())}"
    if error.validator == "oneOf":
        ways = " or ".join(" with ".join(way["required"]) for way in error.validator_value)
        return f"{where}: give either {ways}; see config/README.md"
    unit = error.schema.get("unit") if isinstance(error.schema, dict) else None
    return f"{where}: {error.message}{f' (unit: {unit})' if unit else ''}; see config/README.md"


def named_paths(config: Mapping[str, Any]) -> dict[str, str]:
    """Every file or folder that a completed configuration names, by its key, with variables replaced."""
    named = {f"scenarios.{name}": path for name, path in config["scenarios"].items()}
    if config["compare_verdicts"]["other"]:
        named["compare_verdicts.other"] = config["compare_verdicts"]["other"]
    if config["source"]["kind"] != "synthetic":
        named["source.path"] = config["source"]["path"] or ""
        named |= {f"source.plans.{index}": path for index, path in enumerate(config["source"]["plans"])}
    return {key: os.path.expandvars(path) for key, path in named.items()}


def check_path(key: str, path: str | Path, allowed: Iterable[str | Path]) -> None:
    """Refuse a named file that does not exist or, links followed, lies in none of the allowed folders.

    A configuration from somebody else must not be able to make a run read, and then report, any file of its user.

    Raises
    ------
    InputError
        One line with the key, the path and what to do.
    """
    found = Path(path)
    if str(path) in {"", "."} or not found.exists():
        raise InputError(f"config key {key}: {path or 'null'} does not exist; correct the path (or set WALKLAB_DATA)")
    if not any(found.resolve().is_relative_to(Path(folder).resolve()) for folder in allowed):
        raise InputError(
            f"config key {key}: {path} lies outside of the working folder and of WALKLAB_DATA; "
            "move it there, or set allow_outside_paths: true if you trust this configuration"
        )


def manual(schema: Mapping[str, Any]) -> str:
    """The reference of all keys as Markdown, one table per section."""
    schema = _resolved(schema, schema)
    lines = ["# Configuration", "", schema["description"].strip(), ""]
    top = {name: value for name, value in schema["properties"].items() if value.get("type") != "object"}
    lines += ["## Run", "", *_table(top), ""]
    for name, value in schema["properties"].items():
        if value.get("type") == "object":
            lines += [f"## `{name}`", "", value.get("description", "").strip(), "", *_table(dict(_leaves(value))), ""]
    return "\n".join(lines)


def _resolved(node: Any, root: Mapping[str, Any]) -> Any:
    """A copy of a schema with every ``$ref`` replaced by what it refers to."""
    if isinstance(node, list):
        return [_resolved(item, root) for item in node]
    if not isinstance(node, Mapping):
        return node
    if "$ref" in node:
        target: Any = root
        for part in node["$ref"].removeprefix("#/").split("/"):
            target = target[part]
        siblings = {key: value for key, value in node.items() if key != "$ref"}
        return {**_resolved(target, root), **siblings}
    return {key: _resolved(value, root) for key, value in node.items() if key != "$defs"}


def _leaves(schema: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Mapping[str, Any]]]:
    for name, value in schema.get("properties", {}).items():
        if value.get("type") == "object" and "properties" in value and not value.get("leaf"):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _table(leaves: Mapping[str, Mapping[str, Any]]) -> list[str]:
    rows = ["| key | type | unit | default | meaning |", "|---|---|---|---|---|"]
    for name, value in leaves.items():
        kind = value.get("enum") or value.get("type", "any")
        kind = " or ".join(map(str, kind)) if isinstance(kind, list) else kind
        default = (
            f"`{yaml.safe_dump(value['default'], default_flow_style=True, width=1000).strip().removesuffix('...').strip()}`"
            if "default" in value
            else "(required)"
        )
        meaning = " ".join(value.get("description", "").split())
        rows.append(f"| `{name}` | {kind} | {value.get('unit', '-')} | {default} | {meaning} |".replace("|| ", "| "))
    return rows
