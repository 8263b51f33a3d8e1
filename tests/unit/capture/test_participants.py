import numpy as np
import pytest

from walklab.capture.participants import Distribution, Group, draw_participants, fit_to_moments
from walklab.errors import InputError
from walklab.randomness import generator


@pytest.mark.parametrize("name", ["training", "scenarios", "long_distance"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_sample_has_the_published_moments_and_extremes(groups, constants, name, seed):
    group = groups[name]
    people = draw_participants(group, constants, generator(seed, 0, name))
    assert len(people) == group.count
    assert (people["sex"] == "female").sum() == group.female
    for column, digits in (("age_years", 0.5), ("height_m", 0.001), ("mass_kg", 0.1)):
        wanted, values = getattr(group, column), people[column]
        if wanted is None:
            continue
        assert values.min() == pytest.approx(wanted.min, abs=digits)
        assert values.max() == pytest.approx(wanted.max, abs=digits)
        assert values.mean() == pytest.approx(wanted.mean, abs=0.05 * wanted.sd + digits)
        assert values.std() == pytest.approx(wanted.sd, rel=0.06)


def test_mass_goes_with_height_and_women_are_shorter(groups, constants):
    pooled = [draw_participants(groups["training"], constants, generator(seed, 0, "training")) for seed in range(20)]
    correlations = [people["height_m"].corr(people["mass_kg"]) for people in pooled]
    assert 0.3 < np.mean(correlations) < 0.65
    shorter = [p.loc[p.sex == "male", "height_m"].mean() - p.loc[p.sex == "female", "height_m"].mean() for p in pooled]
    assert np.mean(shorter) > 0.05


def test_impossible_moments_still_respect_the_limits():
    fitted = fit_to_moments(np.arange(10.0), Distribution(mean=5.0, sd=9.0, min=0.0, max=10.0))
    assert fitted.min() == 0.0
    assert fitted.max() == 10.0


def test_more_women_than_people_is_refused(groups, constants):
    age = groups["training"].age_years
    with pytest.raises(InputError, match="female"):
        draw_participants(Group("x", 4, 5, age, age), constants, generator(1))
