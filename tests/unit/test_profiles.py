"""The profile for Slurm names rules that there are, and leaves out no figure."""

import re
from pathlib import Path

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
