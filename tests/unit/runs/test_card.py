"""The card of a model says what the file holds."""

import pandas as pd
import pytest

from walklab.runs.card import model_card, publish_model
from walklab.runs.crate import PRODUCTS


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    from pathlib import Path

    from walklab.capture.own import OwnColumns
    from walklab.fitting import fit_walks
    from walklab.steering.training import TrainingSettings

    example = Path(__file__).parents[3] / "examples/own_walks.csv"
    columns = OwnColumns("person", "walk", "time_s", "x_m", "y_m", "height_cm")
    settings = TrainingSettings(count=None, basis="multilinear", k=5, exponent=2.0)
    path = tmp_path_factory.mktemp("card") / "model.safetensors"
    fit_walks(example, columns, settings=settings, height_unit="cm").save(path)
    return path


SCORES = pd.DataFrame(
    {
        "scenario": ["scenario_1"] * 3,
        "hull": ["all", "all", "inside"],
        "model": ["P_Prob (literal)", "P_Stat", "P_Prob (literal)"],
        "crps_s": [0.25, 0.1, 9.0],
        "energy_m": [None, None, None],
    }
)


def test_training_domain_and_scores_are_on_it(model):
    card = model_card(model, "table", SCORES)
    assert "20 captured walks" in card
    assert "| v | m/s | 0.1 to 1.99 | 10 | drawn |" in card
    assert "exponent 2, basis multilinear" in card
    assert "| scenario_1 | P_Prob (literal) | 0.25 | - |" in card
    assert "P_Stat" not in card
    for variant in ("(literal)", "(calibrated)", "(extended)", "without dependencies"):
        assert f"`P_Prob {variant}`" in card, "every variant that is scored is told apart from the file"
    assert "9" not in card.split("How it scored")[1].split("Not for")[0]
    assert "| height | m | 1." in card


def test_a_model_that_was_not_scored_says_so(model):
    assert "No forecast of this model was scored" in model_card(model, "synthetic", SCORES.iloc[1:2])


def test_the_published_model_is_the_model_and_may_be_published_again(model, tmp_path):
    for _ in range(2):
        publish_model(model, tmp_path / "run/model.safetensors")
    assert (tmp_path / "run/model.safetensors").read_bytes() == model.read_bytes()
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["model.safetensors"]
    assert "*.safetensors" in PRODUCTS
