"""The law of the exponent: found where there is one, covering, and never chosen by whom it is judged on."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from walklab.evaluation.sharpness_law import ExponentScores, choose_law, law_table, required_coverage
from walklab.steering.sharpness import LADDER


def scores_by_law(rng: np.random.Generator, people: int = 30) -> ExponentScores:
    """Walks whose right exponent is 4 at d = 0 and 32 at d = 1; sharper intervals hold less."""
    d = rng.uniform(0, 1, (people * 20, 1))
    away = np.log2(np.array(LADDER)) - (2 + 3 * d)
    held = rng.random(len(d))[:, None] < np.clip(0.9 - 0.1 * away, 0, 1)
    owners = [f"p{i % people}" for i in range(len(d))]
    return ExponentScores(owners, d, 1 + away**2, 1 + away**2, held)


def test_law_of_the_exponent_is_found_and_covers_a_new_person() -> None:
    scores = scores_by_law(np.random.default_rng(3))
    law, table = choose_law(scores)
    assert law.column == 0
    assert law.slope > 0.25
    table = table.set_index("kind")
    assert table.loc["law", "loss"] < table.loc["constant", "loss"]
    assert table.loc["covering law", "coverage_90"] > table.loc["law", "coverage_90"]
    assert required_coverage(9) == required_coverage(3) == 0.9  # too few to promise anything
    walks = np.arange(len(scores.participants))
    assert scores.covered[walks, law.rungs(scores.vectors)].mean() >= required_coverage(30) == pytest.approx(0.93)


def test_nested_scores_of_a_participant_are_by_a_law_of_the_others() -> None:
    """With two people who need opposite exponents, each is scored by what suits the other."""
    sharp, flat = (1 + (np.log2(np.array(LADDER)) - right) ** 2 for right in (6.0, 0.0))
    scores = np.stack([sharp, flat])
    held = np.ones((2, len(LADDER)), bool)
    given = ExponentScores(["a", "b"], np.zeros((2, 1)), scores, scores, held)
    table = choose_law(given)[1].set_index("kind")
    assert table.loc["constant", "crps_s"] == pytest.approx(1 + 36)


def test_what_is_drawn_of_the_law_is_what_was_chosen() -> None:
    scores = scores_by_law(np.random.default_rng(3))
    law, laws = choose_law(scores)
    ladder = [{"model": "P_Prob", "kind": "exponent", "value": value, "crps_s": 1.0, "coverage_90": 0.9} for value in LADDER]
    drawn = law_table(pd.concat([pd.DataFrame(ladder), laws]), law, ["d"], scores.vectors, 30).set_index("quantity")
    assert drawn.loc["required_coverage", "value"] == required_coverage(30)
    assert drawn.loc["coverage_of_law", "value"] == laws.set_index("kind").loc["covering law", "coverage_90"]
    at = drawn.loc["exponent_by_d"]
    np.testing.assert_array_equal(at["value"], law.exponents(at[["at"]]))
    assert (at["at"].min(), at["at"].max()) == (scores.vectors.min(), scores.vectors.max())
    assert len(drawn.loc["coverage_by_exponent"]) == len(drawn.loc["crps_by_exponent"]) == len(LADDER)
