"""Learned sharpness: what made the walks is found, and nobody reads what has to be forecast."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import scoringrules as sr
from scipy import stats
from scipy.special import ndtri

from walklab.errors import InputError
from walklab.evaluation.calibration import (
    Evidence,
    best_value,
    blend_others,
    candidate_table,
    choose_walks,
    learn_calibration,
)
from walklab.evaluation.calibration_files import read_calibration, write_calibration
from walklab.evaluation.extended import extended_table, log_times, personal_columns
from walklab.evaluation.forecasts import INFORMED, Asked, Known, all_forecasts
from walklab.evaluation.subject_scores import OWN_MAP
from walklab.planning.tracing import Traces
from walklab.steering.blending_space import homogenise
from walklab.steering.pace import NODES, PaceEffect, fit_pace, fit_trend, paced, rest_of
from walklab.steering.sharpness import LADDER, Sharpness, cell_volumes
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
    heights = np.array([1.6 + 0.05 * PEOPLE.index(owner) for owner in owners])
    vectors = np.column_stack([travel_s[:, 0] * speeds[0], heights])
    maps = (suitability, 1 - suitability, suitability, suitability)
    return Evidence(owners, captured, vectors, ("length", "height"), *maps, traces, distances, volumes)


def extensions(given: Evidence, exponents: tuple[float, ...]) -> pd.DataFrame:
    """Scores of the extended model on this evidence."""
    walks = (given.traces.travel_s, given.captured_s, given.participants, given.vectors, given.names)
    return extended_table(*walks, {(): given.suitability}, given.volumes, exponents)[0]


@pytest.mark.parametrize("exponent", [4.0, 20.0])
def test_the_exponent_that_made_the_walks_is_found(exponent: float) -> None:
    candidates = {"exponent": LADDER, "threshold": (0.5, 0.9), "temperature": (0.05, 0.2)}
    table, law = candidate_table(evidence(exponent), candidates)
    best = best_value(table)
    assert exponent / 1.7 < best < exponent * 1.7
    row = table[(table["model"] == "P_Prob") & (table["value"] == best)].iloc[0]
    assert 0.85 < row["coverage_90"] < 0.95
    assert {"exponent", "threshold", "temperature", "covering law"} < set(table["kind"])
    # What must cover a new person is never sharper than what the scores alone would take.
    assert law.exponents(np.full((1, 2), law.centre))[0] <= best * 1.3


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
    wider = paced(np.full((1, 50), 3.0), np.array([0.1]), np.array([0.06]), 0.08, levels, 3.0)
    assert np.log(wider).std() > 1.2 * np.log(members).std()


def test_paced_members_are_the_quantiles_of_the_mixture_to_the_last_digit() -> None:
    rng, levels = np.random.default_rng(4), (np.arange(200) + 0.5) / 200
    members = rng.gamma(3, 1, (20, 50))
    mean, sd = rng.normal(0, 0.1, 20), rng.uniform(0.02, 0.1, 20)
    nodes = ndtri((np.arange(NODES) + 0.5) / NODES)
    effects = np.exp(mean[:, None] + np.hypot(sd, 0.05)[:, None] * nodes)
    mixed = (effects[:, :, None] * members[:, None, :]).reshape(20, -1)
    np.testing.assert_allclose(paced(members, mean, sd, 0.05, levels), np.quantile(mixed, levels, axis=1).T, rtol=1e-14)


def test_few_people_leave_their_spread_uncertain_by_the_textbook() -> None:
    """The t interval of a new person from n others' exact means: mean -+ t(n - 1) s sqrt(1 + 1/n)."""
    effect = fit_pace([0.1, 0.2, 0.6], ["a", "b", "c"])
    assert effect.new_person_sd == pytest.approx(np.std([0.1, 0.2, 0.6], ddof=1) * np.sqrt(4 / 3))
    assert effect.freedom(effect.new_person_sd, 0.0) == pytest.approx(2)
    # Whose pace is known well has, beside it, only the walks' own spread.
    assert effect.freedom(0.01, 0.5) > 1e4
    # However small the spread: degrees of freedom are a matter of shares.
    assert effect.freedom(1e-7, 0.0) == pytest.approx(2)
    assert np.isinf(PaceEffect(0, 0.1, 0.1).freedom(0.1, 0.0))


def test_trend_is_recovered_and_held_beyond_training() -> None:
    rng = np.random.default_rng(1)
    vectors = np.column_stack([rng.uniform(1, 4, 500), rng.uniform(0, 1, 500)])
    residuals = 0.1 + 0.2 * np.log(vectors[:, 0]) ** 2 - 0.05 * vectors[:, 1]
    owners = [f"p{i % 7}" for i in range(500)]
    trend = fit_trend(residuals, vectors, owners, (0, 1), (True, False), 2)
    np.testing.assert_allclose(trend(vectors), residuals, atol=1e-9)
    edge = [[vectors[:, 0].max(), 0.5]]
    np.testing.assert_allclose(trend([[9.0, 0.5]]), trend(edge))
    assert fit_trend(residuals, vectors, owners, (0, 1), (True, False), 0)(vectors) == pytest.approx(np.mean(residuals), abs=0.02)


