"""Negative controls: where there is nothing to learn, the models that learn must not win.

The whole chain runs, from drawing people to comparing travel times, at reduced size, in several
*populations*: independent draws of training and evaluation people, each with its own models.

Criterion. The gain of one model over another in one population is the reduction of the median
|dt| that the study reports (``reductions``). A model *beats* another if the mean gain over the
populations is above 0 by a one-sided t test at 5 %. People of one population share the models,
so populations, not people or walks, are what is independent; where two models are equally good
the criterion errs in 5 % of all choices of the seeds, and less often where the model that
learns is the worse one. Each control stands beside a positive control, in which the same
criterion on the same chain must find a difference; else passing would mean nothing.

What "no effect of length, curvature and height" can mean. The people of the generator then have
one speed and one start-up for all walks, the short ones included. The planner is another kind of
model, so the switches do not make its best parameters independent of the walk: people keep a
distance from obstacles that the planned route does not know (the routes to rack 1, past rack 3,
are too short, and P_Stat arrives about 0.1 s too early there), and a metric of positions weighs the
shape of a speed profile differently on short and on long walks. P_Adapt may adapt to either.
The control therefore states no identity of the best parameters, but two things that hold:

* on straight walks P_Stat errs alike at 0.7 m and 2.2 m, so that in travel times there is
  nothing to adapt to (and with the effects on it errs to opposite sides);
* P_Adapt does not beat P_Stat all the same.

Between people comfortable speed differs by 10 %, and no model knows a person's speed. That alone
hides the whole effect of the dependencies from a dozen people. The sharp pair of controls is
therefore made with people who are *alike*: the traits that set speed, start-up and the way of
taking corners are the same for all (``alike``); height, age, sex, sway and repetition still vary.
The control is repeated with people as they are; since there the effects are
not seen even when they are on, its positive control is a model that is told the duration.

What "P_Prob must not beat P_Adapt" can mean. One draw cannot beat the centre of the distribution
it is drawn from: if X and T are independent and alike, |X - T| has about sqrt(2) times the median
of |T - centre|. So P_Prob has no right to win even where people do vary, and without variation
still less. The control would catch draws that know something of the walk; its positive control
is such a model. At the paper's exponent of 1 the maps are so flat that P_Prob loses by far and
the control is easy; it is repeated with a sharp density, where P_Prob comes close to P_Adapt.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.capture.centre_of_mass import from_belt_pose
from walklab.capture.constants import WalkerConstants, without_dependency_effects, without_repetition_variation
from walklab.capture.participants import Distribution, Group, draw_participants
from walklab.capture.scenario import ScenarioDesign, record_scenario
from walklab.capture.segmentation import SegmentationRules, extract_walks
from walklab.capture.training import TrainingDesign, record_training
from walklab.capture.walks import ACCEPTED, Walk
from walklab.evaluation.long_distance import straight_travel_time_s
from walklab.evaluation.statistics import reductions
from walklab.evaluation.trials import simulate_trials
from walklab.geometry.plans import OPEN, load_plan
from walklab.geometry.scene import Body
from walklab.geometry.standing import Standing
from walklab.planning.registry import make_planner
from walklab.randomness import generator
from walklab.steering.dependencies import dependency_vectors
from walklab.steering.models import AdaptiveModel, Generators, MotionModel, ProbabilisticModel, StaticModel
from walklab.steering.routes import find_routes, pack
from walklab.steering.space import space_from_config
from walklab.steering.static_fit import fit_static
from walklab.steering.suitability import score_walks
from walklab.steering.training import TrainingSettings, train

Array = np.ndarray

POPULATIONS = range(1, 6)
LEVEL = 0.05
SHARP = 30.0  # an exponent at which draws come close to the mode

SCENES = Path(__file__).parents[3] / "config" / "scenes"
PLANS = {"open": OPEN, **{path.stem: load_plan(path) for path in SCENES.glob("*.yaml")}}
EVALUATED = PLANS["scenario_1"]
TRAINED = Group(
    "training",
    10,
    2,
    Distribution(26.46, 7.50, 19, 59),
    Distribution(1.78, 0.07, 1.65, 1.90),
    Distribution(75.15, 13.09, 50, 110),
)
JUDGED = Group(
    "scenarios",
    5,
    1,
    Distribution(27.80, 6.08, 21, 40),
    Distribution(1.79, 0.12, 1.60, 1.98),
    Distribution(76.20, 14.18, 60, 105),
)
TRAINING = TrainingDesign(
    straight_distances_m=(0.5, 1.0, 2.0, 3.0, 4.0),
    turning_angles_deg=(90.0, 180.0),
    turning_distances_m=(3.0,),
    straight_repetitions=1,
    turning_repetitions=1,
    standing_s=2.5,
    flawed_walks=0,
)
SCENARIO = ScenarioDesign(sets=(1,) * JUDGED.count)
SPACE = space_from_config(
    [
        {"name": name, "unit": unit, "values": list(np.linspace(0.1, 1.99, count))}
        for name, unit, count in (("v", "m/s", 7), ("a", "m/s2", 7), ("omega", "1/m", 5))
    ]
)
PLANNER = make_planner("path_following", SPACE.names, 1 / 60, {"cell_m": 0.02})
DEPENDENCIES = ["length", "curvature", "height"]
STANDING, RULES, BODY = Standing(), SegmentationRules(), Body(0.25)
CURVATURE_SCALE_M, TIME_LIMIT_S = 0.1, 30.0
BETWEEN_PEOPLE = (
    "comfortable_ratio",
    "distance_constant_m",
    "start_time_s",
    "stop_time_s",
    "turn_exponent",
    "walk_ratio_m_min",
    "clearance_m",
    "rounding_m",
)


def alike(constants: WalkerConstants) -> WalkerConstants:
    """People of one speed, one start-up and one way of taking corners."""
    return replace(constants, **{name: replace(getattr(constants, name), sd=0.0) for name in BETWEEN_PEOPLE})


@dataclass(frozen=True)
class Captured:
    """Walks with their routes and run-time dependencies."""

    walks: list[Walk]
    routes: dict[str, Array]
    vectors: pd.DataFrame

    @property
    def table(self) -> pd.DataFrame:
        return pd.DataFrame([walk.row for walk in self.walks])

    @property
    def durations_s(self) -> Array:
        return self.table["duration_s"].to_numpy(dtype=float)


@dataclass(frozen=True)
class Population:
    """One run of the chain up to the trained models."""

    seed: int
    scenario: Captured
    static: StaticModel
    model: ProbabilisticModel

    def trials(self, models: Mapping[str, MotionModel]) -> pd.DataFrame:
        asked = self.scenario.vectors.to_numpy()
        walks, routes = self.scenario.walks, self.scenario.routes
        return simulate_trials(
            models, PLANNER, walks, routes, asked, STANDING, TIME_LIMIT_S, "euclid", seed=self.seed, replicate=0
        )


def run_chain(constants: WalkerConstants, seed: int) -> Population:
    """Draw people, record and find their walks, and train the models, as the scripts of the workflow do."""
    people = draw_participants(TRAINED, constants, generator(seed, 0, "training"))
    recording, _ = record_training(people, TRAINING, PLANS, constants, seed, 0)
    training = _captured(*extract_walks(recording, people, STANDING, RULES, CURVATURE_SCALE_M))

    batch = pack(training.walks, training.routes, PLANNER)
    scores = score_walks(PLANNER, batch, SPACE.cells)
    settings = TrainingSettings(count=300, k=30)
    who = list(training.table["participant"])
    model = train(scores, training.vectors, who, SPACE, settings, generator(seed, 0, "build_space"))
    fit = fit_static(PLANNER, batch, SPACE, generator(seed, 0, "fit_static"), scores=scores, maxfun=100)

    people = draw_participants(JUDGED, constants, generator(seed, 0, "scenarios"))
    poses, _ = record_scenario(people, EVALUATED, SCENARIO, constants, seed, 0)
    recording = from_belt_pose(poses, people, SCENARIO.controller_offset_m)
    stations = {EVALUATED.scene.name: {name: station.position_m for name, station in EVALUATED.stations.items()}}
    scenario = _captured(*extract_walks(recording, people, STANDING, RULES, CURVATURE_SCALE_M, stations))
    assert fit.value <= 1.01 * fit.grid_value  # else a badly fitted P_Stat would be the reason of a gain
    return Population(seed, scenario, StaticModel(fit.names, fit.optimum), model)


def _captured(table: pd.DataFrame, samples: pd.DataFrame) -> Captured:
    accepted = table[table["rejection"] == ACCEPTED].reset_index(drop=True)
    parts = dict(iter(samples.groupby("walk", sort=False)))
    walks = [
        Walk(row, parts[row["walk"]]["time_s"].to_numpy(), parts[row["walk"]][["x_m", "y_m"]].to_numpy())
        for _, row in accepted.iterrows()
    ]
    routes = find_routes(walks, {plan.scene.name: plan.scene for plan in PLANS.values()}, PLANNER, BODY)
    return Captured(walks, routes, dependency_vectors(accepted, routes, DEPENDENCIES, "planned", CURVATURE_SCALE_M))


@dataclass(frozen=True)
class BestOfMany:
    """A model that leaks: of several draws of P_Prob it keeps the one that takes about as long as the captured walk."""

    model: ProbabilisticModel
    durations_s: Array
    draws: int = 64

    @property
    def names(self) -> tuple[str, ...]:
        return self.model.names

    def parameters(self, vectors: Array, generators: Generators | None = None) -> Array:
        assert generators is not None
        chosen = []
        for vector, duration_s, rng in zip(vectors, self.durations_s, generators, strict=True):
            drawn = self.model.sample(vector, self.draws, rng)
            standing_s = 2 * STANDING.standing_speed_m_s / drawn[:, 1]  # moving, but too slowly to count
            times_s = np.array([straight_travel_time_s(vector[0], v, a) for v, a, _ in drawn]) - standing_s
            chosen.append(drawn[np.argmin(np.abs(times_s - duration_s))])
        return np.array(chosen)


def beats(gained: list[float]) -> bool:
    """The criterion: the mean gain over the populations is above 0 by a one-sided t test."""
    return bool(stats.ttest_1samp(gained, 0.0, alternative="greater").pvalue < LEVEL)


Maker = Callable[[Population], MotionModel]


def gains(populations: list[Population], first: Maker, second: Maker) -> list[float]:
    """Reduction of the median |dt| from the first model to the second in each population."""
    found = []
    for population in populations:
        trials = population.trials({"first": first(population), "second": second(population)})
        table = reductions(trials, generator(0, "gains"), pairs=[("first", "second")], resamples=10)
        found.append(float(table.set_index("statistic").loc["median", "value"]))
    return found


def p_stat(population: Population) -> MotionModel:
    return population.static


def p_adapt(population: Population) -> MotionModel:
    return AdaptiveModel(population.model)


def told_the_duration(population: Population) -> MotionModel:
    return BestOfMany(population.model, population.scenario.durations_s)


def static_bias_s(populations: list[Population], configurations: tuple[str, str]) -> float:
    """Mean signed error of P_Stat on the walks between two stations, either way."""
    trials = pd.concat([population.trials({"P_Stat": population.static}) for population in populations])
    return float(trials.loc[trials["configuration"].isin(configurations), "dt_s"].mean())


SHORT, LONGER = ("car-rack_3", "rack_3-car"), ("car-rack_2", "rack_2-car")  # straight: 0.7 m and 2.2 m


@pytest.fixture(scope="module")
def alike_without_effects() -> list[Population]:
    constants = alike(without_dependency_effects(WalkerConstants()))
    return [run_chain(constants, seed) for seed in POPULATIONS]


@pytest.fixture(scope="module")
def alike_with_effects() -> list[Population]:
    return [run_chain(alike(WalkerConstants()), seed) for seed in POPULATIONS]


@pytest.fixture(scope="module")
def people_without_effects() -> list[Population]:
    return [run_chain(without_dependency_effects(WalkerConstants()), seed) for seed in POPULATIONS]


@pytest.fixture(scope="module")
def people_without_variation() -> list[Population]:
    return [run_chain(without_repetition_variation(WalkerConstants()), seed) for seed in POPULATIONS]


def test_without_effects_the_travel_times_leave_nothing_to_adapt_to(alike_without_effects: list[Population]) -> None:
    short, longer = (static_bias_s(alike_without_effects, walks) for walks in (SHORT, LONGER))
    assert abs(short - longer) < 0.1


def test_with_effects_the_travel_times_leave_something_to_adapt_to(alike_with_effects: list[Population]) -> None:
    short, longer = (static_bias_s(alike_with_effects, walks) for walks in (SHORT, LONGER))
    assert short - longer > 0.2


def test_without_effects_adapting_does_not_beat_one_vector_for_all(alike_without_effects: list[Population]) -> None:
    assert not beats(gains(alike_without_effects, p_stat, p_adapt))


def test_positive_control_with_effects_adapting_beats_one_vector_for_all(alike_with_effects: list[Population]) -> None:
    assert beats(gains(alike_with_effects, p_stat, p_adapt))


def test_without_effects_adapting_does_not_help_people_who_differ(people_without_effects: list[Population]) -> None:
    assert not beats(gains(people_without_effects, p_stat, p_adapt))


def test_positive_control_a_model_that_is_told_the_duration_helps_them(people_without_effects: list[Population]) -> None:
    assert beats(gains(people_without_effects, p_stat, told_the_duration))


def test_without_variation_every_repetition_takes_the_same_time(people_without_variation: list[Population]) -> None:
    for population in people_without_variation:
        durations = population.scenario.table.groupby(["participant", "configuration"])["duration_s"]
        assert durations.count().max() > 1
        assert (durations.max() - durations.min()).max() <= 1.01 / SCENARIO.rate_hz


@pytest.mark.parametrize("exponent", [1.0, SHARP])
def test_without_variation_drawing_does_not_beat_the_mode(people_without_variation: list[Population], exponent: float) -> None:
    def p_prob(population: Population) -> MotionModel:
        return replace(population.model, exponent=exponent)

    assert not beats(gains(people_without_variation, p_adapt, p_prob))


def test_positive_control_draws_that_know_the_duration_beat_the_mode(people_without_variation: list[Population]) -> None:
    assert beats(gains(people_without_variation, p_adapt, told_the_duration))
