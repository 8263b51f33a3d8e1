"""The profile for Slurm names rules that there are, leaves out no figure, and asks for the memory that jobs take."""

import json
import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
PROFILE = yaml.safe_load((ROOT / "profiles/slurm/config.yaml").read_text())
SOURCES = "\n".join(path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk"))
RULES = set(re.findall(r"^ *rule (\w+):", SOURCES, re.MULTILINE))
NOT_A_FIGURE = {"draw_participants"}  # it draws people


def test_every_rule_of_the_profile_exists():
    assert {*PROFILE["set-resources"], *PROFILE["groups"], PROFILE["slurm-array-jobs"]} <= RULES


def test_all_figures_are_one_group():
    figures = {name for name in RULES if name.startswith("draw_")} - NOT_A_FIGURE
    assert figures <= {name for name, group in PROFILE["groups"].items() if group == "figures"}


def asked_mb(rule):
    """The memory (MB) that the first attempt of a rule's job asks for."""
    asked = {"mem_mb": PROFILE["default-resources"]["mem_mb"]} | PROFILE["set-resources"].get(rule, {})
    return int(re.fullmatch(r"(\d+) \* attempt", asked["mem_mb"])[1])


def test_a_rule_that_names_no_memory_has_that_of_all():
    assert (asked_mb("build_space"), asked_mb("score_maps"), asked_mb("plan_training")) == (4000, 1000, 1000)


@pytest.mark.parametrize("run", ["steering", "small", "cmu", "recovery"])
def test_rules_ask_for_more_memory_than_they_took(run):
    path = ROOT / "results" / run / "run.json"
    if not path.is_file():
        pytest.skip(f"there is no {path.relative_to(ROOT)}")
    stages = json.loads(path.read_text())["stages"]
    short = {job["stage"]: job["peak_memory_mb"] for job in stages if asked_mb(job["stage"]) < 1.3 * job["peak_memory_mb"]}
    assert short == {}
