"""Counts over replicates against the definition of the Wilson interval, differences against what was put in."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.evaluation.claims import NOT_CHECKABLE, NOT_REPRODUCED, PARTLY, REPRODUCED, load_paper
from walklab.evaluation.replicates import DIFFERENCE, ENERGY_DIFFERENCE, MEASURES, count_claims, pool_scores
from walklab.evaluation.subject_scores import OWN_MAP

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def paper():
    return load_paper(ROOT / "config/papers/agethen_steering.yaml")


def verdicts(paper, by_claim, default=NOT_REPRODUCED):
    """One table of verdicts per replicate; ``by_claim``: id -> its verdict in every replicate."""
    count = len(next(iter(by_claim.values())))
    return [
        pd.DataFrame(
            {
                "id": claim.id,
                "section": claim.section,
                "statement": claim.statement,
                "published": "1",
                "ours": float(number),
                "verdict": by_claim.get(claim.id, [default] * count)[number],
                "note": "why not",
            }
            for claim in paper.claims
        )
        for number in range(count)
    ]


def wilson(held, of):
    """The roots of (p - share)^2 = z^2 p (1 - p) / n."""
    z, share = 1.959963984540054, held / of
    roots = np.roots([1 + z**2 / of, -(2 * share + z**2 / of), share**2])
    return sorted(roots.real)


def test_a_claim_is_counted_by_verdict_with_the_interval_of_wilson(paper):
    directed = next(claim.id for claim in paper.claims if claim.direction and not claim.parts)
    outcomes = [REPRODUCED] * 3 + [PARTLY] * 4 + [NOT_REPRODUCED] * 2 + [NOT_CHECKABLE]
    row = count_claims(paper, verdicts(paper, {directed: outcomes})).set_index("id").loc[directed]
    assert (row["replicates"], row["reproduced"], row["direction_held"]) == (9, 3, 7)
    assert [row["reproduced_low"], row["reproduced_high"]] == pytest.approx(wilson(3, 9))
    assert [row["direction_held_low"], row["direction_held_high"]] == pytest.approx(wilson(7, 9))
    assert (row["ours_min"], row["ours_median"], row["ours_max"]) == (0, 4, 8)


def test_only_a_figure_with_a_direction_has_one_that_can_hold(paper):
    table = count_claims(paper, verdicts(paper, {paper.claims[0].id: [PARTLY, PARTLY]}, PARTLY)).set_index("id")
    for claim in paper.claims:
        directed = claim.ours is not None and len(claim.direction) > 0
        assert table.loc[claim.id, "direction_held"] == 2 if directed else np.isnan(table.loc[claim.id, "direction_held"])
    assert {bool(claim.direction) for claim in paper.claims} == {True, False}


def test_a_claim_that_no_replicate_could_check_has_no_share_and_says_why(paper):
    claim = paper.claims[0].id
    row = count_claims(paper, verdicts(paper, {claim: [NOT_CHECKABLE] * 2})).set_index("id").loc[claim]
    assert row["replicates"] == 0
    assert np.isnan(row["reproduced"])
    assert row["note"] == "why not"


def test_tables_of_another_paper_are_refused(paper):
    tables = verdicts(paper, {paper.claims[0].id: [REPRODUCED] * 2})
    with pytest.raises(InputError, match="not all of this paper"):
        count_claims(paper, [tables[0], tables[1].iloc[1:]])


def scores(crps, scenario="scenario_1"):
    """A replicate's table of scores from model -> CRPS."""
    information = {name: "the walk itself" if name == OWN_MAP else "task" for name in crps}
    rows = [
        {"scenario": scenario, "hull": "all", "model": name, "information": information[name]}
        | dict.fromkeys(MEASURES, 0.5)
        | {"crps_s": value, "energy_m": np.nan}
        for name, value in crps.items()
    ]
    return pd.DataFrame(rows)


def test_differences_are_taken_within_a_replicate():
    # The populations differ far more than the models do.
    tables = [scores({"P_Prob (calibrated)": level + gap, "regression": level}) for level, gap in ((1, 0.1), (5, 0.2), (9, 0.3))]
    pooled = pool_scores(tables)
    row = pooled[pooled["measure"] == DIFFERENCE].iloc[0]
    assert (row["model"], row["against"]) == ("P_Prob (calibrated)", "regression")
    half = 4.302652729911275 * 0.1 / np.sqrt(3)  # Student's t with 2 degrees of freedom
    assert [row["value"], row["low"], row["high"]] == pytest.approx([0.2, 0.2 - half, 0.2 + half])
    assert (row["below_zero"], row["replicates"]) == (0, 3)


def test_every_variant_of_p_prob_meets_every_other_forecast_in_each_scenario():
    names = {"P_Prob (literal)": 1.0, "P_Prob (calibrated)": 2.0, "regression": 3.0, OWN_MAP: 0.1}
    tables = [pd.concat([scores(names), scores(names, "scenario_2")]) for _ in range(2)]
    pooled = pool_scores(tables)
    differences = pooled[pooled["measure"] == DIFFERENCE]
    assert len(differences) == 2 * 2 * 3
    assert not (differences["model"] == differences["against"]).any()
    found = differences.set_index(["scenario", "model", "against"])["value"]
    assert found["scenario_2", "P_Prob (literal)", "regression"] == pytest.approx(-2)
    assert "energy_m" not in set(pooled["measure"]), "a score that no forecast has is no row"
    assert ENERGY_DIFFERENCE not in set(pooled["measure"])


def test_energy_scores_differ_apart_from_crps():
    tables = [
        scores({"P_Prob (literal)": 1.0, "regression": 3.0}).assign(energy_m=[0.2 + level, 0.3 + level]) for level in (0, 5)
    ]
    row = pool_scores(tables).query("measure == @ENERGY_DIFFERENCE").iloc[0]
    assert (row["model"], row["against"], row["below_zero"]) == ("P_Prob (literal)", "regression", 2)
    assert row["value"] == pytest.approx(-0.1)


def test_the_interval_holds_the_true_mean_as_often_as_it_says():
    rng = np.random.default_rng(3)
    drawn = rng.normal(1, 0.2, (5, 400))  # every column a study of five replicates
    tables = [pd.concat([scores({"regression": value}, f"study_{i}") for i, value in enumerate(row)]) for row in drawn]
    pooled = pool_scores(tables)
    rows = pooled[pooled["measure"] == "crps_s"]
    assert len(rows) == 400
    assert 0.92 < ((rows["low"] <= 1) & (rows["high"] >= 1)).mean() < 0.98
