"""Another workflow uses walklab as a module: its own rules on walklab's products."""

import shutil
from pathlib import Path

import pytest
from conftest import ROOT, Project

pytestmark = pytest.mark.workflow

OUTER = f"""
configfile: "study.yaml"


module walklab:
    snakefile:
        "{ROOT / "Snakefile"}"
    config:
        config


use rule * from walklab as walklab_*


rule count_participants:
    default_target: True
    input:
        rules.walklab_draw_participants.output.participants.format(replicate=0),
    output:
        "participants.txt",
    run:
        import pandas as pd

        Path(output[0]).write_text(str(len(pd.read_parquet(input[0]))))
"""


@pytest.fixture
def outer(tmp_path: Path) -> Project:
    (tmp_path / "Snakefile").write_text("from pathlib import Path\n" + OUTER)
    shutil.copy(ROOT / "tests/workflow/tiny.yaml", tmp_path / "study.yaml")
    return Project(tmp_path)


def test_a_rule_of_another_workflow_reads_a_product_of_walklab(outer):
    outer.run("--cores", "1")
    assert (outer.folder / "participants.txt").read_text() == "10", "4 training, 3 scenario and 3 long-distance participants"


def test_all_of_walklab_can_be_planned_from_another_folder(outer):
    planned = outer.run("--dry-run", "--cores", "1", "walklab_all")
    assert "walklab_check_claims" in planned
    assert "walklab_record_run" in planned
