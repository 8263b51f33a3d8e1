"""Learned sharpness: what made the walks is found, and nobody reads what has to be forecast."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.errors import InputError
from walklab.evaluation.calibration import (
    Evidence,
    best_value,
    blend_others,
    candidate_table,
    choose_walks,
    chosen,
    extended_table,
    log_residuals,
)
from walklab.evaluation.forecasts import INFORMED, Asked, Known, all_forecasts
from walklab.evaluation.learned_baselines import gaussian_process, personal_regression, quantile_regression, with_residuals
from walklab.evaluation.pace import PaceEffect, fit_pace, paced
from walklab.evaluation.subject_scores import OWN_MAP
from walklab.planning.tracing import Traces
from walklab.steering.blending_space import homogenise
from walklab.steering.sharpness import Sharpness, cell_volumes
from walklab.steering.space import space_from_config

CELLS = 60
PEOPLE = [f"P{i}" for i in range(8)]


def evidence(exponent: float, walks: int = 400, pace_sd: float = 0.0, seed: int = 0) -> Evidence:
    """Walks drawn from a known density: suitability falls linearly from a best cell, sharpened by the exponent."""
    rng = np.random.default_rng(seed)
    speeds = np.linspace(0.5, 2.0, CELLS)
    travel_s = np.multiply.outer(rng.uniform(2, 4, walks), 1 / speeds)
    best = rng.uniform(0.9, 1.5, walks)
    suitability = 1 - np.abs(speeds - best[:, None]) / 1.6
    volumes = np.full(CELLS, 1 / CELLS)
    density = Sharpness("exponent", exponent).density(suitability, volumes)
    drawn = (density.cumsum(axis=1) < rng.random(walks)[:, None]).sum(axis=1)
    places = np.zeros((walks, CELLS, 2, 2), np.float32)
    places[..., 0] = speeds[:, None]
    owners = [PEOPLE[i % len(PEOPLE)] for i in range(walks)]
    pace = dict(zip(PEOPLE, np.exp(pace_sd * rng.normal(size=len(PEOPLE))), strict=True))
    factor = np.array([pace[owner] for owner in owners])
    distances = np.abs(speeds - speeds[drawn][:, None]).astype(np.float32)
    captured = travel_s[np.arange(walks), drawn] * factor
    traces = Traces(travel_s.astype(np.float32), np.ones((walks, CELLS), bool), places)
    return Evidence(owners, captured, suitability, 1 - suitability, suitability, traces, distances, volumes)


@pytest.mark.parametrize("exponent", [4.0, 20.0])
def test_the_exponent_that_made_the_walks_is_found(exponent: float) -> None:
    candidates = {"exponent": (1.0, 2.0, 4.0, 9.0, 20.0, 45.0), "threshold": (0.5, 0.9), "temperature": (0.05, 0.2)}
    table = candidate_table(evidence(exponent), candidates)
    assert best_value(table) == exponent
    row = table[(table["model"] == "P_Prob") & (table["value"] == exponent)].iloc[0]
    assert 0.85 < row["coverage_90"] < 0.95
    assert set(table["kind"]) == {"exponent", "threshold", "temperature"}


def test_densities_sum_to_one_and_follow_their_formulas() -> None:
    space = space_from_config(
        [{"name": "v", "unit": "m/s", "start": 0.0, "step": 1.0, "count": 3}, {"name": "a", "unit": "", "values": [0, 1, 3]}]
    )
    volumes = cell_volumes(space)
    np.testing.assert_allclose(volumes.reshape(3, 3), np.outer([0.25, 0.5, 0.25], [1 / 6, 1 / 2, 1 / 3]))
    maps = np.random.default_rng(0).uniform(0, 1, (4, 9))
    for sharpness, raw in (
        (Sharpness("exponent", 3), maps**3),
        (Sharpness("threshold", 0.5), np.maximum(maps - 0.5 * maps.max(axis=1, keepdims=True), 0)),
        (Sharpness("temperature", 0.2), np.exp(-maps / 0.2)),
    ):
        weighted = raw * volumes
        np.testing.assert_allclose(sharpness.density(maps, volumes), weighted / weighted.sum(axis=1, keepdims=True))
    assert np.isfinite(Sharpness("exponent", 5000).density(maps / 100, volumes)).all()
    with pytest.raises(InputError, match="out of range"):
        Sharpness("threshold", 1.0)


def test_blends_of_a_participant_hold_no_map_of_that_participant() -> None:
    """Everything measured of P3 changes: P3's own blends do not, everybody else's do."""
    rng = np.random.default_rng(2)
    owners = [PEOPLE[i % 8] for i in range(64)]
    vectors, maps = rng.uniform(0, 1, (64, 2)), rng.uniform(0, 1, (64, 10))
    blending = homogenise(vectors, maps, 200, 12, 3, 0.1, np.random.default_rng(1), names=("length", "height"))
    other = maps.copy()
    own = np.array([owner == "P3" for owner in owners])
    other[own] = rng.uniform(0, 1, (own.sum(), 10))
    changed = homogenise(vectors, other, 200, 12, 3, 0.1, np.random.default_rng(1), names=("length", "height"))
    everybody = np.arange(64)
    (before,) = blend_others(blending, owners, everybody, vectors, (maps,), 20, "linear")
    (after,) = blend_others(changed, owners, everybody, vectors, (other,), 20, "linear")
    np.testing.assert_array_equal(before[own], after[own])
    assert (before[~own] != after[~own]).any(axis=1).mean() > 0.9
    # The vector asked for is the run-time one, whatever the blending space is indexed by.
    (moved,) = blend_others(blending, owners, everybody, vectors + 0.3, (maps,), 20, "linear")
    assert np.any(moved != before)


def test_walks_are_chosen_equally_from_everybody() -> None:
    owners = ["a"] * 30 + ["b"] * 3
    rows = choose_walks(owners, 5, np.random.default_rng(0))
    assert list(np.sort(rows)) == list(rows)
    assert [sum(owners[row] == name for row in rows) for name in "ab"] == [5, 3]


def test_pace_effect_is_recovered_and_informs_only_later_walks() -> None:
    rng = np.random.default_rng(4)
    owners = np.repeat([f"p{i}" for i in range(300)], 8)
    effect = np.repeat(rng.normal(0.03, 0.1, 300), 8)
    residuals = effect + rng.normal(0, 0.05, 2400)
    fitted = fit_pace(residuals, owners.tolist())
    assert fitted.mean == pytest.approx(0.03, abs=0.02)
    assert fitted.person_sd == pytest.approx(0.1, rel=0.1)
    assert fitted.walk_sd == pytest.approx(0.05, rel=0.05)
    known = PaceEffect(0.03, 0.1, 0.05)
    mean, sd = known.posterior(residuals, owners.tolist())
    # The textbook posterior of a normal mean, before the fourth walk of the first person.
    precision = 1 / 0.1**2 + 3 / 0.05**2
    assert mean[3] == pytest.approx((0.03 / 0.1**2 + residuals[:3].sum() / 0.05**2) / precision)
    assert sd[3] == pytest.approx(precision**-0.5)
    changed = residuals.copy()
    changed[3] += 9
    again, _ = known.posterior(changed, owners.tolist())
    np.testing.assert_array_equal(again[:4], mean[:4])
    assert again[4] != mean[4]
    np.testing.assert_array_equal(again[8:], mean[8:])
    # Standardised by the posterior, the effects are standard normal.
    z = (effect - mean) / sd
    assert stats.kstest(z[::8], "norm").pvalue > 1e-3
    assert stats.kstest(z[7::8], "norm").pvalue > 1e-3


def test_paced_members_are_lognormal_about_a_point() -> None:
    levels = (np.arange(200) + 0.5) / 200
    members = paced(np.full((1, 50), 3.0), np.array([0.1]), np.array([0.06]), 0.08, levels)
    assert np.median(members) == pytest.approx(3 * np.exp(0.1), rel=1e-3)
    assert np.log(members).std() == pytest.approx(0.1, rel=0.1)


def test_extended_model_learns_the_pace_of_people() -> None:
    with_pace, without = (
        extended_table(evidence(40.0, pace_sd=sd), (10.0, 40.0, 160.0)).set_index("value") for sd in (0.15, 0.0)
    )
    assert with_pace.loc[40.0, "person_sd"] == pytest.approx(0.15, abs=0.08)
    assert without.loc[40.0, "person_sd"] < 0.03
    assert 0.8 < with_pace.loc[40.0, "coverage_90"] < 0.98


def study(seed: int = 5) -> tuple[Known, Asked, np.ndarray]:
    rng = np.random.default_rng(seed)
    learned, asked = evidence(20.0, 160, 0.1, seed), evidence(20.0, 40, 0.1, seed + 1)
    vectors = rng.uniform(1, 4, (160, 2))
    known = Known(
        vectors[:, 0] * 1.2 + rng.normal(0, 0.2, 160) + 1,
        vectors[:, 0],
        vectors,
        learned.participants,
        np.arange(0, 160, 4),
        rng.normal(0, 0.2, 40),
        rng.normal(0, 0.3, 40),
        learned.suitability.mean(axis=0),
    )
    wanted = rng.uniform(1, 4, (40, 2))
    times = asked.captured_s + rng.normal(0, 0.2, (3, 40))
    target = Asked(
        asked.captured_s, wanted[:, 0], wanted, asked.participants, asked.suitability, *times, asked.traces, asked.distances_m
    )
    return known, target, learned.volumes


def test_no_forecast_of_a_scenario_reads_the_captured_times() -> None:
    """The last walk's time changes: no forecast of any walk does, but the oracle's through its own input."""
    known, asked, volumes = study()
    table = pd.concat([candidate_table(evidence(20.0, 80)), extended_table(evidence(20.0, 80))], ignore_index=True)
    calibration = chosen(table)
    before = all_forecasts(known, asked, calibration, volumes)
    captured = asked.captured_s.copy()
    captured[-1] *= 3
    after = all_forecasts(known, replace(asked, captured_s=captured), calibration, volumes)
    assert len(before) == 14
    for name, forecast in before.items():
        np.testing.assert_array_equal(forecast.members_s, after[name].members_s, err_msg=name)
    # Of the first walk of all: only what is declared to use earlier walks changes, and only that person's later walks.
    captured = asked.captured_s.copy()
    captured[0] *= 3
    after = all_forecasts(known, replace(asked, captured_s=captured), calibration, volumes)
    own = np.array([name == asked.participants[0] for name in asked.participants])
    own[0] = False
    for name, forecast in before.items():
        changed = (forecast.members_s != after[name].members_s).any(axis=1)
        np.testing.assert_array_equal(changed, own if name in INFORMED else np.zeros(40, bool), err_msg=name)
    assert np.ptp(before[OWN_MAP].members_s, axis=1).max() == 0


def test_baselines_are_calibrated_where_their_assumptions_hold() -> None:
    rng = np.random.default_rng(8)
    x, wanted = rng.uniform(0, 3, (400, 2)), rng.uniform(0.2, 2.8, (2000, 2))
    truth = lambda d: 2 + 0.8 * d[:, 0]  # noqa: E731
    y, captured = truth(x) + rng.normal(0, 0.2, 400), truth(wanted) + rng.normal(0, 0.2, 2000)
    for members in (quantile_regression(y, x, wanted), gaussian_process(y[:150], x[:150], wanted)):
        low, high = np.quantile(members, [0.05, 0.95], axis=1)
        assert 0.86 < np.mean((low <= captured) & (captured <= high)) < 0.94
        assert np.abs(np.median(members, axis=1) - truth(wanted)).mean() < 0.06
    owners = [f"p{i % 40}" for i in range(400)]
    asked_owners = [f"q{i % 40}" for i in range(2000)]
    mine, theirs = (rng.normal(0, 0.5, 40)[[int(name[1:]) for name in names]] for names in (owners, asked_owners))
    members = personal_regression(y + mine, x, owners, captured + theirs, wanted, asked_owners)
    late = np.arange(2000) > 800
    assert np.abs(np.median(members, axis=1) - captured - theirs)[late].mean() < 0.2  # the noise alone is 0.16
    spread = with_residuals([2.0], rng.normal(0.1, 0.2, 5000), 400)[0]
    assert spread.mean() == pytest.approx(2.1, abs=0.01)
    assert spread.std() == pytest.approx(0.2, abs=0.01)


def test_residuals_are_of_the_median() -> None:
    np.testing.assert_allclose(log_residuals(np.array([2.0]), np.array([[1.0, 1.0, 5.0]])), [np.log(2)])
