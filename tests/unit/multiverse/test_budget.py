"""What the budget affords: more minutes more walks, never more than the study's own, and one clear message for too few."""

import pytest

from walklab.capture.scenario import ScenarioDesign
from walklab.capture.training import TrainingDesign
from walklab.errors import InputError
from walklab.multiverse.budget import affordable

TRAINING, SCENARIOS = TrainingDesign(), ScenarioDesign(flawed_walks=7)


def size(minutes, specifications=150):
    return affordable(minutes, specifications, TRAINING, SCENARIOS, people=30, walks_per_set=17)


NEEDED = size(0).minutes  # to walk everything once


def test_a_longer_budget_never_gives_fewer_walks_and_is_kept():
    budgets = [NEEDED * times for times in (1.0, 1.4, 2.0, 3.0)]
    sizes = [size(minutes) for minutes in budgets]
    walks = [one.walks for one in sizes]
    assert walks == sorted(walks)
    assert walks[0] < walks[-1]
    assert all(one.minutes <= minutes for one, minutes in zip(sizes, budgets, strict=True))


def test_few_specifications_get_the_whole_study_and_no_more():
    whole = size(60, specifications=1)
    assert whole.training == TRAINING
    assert whole.scenarios == SCENARIOS
    assert whole.walks == 30 * (8 * 5 + 8 * 3) + 181 * 17


def test_spoilt_walks_keep_their_share():
    once = size(NEEDED)
    assert once.repetitions == 1
    assert once.training.flawed_walks == round(72 * 16 / 64)
    assert once.scenarios.sets == (2,) * 10


def test_too_few_minutes_end_in_one_message():
    with pytest.raises(InputError, match=r"budget_minutes: 1 are too few for 150 specifications on 820 walks each; give \d+"):
        size(1).checked(1)
