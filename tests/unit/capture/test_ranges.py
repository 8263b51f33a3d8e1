"""Ranges of the generator's constants: they hold the values, and moving one moves nothing else."""

import dataclasses

import pytest

from walklab.capture.constants import WalkerConstants
from walklab.capture.ranges import RANGES, constant, constants_at
from walklab.errors import InputError

OWN = WalkerConstants()


@pytest.mark.parametrize("name", RANGES)
def test_every_range_holds_the_generators_own_value(name):
    for path, (low, high) in RANGES[name].constants.items():
        assert low <= constant(OWN, path) <= high
        assert low < high
    assert RANGES[name].source


@pytest.mark.parametrize("name", RANGES)
@pytest.mark.parametrize("place", [0.0, 0.25, 1.0])
def test_a_place_in_a_range_moves_its_constants_and_no_other(name, place):
    moved = constants_at({name: place})
    for path, (low, high) in RANGES[name].constants.items():
        assert constant(moved, path) == pytest.approx(low + place * (high - low))
    tops = {path.split(".")[0] for path in RANGES[name].constants}
    for field in dataclasses.fields(OWN):
        if field.name not in tops:
            assert getattr(moved, field.name) == getattr(OWN, field.name)


def test_no_place_leaves_all_as_it_is():
    assert constants_at({}) == OWN


def test_no_constant_stands_in_two_ranges():
    paths = [path for one in RANGES.values() for path in one.constants]
    assert len(paths) == len(set(paths))


@pytest.mark.parametrize("positions", [{"gravity": 0.5}, {"turn_exponent": 1.5}])
def test_an_unknown_name_or_a_place_outside_is_refused(positions):
    with pytest.raises(InputError, match="choose a place from 0 to 1"):
        constants_at(positions)
