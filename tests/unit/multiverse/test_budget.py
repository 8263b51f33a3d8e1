"""What the budget affords: more minutes more walks, never more than the study's own, and one clear message for too few."""

import pytest

from walklab.errors import InputError
from walklab.multiverse.budget import Walked, affordable

STUDY = Walked(
    people=30, straight=8, turning=8, straight_repetitions=5, turning_repetitions=3, training_flawed=72,
    sets=(20, 19, 18, 17, 19, 18, 17, 18, 18, 17), walks_per_set=17, scenario_flawed=7,
)  # fmt: skip


def size(minutes, specifications=150):
    return affordable(minutes, specifications, STUDY)


NEEDED = size(0).minutes  # to walk everything once


def test_a_longer_budget_never_gives_fewer_walks_and_is_kept():
    budgets = [NEEDED * times for times in (1.0, 1.4, 2.0, 3.0)]
    sizes = [size(minutes) for minutes in budgets]
    walks = [one.walked.walks for one in sizes]
    assert walks == sorted(walks)
    assert walks[0] < walks[-1]
    assert all(one.minutes <= minutes for one, minutes in zip(sizes, budgets, strict=True))


def test_few_specifications_get_the_whole_study_and_no_more():
    assert size(60, specifications=1).walked == STUDY
    assert STUDY.walks == 30 * (8 * 5 + 8 * 3) + 181 * 17


def test_spoilt_walks_keep_their_share():
    once = size(NEEDED)
    assert once.repetitions == 1
    assert once.walked.training_flawed == round(72 * 16 / 64)
    assert once.walked.sets == (2,) * 10


def test_too_few_minutes_end_in_one_message():
    with pytest.raises(InputError, match=r"budget_minutes: 1 are too few for 150 specifications on 820 walks each; give \d+"):
        size(1).checked(1)
