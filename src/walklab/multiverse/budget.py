"""How many walks the multiverse can afford."""

from __future__ import annotations

from dataclasses import dataclass, replace

from walklab.capture.scenario import ScenarioDesign
from walklab.capture.training import TrainingDesign
from walklab.errors import InputError

# Measured on 2 cores of a 2.6 GHz EPYC, 1000 cells; an indication, not a promise.
SECONDS_PER_SPECIFICATION = 12.0
SECONDS_PER_WALK = 0.015
CORES = 2  # that the budget is meant for; results must not depend on how many there are
SETS_PER_REPETITION = 2  # of the scenarios with each repetition of the training: about the paper's 181 sets and 1848 walks


@dataclass(frozen=True)
class Size:
    """What one specification is run on.

    Attributes
    ----------
    specifications : how many there are
    repetitions : how often every training configuration is walked; 0 if the budget does not even allow one
    training, scenarios : the designs, thinned to that
    walks : about how many those are
    minutes : expected duration of all specifications on two cores
    """

    specifications: int
    repetitions: int
    training: TrainingDesign
    scenarios: ScenarioDesign
    walks: int
    minutes: float

    def checked(self, budget_minutes: float) -> Size:
        """Itself; InputError if the budget does not allow it."""
        if self.repetitions == 0:
            raise InputError(
                f"config key multiverse.budget_minutes: {budget_minutes:g} are too few for {self.specifications} specifications"
                f" on {self.walks} walks each; give {self.minutes:.0f}, or vary less"
            )
        return self

    def __str__(self) -> str:
        return (
            f"multiverse: {self.specifications} specifications on about {self.walks} walks each (every training configuration"
            f" {max(self.repetitions, 1)} times by everybody); expected {self.minutes:.0f} min on {CORES} cores"
        )


def affordable(
    budget_minutes: float,
    specifications: int,
    training: TrainingDesign,
    scenarios: ScenarioDesign,
    people: int,
    walks_per_set: int,
) -> Size:
    """The designs of both experiments, walked as often as the budget allows and at most as often as they say.

    Parameters
    ----------
    training, scenarios : as in the study
    people : participants of the training
    walks_per_set : walks of one set of all scenarios together
    """
    for repetitions in range(_most(training, scenarios), 0, -1):
        size = _thinned(repetitions, specifications, training, scenarios, people, walks_per_set)
        if size.minutes <= budget_minutes:
            return size
    return replace(_thinned(1, specifications, training, scenarios, people, walks_per_set), repetitions=0)


def _most(training: TrainingDesign, scenarios: ScenarioDesign) -> int:
    by_sets = -(-max(scenarios.sets) // SETS_PER_REPETITION)
    return max(training.straight_repetitions, training.turning_repetitions, by_sets)


def _thinned(
    repetitions: int, specifications: int, training: TrainingDesign, scenarios: ScenarioDesign, people: int, walks_per_set: int
) -> Size:
    straight, turning = (min(repetitions, most) for most in (training.straight_repetitions, training.turning_repetitions))
    turns = len(training.turning_angles_deg) * len(training.turning_distances_m)
    walks = people * (len(training.straight_distances_m) * straight + turns * turning)
    all_walks = people * (
        len(training.straight_distances_m) * training.straight_repetitions + turns * training.turning_repetitions
    )
    sets = tuple(min(SETS_PER_REPETITION * repetitions, most) for most in scenarios.sets)
    # As large a share of the walks is spoilt as in the study.
    fewer = replace(
        training,
        straight_repetitions=straight,
        turning_repetitions=turning,
        flawed_walks=round(training.flawed_walks * walks / all_walks),
    )
    flawed = round(scenarios.flawed_walks * sum(sets) / sum(scenarios.sets))
    walks += sum(sets) * walks_per_set
    minutes = specifications * (SECONDS_PER_SPECIFICATION + SECONDS_PER_WALK * walks) / 60 / CORES
    return Size(specifications, repetitions, fewer, replace(scenarios, sets=sets, flawed_walks=flawed), walks, minutes)
