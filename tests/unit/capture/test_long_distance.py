import numpy as np
import pytest

from walklab.capture.long_distance import LongDistanceDesign, record_long_distance
from walklab.capture.participants import draw_participants
from walklab.randomness import generator

REFERENCE_S = {10.0: (6.310, 0.538), 25.0: (15.685, 1.428), 50.0: (29.260, 2.395)}  # Agethen et al. 2017, 8.3: median, IQR


@pytest.fixture(scope="module")
def times(groups, constants):
    drawn = [draw_participants(groups["long_distance"], constants, generator(seed, 0, "long")) for seed in range(20)]
    return [record_long_distance(people, LongDistanceDesign(), constants, seed, 0) for seed, people in enumerate(drawn)]


def test_travel_times_are_near_the_published_ones(times):
    """Over twenty groups of ten: the expected median within 5 %, the expected spread within a third."""
    for distance, (median, spread) in REFERENCE_S.items():
        own = [table.loc[table["distance_m"] == distance, "travel_time_s"] for table in times]
        assert np.mean([values.median() for values in own]) == pytest.approx(median, rel=0.05)
        assert np.mean([values.quantile(0.75) - values.quantile(0.25) for values in own]) == pytest.approx(spread, rel=0.34)


def test_times_are_whole_frames_of_the_video(times):
    frames = times[0]["travel_time_s"] * 25
    np.testing.assert_allclose(frames, np.round(frames), atol=1e-9)
    assert len(times[0]) == 10 * 3 * 4
    assert times[0]["walk"].is_unique


def test_a_subset_gives_the_same_times(groups, constants, times):
    people = draw_participants(groups["long_distance"], constants, generator(0, 0, "long"))
    some = record_long_distance(people.iloc[[7]], LongDistanceDesign(), constants, 0, 0)
    whole = times[0][times[0]["participant"] == people["participant"].iloc[7]]
    np.testing.assert_array_equal(some["travel_time_s"], whole["travel_time_s"])
