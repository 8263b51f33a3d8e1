"""How many walks the multiverse can afford."""

from __future__ import annotations

from dataclasses import dataclass, replace

from walklab.errors import InputError

# Processor time on a 2.6 GHz Xeon on a slow day, 1000 cells, of what records its own population (four in five do; the others take
# half as long). An indication, not a promise.
SECONDS_PER_SPECIFICATION = 15.0
SECONDS_PER_WALK = 0.016
CORES = 2  # that the budget is meant for; results must not depend on how many there are
SETS_PER_REPETITION = 2  # of the scenarios with each repetition of the training: about the paper's 181 sets and 1848 walks


@dataclass(frozen=True)
class Walked:
    """What is walked in both experiments.

    Attributes
    ----------
    people : participants of the training
    straight, turning : configurations of the training
    straight_repetitions, turning_repetitions : how often each is walked
    training_flawed : walks of the training that are spoilt
    sets : of each participant of the scenarios
    walks_per_set : of all scenarios together
    scenario_flawed : walks of each scenario that are spoilt
    """

    people: int
    straight: int
    turning: int
    straight_repetitions: int
    turning_repetitions: int
    training_flawed: int
    sets: tuple[int, ...]
    walks_per_set: int
    scenario_flawed: int

    @property
    def training_walks(self) -> int:
        """Walks of the training."""
        return self.people * (self.straight * self.straight_repetitions + self.turning * self.turning_repetitions)

    @property
    def walks(self) -> int:
        """All walks."""
        return self.training_walks + sum(self.sets) * self.walks_per_set

    def thinned(self, repetitions: int) -> Walked:
        """The same with each configuration walked at most so often; as large a share of the walks is spoilt as before."""
        fewer = replace(
            self,
            straight_repetitions=min(repetitions, self.straight_repetitions),
            turning_repetitions=min(repetitions, self.turning_repetitions),
            sets=tuple(min(SETS_PER_REPETITION * repetitions, most) for most in self.sets),
        )
        return replace(
            fewer,
            training_flawed=round(self.training_flawed * fewer.training_walks / self.training_walks),
            scenario_flawed=round(self.scenario_flawed * sum(fewer.sets) / sum(self.sets)),
        )


@dataclass(frozen=True)
class Size:
    """What each specification is run on.

    Attributes
    ----------
    specifications : how many there are
    repetitions : how often every training configuration is walked at most; 0 if the budget does not even allow once
    walked : what is walked then (once, if not even that is allowed)
    minutes : expected duration of all specifications on two cores
    """

    specifications: int
    repetitions: int
    walked: Walked
    minutes: float

    def checked(self, budget_minutes: float) -> Size:
        """Itself; InputError if the budget does not allow it."""
        if self.repetitions == 0:
            raise InputError(
                f"config key multiverse.budget_minutes: {budget_minutes:g} are too few for {self.specifications} specifications"
                f" on {self.walked.walks} walks each; give {self.minutes:.0f}, or vary less"
            )
        return self

    def __str__(self) -> str:
        return (
            f"{self.specifications} specifications on about {self.walked.walks} walks each (every configuration of the training"
            f" {self.walked.straight_repetitions} times by everybody); expected {self.minutes:.0f} min on {CORES} cores"
        )


def affordable(budget_minutes: float, specifications: int, study: Walked) -> Size:
    """What can be walked as often as the budget allows, and at most as often as in the study."""
    by_sets = -(-max(study.sets) // SETS_PER_REPETITION)
    for repetitions in range(max(study.straight_repetitions, study.turning_repetitions, by_sets), 0, -1):
        size = _size(specifications, repetitions, study.thinned(repetitions))
        if size.minutes <= budget_minutes:
            return size
    return replace(_size(specifications, 1, study.thinned(1)), repetitions=0)


def _size(specifications: int, repetitions: int, walked: Walked) -> Size:
    seconds = specifications * (SECONDS_PER_SPECIFICATION + SECONDS_PER_WALK * walked.walks)
    return Size(specifications, repetitions, walked, seconds / 60 / CORES)
