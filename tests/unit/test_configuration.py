"""The closed schema: every mistake ends in one message that names the key."""

from pathlib import Path

import pytest
import yaml

from walklab.configuration import check_path, complete, load_schema, manual, named_paths
from walklab.errors import InputError

ROOT = Path(__file__).parents[2]
SCHEMA = load_schema(ROOT / "workflow/schemas/config.schema.yaml")


def paper() -> dict:
    return yaml.safe_load((ROOT / "config/config.yaml").read_text())


def test_the_papers_configuration_is_complete_and_has_the_papers_space():
    config = complete(paper(), SCHEMA)
    assert config["model"]["k"] == 100
    assert [axis["count"] for axis in config["space"]] == [10, 10, 10]


def test_defaults_are_filled_without_touching_the_given_configuration():
    given = paper()
    completed = complete(given, SCHEMA)
    assert "model" not in given
    assert completed["planner"]["step_s"] == pytest.approx(1 / 60, abs=1e-15)


def without(config: dict, key: str) -> dict:
    del config[key]
    return config


def with_value(config: dict, path: str, value: object) -> dict:
    *parents, last = path.split(".")
    node = config
    for name in parents:
        node = node.setdefault(name, {})
    node[last] = value
    return config


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("modell", {}, "modell: unknown; did you mean 'model'"),
        ("model.exponnent", 2, "model.exponnent: unknown; did you mean 'exponent'"),
        ("model.k", "many", "model.k: 'many' is not of type 'integer'"),
        ("model.k", 0, "model.k: 0 is less than the minimum"),
        ("body.radius_m", -0.2, "body.radius_m.*unit: m"),
        ("body.radius_m", 25, "body.radius_m: 25 is greater than the maximum of 1 .unit: m"),
        ("dependencies.names", ["length", "mood"], r"dependencies.names.1.*'mood' is not one of"),
        ("run", "My Run", "run: 'My Run' is not allowed: Name of the run, of lower-case letters"),
        ("record_training.turning_angles_deg", [30], "record_training.turning_angles_deg.0"),
        ("participants.training.height_m", {"mean": 1.7}, "participants.training.height_m: 'sd' is a required property"),
        ("space", [{"name": "v", "unit": "m/s"}], "space.0: give either start with step with count or values"),
        ("sweep_neighbours.k", [10, 10], "sweep_neighbours.k.*non-unique"),
        ("planner.step_s", 0, "planner.step_s"),
    ],
)
def test_a_mistake_is_named_by_its_path_in_one_line(path, value, expected):
    with pytest.raises(InputError, match=expected) as caught:
        complete(with_value(paper(), path, value), SCHEMA)
    assert "\n" not in str(caught.value)


def test_a_missing_section_is_named():
    with pytest.raises(InputError, match="'space' is a required property"):
        complete(without(paper(), "space"), SCHEMA)


def test_the_manual_lists_every_leaf_with_its_unit():
    text = manual(SCHEMA)
    assert "| `radius_m` | number | m | `0.25` |" in text
    assert "| `training.height_m` |" in text
    assert text == (ROOT / "config/README.md").read_text()


# What may stand beside the keywords of JSON Schema: a comma in an unquoted description makes a new key.
OWN_KEYWORDS = {"unit", "leaf"}
KEYWORDS = {
    "$schema", "$ref", "$defs", "title", "description", "type", "properties", "required", "additionalProperties", "default",
    "enum", "items", "minItems", "maxItems", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "pattern", "oneOf",
    "uniqueItems",
}  # fmt: skip


def unknown_keywords(schema: object) -> set[str]:
    if not isinstance(schema, dict):
        return set()
    children = [*schema.get("properties", {}).values(), *schema.get("$defs", {}).values(), schema.get("items")]
    return (set(schema) - KEYWORDS - OWN_KEYWORDS).union(*(unknown_keywords(child) for child in children))


def test_the_schema_uses_known_keywords_only():
    assert unknown_keywords(SCHEMA) == set()
    assert unknown_keywords({"properties": {"x": {"type": "string", "typo) and more": None}}}) == {"typo) and more"}


def test_a_named_file_outside_of_the_allowed_folders_is_refused(tmp_path):
    inside, outside = tmp_path / "work", tmp_path / "elsewhere"
    for folder in (inside, outside):
        folder.mkdir()
        (folder / "walks.csv").write_text("x")
    (inside / "link.csv").symlink_to(outside / "walks.csv")
    check_path("source.path", inside / "walks.csv", [inside])
    check_path("source.path", outside / "walks.csv", [inside, "/"])
    for path in (outside / "walks.csv", inside / "../elsewhere/walks.csv", inside / "link.csv"):
        with pytest.raises(InputError, match=r"config key source\.path: .* lies outside .*allow_outside_paths"):
            check_path("source.path", path, [inside])


@pytest.mark.parametrize("path", ["", "absent.csv"])
def test_a_named_file_that_is_not_there_is_told(tmp_path, path):
    with pytest.raises(InputError, match=r"config key source\.path: .* does not exist"):
        check_path("source.path", path, ["/"])


def test_every_named_file_is_known(monkeypatch):
    monkeypatch.setenv("WALKLAB_DATA", "/data")
    config = complete(paper() | {"source": {"kind": "table", "path": "$WALKLAB_DATA/w.csv", "plans": ["a.yaml"]}}, SCHEMA)
    named = named_paths(config)
    assert named["source.path"] == "/data/w.csv"
    assert named["source.plans.0"] == "a.yaml"
    assert set(named) == {"scenarios.scenario_1", "scenarios.scenario_2", "source.path", "source.plans.0"}
