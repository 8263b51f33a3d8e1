"""Values that do not fit together stop a run before it starts, each with one message that names the key."""

from pathlib import Path

import pytest
import yaml

from walklab.configuration import complete, load_schema
from walklab.consistency import recorded_walks, require_consistent
from walklab.errors import InputError

ROOT = Path(__file__).parents[2]
SCHEMA = load_schema(ROOT / "workflow/schemas/config.schema.yaml")


def merged(config: dict, overrides: dict) -> dict:
    """As Snakemake merges configuration files: mappings key by key, all else replaced."""
    for key, value in overrides.items():
        if isinstance(value, dict) and isinstance(config.get(key), dict):
            merged(config[key], value)
        else:
            config[key] = value
    return config


def configuration(overrides: dict) -> dict:
    return complete(merged(yaml.safe_load((ROOT / "config/config.yaml").read_text()), overrides), SCHEMA)


@pytest.mark.parametrize("name", ["config/config.yaml", "config/small.yaml", "config/cmu.yaml", "config/own.yaml"])
def test_every_configuration_of_the_project_is_consistent(name):
    assert require_consistent(configuration(yaml.safe_load((ROOT / name).read_text()))) is None


def axis(name: str, *values: float) -> dict:
    return {"name": name, "unit": "m/s", "values": list(values)}


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ({"participants": {"training": {"female": 31}}}, r"participants.training.female: 31 women among 30"),
        (
            {"participants": {"scenarios": {"height_m": {"mean": 2.1}}}},
            r"participants.scenarios.height_m: mean 2.1 does not lie between min 1.6 and max 1.98",
        ),
        (
            {"participants": {"long_distance": {"height_m": {"mean": 181, "sd": 5, "min": 175, "max": 190}}}},
            r"participants.long_distance.height_m: 175 to 190 leaves 0.5 to 2.6; the unit is in the key's name",
        ),
        ({"record_scenario": {"sets": [1, 1, 1]}}, r"record_scenario.sets: 3 numbers for 10 participants"),
        ({"record_training": {"flawed_walks": 2000}}, r"record_training.flawed_walks: 2000 of 1920 walks"),
        ({"blending_space": {"entries": 1000}}, r"blending_space.entries: 1000 is less than the 1848 captured walks"),
        ({"blending_space": {"subset": 60}}, r"blending_space.subset: 60 of 50 neighbours"),
        ({"model": {"k": 6000}}, r"model.k: 6000 neighbours among blending_space.entries \(5000\)"),
        ({"standing": {"standing_speed_m_s": 0.5}}, r"standing.standing_speed_m_s: 0.5 m/s is not below"),
        ({"space": [axis("v", 1, 2), axis("v", 1, 2)]}, r"space.1.name: 'v' stands twice"),
        ({"space": [axis("v", 1, 2)]}, r"space: has one axis"),
        ({"long_distance": {"space": [axis("v", 2, 1)]}}, r"long_distance.space.0.values: \[2, 1\] do not ascend"),
        ({"planner": {"time_limit_s": float("inf")}}, r"planner.time_limit_s: inf is no finite number"),
        ({"record_training": {"straight_distances_m": [1.0, float("nan")]}}, r"record_training.straight_distances_m.1: nan"),
    ],
)
def test_values_that_do_not_fit_are_named_in_one_line(overrides, expected):
    with pytest.raises(InputError, match=f"^config key {expected}") as caught:
        require_consistent(configuration(overrides))
    assert "\n" not in str(caught.value)


def test_own_walks_may_be_fewer_or_more_than_the_synthetic_ones():
    few = {"source": {"kind": "table", "path": "x.csv"}, "blending_space": {"entries": 500}}
    assert require_consistent(configuration(few)) is None
    with pytest.raises(InputError):
        require_consistent(configuration({"blending_space": {"entries": 500}}))


def test_the_papers_walks_are_counted():
    assert recorded_walks(configuration({})) == 1920
