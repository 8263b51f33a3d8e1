"""The list of specifications: everything is varied once, combinations are reproducible, the table keeps it all."""

from collections import Counter

import numpy as np
import pandas as pd
import pytest

from walklab.capture.ranges import RANGES
from walklab.errors import InputError
from walklab.multiverse.choices import READINGS, Choices
from walklab.multiverse.specifications import (
    CHOICE,
    COMBINATION,
    CONSTANT,
    DEFAULT,
    specifications,
)
from walklab.multiverse.table import specification_named, specification_table
from walklab.randomness import generator

BASELINE = Choices()


def listed(combinations=64, seed=1, **settings):
    return specifications(BASELINE, combinations, generator(seed, "multiverse"), **settings)


def test_every_reading_of_every_ambiguity_is_tried_once_on_its_own():
    changes = [one.choices.differences(BASELINE) for one in listed() if one.kind == CHOICE]
    assert all(len(change) == 1 for change in changes)
    tried = Counter(pair for change in changes for pair in change.items())
    wanted = {(name, value) for name, one in READINGS.items() for value in one.values} - set(vars(BASELINE).items())
    assert tried == Counter(wanted)


def test_both_ends_of_every_uncertain_constant_are_tried_once_on_their_own():
    places = Counter(pair for one in listed() if one.kind == CONSTANT for pair in one.positions.items())
    assert places == Counter({(name, place): 1 for name in RANGES for place in (0.0, 1.0)})
    assert all(one.choices == BASELINE for one in listed() if one.kind in (DEFAULT, CONSTANT))


def test_combinations_are_the_same_for_one_seed_and_cover_every_reading_they_may_draw():
    first, again, other = ([one for one in listed(seed=seed) if one.kind == COMBINATION] for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert len(first) == 64
    for name, one in READINGS.items():
        assert {getattr(found.choices, name) for found in first} == set(one.combined)
    assert all(set(found.positions) == set(RANGES) for found in first)
    places = np.array([list(found.positions.values()) for found in first])
    assert places.min() < 0.02
    assert places.max() > 0.98
    assert abs(places.mean() - 0.5) < 0.03


def test_names_are_unique_and_can_be_names_of_folders():
    names = [one.name for one in listed()]
    assert len(names) == len(set(names))
    assert all(name.replace("_", "").replace("-", "").isalnum() for name in names)


def test_the_table_gives_every_specification_back(tmp_path):
    found = listed(combinations=3)
    specification_table(found).to_parquet(tmp_path / "table.parquet")
    table = pd.read_parquet(tmp_path / "table.parquet")
    assert [specification_named(table, one.name) for one in found] == found
    with pytest.raises(InputError, match="0 rows are called 'nothing'"):
        specification_named(table, "nothing")


def test_another_reading_as_the_default_is_not_tried_against_itself():
    baseline = Choices(weights="uniform")
    found = specifications(baseline, 0, generator(1), vary=["weights"])
    assert [one.choices.weights for one in found] == ["uniform", "linear", "inverse"]
    assert [one.changed(baseline) for one in found] == ["", "weights: linear", "weights: inverse"]


def test_only_what_is_named_varies():
    found = listed(combinations=2, vary=["braking", "start"])
    assert [one.name for one in found] == [
        "default", "braking-no", "start-low", "start-high", "combination-00", "combination-01",
    ]  # fmt: skip
    with pytest.raises(InputError, match="'brakes'; choose from"):
        listed(vary=["brakes"])


def test_a_reading_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match="choice weights: there is no 'cubic'"):
        Choices(weights="cubic")
