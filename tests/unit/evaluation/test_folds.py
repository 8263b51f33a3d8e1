"""Splits by participant against the sets they are made of."""

import numpy as np
import pytest

from walklab.errors import InputError
from walklab.evaluation.folds import by_participant


def test_every_walk_is_left_out_once_and_never_beside_a_walk_of_its_person():
    owners = np.random.default_rng(3).choice(list("CADB"), size=60)
    folds = by_participant(owners)
    assert list(folds) == ["A", "B", "C", "D"]
    for name, (known, asked) in folds.items():
        assert set(owners[asked]) == {name}
        assert name not in owners[known]
        assert sorted([*known, *asked]) == list(range(60))
    assert sorted(np.concatenate([asked for _, asked in folds.values()])) == list(range(60))


def test_too_few_participants_are_refused():
    with pytest.raises(InputError, match="2 participants are too few; at least 3"):
        by_participant(["A", "B", "A"], least=3)
