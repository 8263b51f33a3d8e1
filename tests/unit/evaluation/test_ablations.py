"""Sub-models on a constructed training set in which only length and v matter."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.evaluation.ablations import (
    FULL,
    WithHeldParameter,
    WithoutDependency,
    ablated_models,
    ablation_table,
    calibrated_variants,
    held_cells,
)
from walklab.steering.models import AdaptiveModel
from walklab.steering.sharpness import SharpnessLaw
from walklab.steering.space import ParameterSpace, space_from_config
from walklab.steering.training import TrainingSettings, train

SETTINGS = TrainingSettings(count=None, k=4)


@pytest.fixture(scope="module")
def space() -> ParameterSpace:
    axis = {"unit": "", "start": 0.2, "step": 0.2, "count": 6}
    return space_from_config([{"name": name, **axis} for name in ("v", "a")])


@pytest.fixture(scope="module")
def training() -> pd.DataFrame:
    rng = np.random.default_rng(0)
    return pd.DataFrame({"length": np.repeat([1.0, 2.0, 3.0, 4.0], 10), "height": rng.uniform(1.6, 1.9, 40)})


def score(training: pd.DataFrame) -> Callable[[np.ndarray], np.ndarray]:
    """Best speed rises with length from 0.4 to 1.0 m/s; the best acceleration is 0.6 m/s2 for everybody."""
    best = 0.2 + 0.2 * training["length"].to_numpy()
    return lambda cells: (cells[None, :, 0] - best[:, None]) ** 2 + (cells[None, :, 1] - 0.6) ** 2


def models(training: pd.DataFrame, space: ParameterSpace) -> dict:
    scorer = score(training)
    people = [f"P{i % 5}" for i in range(len(training))]
    return ablated_models(scorer(space.cells), training, people, space, SETTINGS, scorer, {"v": 0.7, "a": 0.9}, 1, 0)


ASKED = np.array([[1.0, 1.7], [4.0, 1.75]])


def test_without_the_dependency_that_matters_walks_are_not_told_apart(training: pd.DataFrame, space: ParameterSpace) -> None:
    built = models(training, space)
    assert list(built) == ["without_length", "without_height", "without_v", "without_a"]
    speeds = {name: _modes(built[name], ASKED)[:, 0] for name in ("without_length", "without_height")}
    np.testing.assert_allclose(speeds["without_height"], [0.4, 1.0], atol=0.05)
    # Near in height only: neighbours of all lengths, so that the long and the short walk get the same kind of blend.
    assert abs(np.diff(speeds["without_length"])[0]) < 0.4
    same_height = np.column_stack([[1.0, 4.0], [1.7, 1.7]])
    assert np.diff(_modes(built["without_length"], same_height)[:, 0])[0] == pytest.approx(0, abs=1e-9)


def test_a_held_parameter_has_its_value_and_the_rest_is_drawn(training: pd.DataFrame, space: ParameterSpace) -> None:
    built = models(training, space)
    drawn = {name: _draw(built[name], np.repeat(ASKED, 50, axis=0)) for name in ("without_v", "without_a")}
    assert built["without_v"].names == ("v", "a")
    assert (drawn["without_v"][:, 0] == 0.7).all()
    assert (drawn["without_a"][:, 1] == 0.9).all()
    assert np.ptp(drawn["without_v"][:, 1]) > 0.3
    assert np.ptp(drawn["without_a"][:, 0]) > 0.3


def test_calibrated_variants_draw_with_the_laws_exponents(training: pd.DataFrame, space: ParameterSpace) -> None:
    built = models(training, space)
    asked = np.repeat([[1.0, 1.7], [4.0, 1.7]], 200, axis=0)
    steep = SharpnessLaw(4.0, 0, 2.0, 2.5, 1.0)  # by the length
    spread = {}
    for name, model in calibrated_variants(built, steep).items():
        drawn = _draw(model, asked)
        spread[name] = np.array([drawn[:200].std(axis=0), drawn[200:].std(axis=0)])
    # The long walk's exponent is the larger one, so its draws are narrower; without the length the law is one number.
    assert spread["without_height"][1, 0] < 0.6 * spread["without_height"][0, 0]
    assert spread["without_length"][1, 0] == pytest.approx(spread["without_length"][0, 0], rel=0.25)
    assert (_draw(calibrated_variants(built, steep)["without_v"], asked)[:, 0] == 0.7).all()
    flat = calibrated_variants(built, SharpnessLaw(1.0))
    np.testing.assert_array_equal(_draw(flat["without_height"], asked), _draw(built["without_height"], asked))
    with pytest.raises(InputError, match="no sharpness"):
        calibrated_variants({"P_Adapt": AdaptiveModel(built["without_a"].model)}, steep)


def test_maps_of_a_held_parameter_are_scored_with_it_held(space: ParameterSpace) -> None:
    reduced, cells = held_cells(space, "v", 0.73)
    assert reduced.names == ("a",)
    np.testing.assert_array_equal(cells, [[0.73, a] for a in space.axes[1].values])
    with pytest.raises(InputError, match="no axis 'omega'"):
        held_cells(space, "omega", 1.0)


def test_a_parameter_without_a_value_to_hold_is_refused(training: pd.DataFrame, space: ParameterSpace) -> None:
    scorer = score(training)
    with pytest.raises(InputError, match="no value to hold a at"):
        ablated_models(scorer(space.cells), training, ["P"] * 40, space, SETTINGS, scorer, {"v": 0.7}, 1, 0)


def test_full_model_and_ablation_without_effect_agree(training: pd.DataFrame, space: ParameterSpace) -> None:
    people = [f"P{i % 5}" for i in range(len(training))]
    full = train(score(training)(space.cells), training, people, space, SETTINGS, np.random.default_rng(0))
    modes = AdaptiveModel(full).parameters(ASKED)
    np.testing.assert_allclose(modes[:, 0], _modes(models(training, space)["without_height"], ASKED)[:, 0], atol=0.05)


def test_table_gives_the_increase_paired_by_walk(make_trials: Callable[..., pd.DataFrame]) -> None:
    errors = np.random.default_rng(1).lognormal(size=100)
    trials = make_trials({"without_v": errors + 0.25, FULL: errors, "without_height": errors})
    table = ablation_table(trials, np.random.default_rng(0), {"v": 0.94}, 200).set_index("variant")
    assert list(table.index) == [FULL, "without_v", "without_height"]
    np.testing.assert_allclose(table.loc["without_v", ["increase_s", "increase_low", "increase_high"]].astype(float), 0.25)
    assert table.loc["without_v", "p"] < 1e-6
    assert table.loc["without_height", ["increase_s", "p"]].tolist() == [0.0, 1.0]
    assert table.loc["without_v", "held_at"] == 0.94
    assert np.isnan(table.loc["without_height", "held_at"])
    assert table.loc[FULL, "value"] == pytest.approx(np.median(errors))
    with pytest.raises(InputError, match="no model 'full'"):
        ablation_table(trials[trials["model"] != FULL], np.random.default_rng(0), {})


def _modes(model: WithoutDependency | WithHeldParameter, vectors: np.ndarray) -> np.ndarray:
    assert isinstance(model, WithoutDependency)
    return AdaptiveModel(model.model).parameters(vectors[:, list(model.columns)])


def _draw(model: WithoutDependency | WithHeldParameter, vectors: np.ndarray) -> np.ndarray:
    return model.parameters(vectors, [np.random.default_rng(i) for i in range(len(vectors))])