def test_rest_is_what_the_walks_own_variances_leave() -> None:
    rng = np.random.default_rng(2)
    owners = [f"p{i % 20}" for i in range(8000)]
    own = rng.uniform(0.01, 0.08, 8000)
    people = rng.normal(0, 0.3, 20)[[int(name[1:]) for name in owners]]
    residuals = people + rng.normal(0, np.sqrt(own**2 + 0.05**2))
    assert rest_of(residuals, owners, own**2) == pytest.approx(0.05, rel=0.05)
    assert rest_of(people + rng.normal(0, own / 2), owners, own**2) == 0


def test_extended_model_learns_the_pace_of_people() -> None:
    tables = [extensions(evidence(40.0, pace_sd=sd), (10.0, 40.0, 160.0)).query("degree == 0") for sd in (0.15, 0.0)]
    with_pace, without = (table.set_index("value") for table in tables)
    assert with_pace.loc[40.0, "crps_earlier_s"] < 0.75 * with_pace.loc[40.0, "crps_s"]
    assert without.loc[40.0, "crps_earlier_s"] == pytest.approx(without.loc[40.0, "crps_s"], rel=0.03)
    for table in (with_pace, without):
        assert 0.86 < table.loc[40.0, "coverage_earlier_90"] < 0.94
    assert with_pace["crps_earlier_s"].idxmin() == 40.0


def given_pace(effect: PaceEffect, rest: float, variance: np.ndarray) -> tuple[np.ndarray, float]:
    """Spread of somebody new in the logarithm of the time, and its degrees of freedom."""
    own = np.sqrt(variance + rest**2)
    return np.hypot(effect.new_person_sd, own), effect.freedom(effect.new_person_sd, float(own.mean()))


@pytest.mark.parametrize("degree", [0, 1, 2])
def test_extended_scores_of_a_participant_are_by_a_pace_of_the_others(degree: int) -> None:
    """Brute force, one person after the other, from walks in which that person does not occur: trend, pace and rest."""
    given = evidence(40.0, 160, 0.1)
    owners = np.array(given.participants)
    row = extensions(given, (40.0,)).set_index("degree").loc[degree]
    moments = log_times(given.traces.travel_s, Sharpness("exponent", 40.0).density(given.suitability, given.volumes))
    left = np.log(given.captured_s) - moments.mean
    crps, held = [], []
    for name in PEOPLE:
        own, others = owners == name, owners != name
        known = owners[others].tolist()
        # The length alone has a trend: the height never changes within a person.
        trend = fit_trend(left[others], given.vectors[others], known, [0], [True], degree)
        about = left[others] - trend(given.vectors[others])
        effect, rest = fit_pace(about, known), rest_of(about, known, moments.variance[others])
        spread, freedom = given_pace(effect, rest, moments.variance[own])
        mean = moments.mean[own] + trend(given.vectors[own]) + effect.mean
        crps.append(sr.crps_lognormal(given.captured_s[own], mean, spread).mean())
        reach = stats.t.ppf(0.95, freedom) * spread
        held.append((np.abs(np.log(given.captured_s[own]) - mean) <= reach).mean())
    assert row["crps_s"] == pytest.approx(np.mean(crps), rel=1e-6)
    assert row["coverage_90"] == pytest.approx(np.mean(held))


def test_personal_dependencies_are_those_that_never_change_within_a_person() -> None:
    given = evidence(10.0, 80)
    assert personal_columns(given.vectors, given.participants) == (1,)
    assert personal_columns(given.vectors[:, :1], given.participants) == ()


def test_calibration_survives_its_file(tmp_path) -> None:
    calibration = learn_calibration(evidence(20.0, 80, 0.1))[0]
    write_calibration(calibration, tmp_path / "calibration.json")
    assert read_calibration(tmp_path / "calibration.json") == calibration
    (tmp_path / "other.json").write_text("{}")
    with pytest.raises(InputError, match="not a calibration"):
        read_calibration(tmp_path / "other.json")


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
        np.linspace(0, 1, 41),
    )
    wanted = rng.uniform(1, 4, (40, 2))
    times = asked.captured_s + rng.normal(0, 0.2, (3, 40))
    target = Asked(
        asked.captured_s,
        wanted[:, 0],
        wanted,
        asked.participants,
        asked.suitability,
        asked.suitability,
        *times,
        *np.abs(times),
        asked.traces,
        asked.distances_m,
    )
    return known, target, learned.volumes


def test_no_forecast_of_a_scenario_reads_the_captured_times() -> None:
    """The last walk's time changes: no forecast of any walk does, but the oracle's through its own input."""
    known, asked, volumes = study()
    calibration = learn_calibration(evidence(20.0, 80))[0]
    before = all_forecasts(known, asked, calibration, volumes)
    captured = asked.captured_s.copy()
    captured[-1] *= 3
    after = all_forecasts(known, replace(asked, captured_s=captured), calibration, volumes)
    assert len(before) == 17
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
