"""The announcement before a run counts what the configuration says."""

from pathlib import Path

import yaml

from walklab.configuration import complete, load_schema
from walklab.estimate import estimate, training_walks

ROOT = Path(__file__).parents[2]
CONFIG = complete(
    yaml.safe_load((ROOT / "config/config.yaml").read_text()), load_schema(ROOT / "workflow/schemas/config.schema.yaml")
)


def test_the_papers_study_is_counted():
    text = estimate(CONFIG, 17, 2)
    assert training_walks(CONFIG) == 1920
    assert "1920 training walks x 1000 parameter vectors" in text
    assert f"{181 * 17} evaluated walks" in text


def test_own_walks_are_not_announced_as_the_papers():
    text = estimate(CONFIG | {"source": {"kind": "table", "path": "own.csv"}}, 17, 2)
    assert "own.csv" in text
    assert "1920" not in text


def test_more_cores_take_less_time():
    minutes = [int(estimate(CONFIG, 17, cores).split("about ")[1].split(" min")[0]) for cores in (1, 2)]
    assert minutes[0] > minutes[1]


def test_many_populations_take_longer_but_each_less_than_a_whole_study():
    minutes = [int(estimate(CONFIG | {"replicates": count}, 17, 1).split("about ")[1].split(" min")[0]) for count in (1, 20)]
    assert 10 * minutes[0] < minutes[1] < 20 * minutes[0]
