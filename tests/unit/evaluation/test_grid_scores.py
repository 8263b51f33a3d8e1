"""Scores on the grid against closed forms, brute force and exactly known forecasts."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from walklab.evaluation.forecasts import Forecast
from walklab.evaluation.grid_scores import captured_distances, grid_crps, grid_energy, grid_quantiles
from walklab.evaluation.score_tables import calibration_table, score_table, walk_scores
from walklab.planning.tracing import Traces


def test_crps_of_a_fine_grid_is_that_of_the_normal() -> None:
    """Gneiting & Raftery 2007, eq. 21: sigma (z (2 Phi(z) - 1) + 2 phi(z) - 1 / sqrt(pi))."""
    times_s = np.linspace(-6, 10, 4001)
    density = stats.norm.pdf(times_s, 2.0, 0.5)
    density /= density.sum()
    for observed in (0.5, 2.0, 2.7):
        z = (observed - 2.0) / 0.5
        exact = 0.5 * (z * (2 * stats.norm.cdf(z) - 1) + 2 * stats.norm.pdf(z) - 1 / np.sqrt(np.pi))
        assert grid_crps(times_s[None], density[None], [observed])[0] == pytest.approx(exact, rel=1e-4)


def test_crps_and_quantiles_of_a_few_cells_by_definition() -> None:
    rng = np.random.default_rng(0)
    times_s, density = rng.uniform(1, 5, (20, 7)), rng.dirichlet(np.ones(7), 20)
    observed = rng.uniform(0, 6, 20)
    first = (density * np.abs(times_s - observed[:, None])).sum(axis=1)
    spread = np.einsum("wi,wj,wij->w", density, density, np.abs(times_s[:, :, None] - times_s[:, None]))
    np.testing.assert_allclose(grid_crps(times_s, density, observed), first - spread / 2, rtol=1e-9)
    quantiles, cells = grid_quantiles(times_s, density, [0.3])
    for row in range(20):
        assert (density[row] * (times_s[row] < quantiles[row, 0])).sum() < 0.3
        assert (density[row] * (times_s[row] <= quantiles[row, 0])).sum() >= 0.3
        assert times_s[row, cells[row, 0]] == quantiles[row, 0]


def test_energy_score_of_a_standing_crowd_is_the_closed_form_of_its_line() -> None:
    """Walkers that stand at x ~ N(0, 1) for all times: the energy score is the CRPS of x."""
    x = stats.norm.ppf((np.arange(1000) + 0.5) / 1000)
    places = np.zeros((1, 1000, 3, 2), np.float32)
    places[0, :, :, 0] = x[:, None]
    traces = Traces(x[None].astype(np.float32), np.ones((1, 1000), bool), places)
    captured = np.zeros((1, 3, 2))
    captured[..., 0] = 0.7
    density = np.full((1, 1000), 1e-3)
    found = grid_energy(captured_distances(traces, captured), density, places, traces.travel_s)[0]
    exact = 0.7 * (2 * stats.norm.cdf(0.7) - 1) + 2 * stats.norm.pdf(0.7) - 1 / np.sqrt(np.pi)
    assert found == pytest.approx(exact, abs=0.004)


def crowd(walks: int, cells: int, seed: int) -> tuple[np.ndarray, Traces, np.ndarray]:
    """Suitability that falls from a best cell; walkers of different speeds and sides, so that one time is of many paths."""
    rng = np.random.default_rng(seed)
    speeds, sides = rng.uniform(0.5, 2.0, (walks, cells)), rng.normal(0, 1.0, (walks, cells))
    at = np.linspace(0.5, 2.0, 4)
    places = np.stack([speeds[..., None] * at, sides[..., None] * np.sin(at)], axis=-1).astype(np.float32)
    travel_s = np.round(4 / speeds, 1).astype(np.float32)
    suitability = np.maximum(1 - np.hypot(speeds - 1.2, sides - 0.2) / 4, 1e-3)
    return suitability, Traces(travel_s, np.ones((walks, cells), bool), places), np.zeros((walks, 4, 2))


def test_energy_score_is_that_of_all_pairs_of_cells() -> None:
    suitability, traces, captured = crowd(6, 500, 1)
    distances = captured_distances(traces, captured)
    every = np.sqrt(((traces.places_m[:, :, None] - traces.places_m[:, None]) ** 2).sum(axis=4).mean(axis=3))
    for exponent in (1, 10, 80):
        density = suitability**exponent / (suitability**exponent).sum(axis=1, keepdims=True)
        spread = np.einsum("wi,wj,wij->w", density, density, every)
        exact = (distances * density).sum(axis=1) - spread / 2
        found = grid_energy(distances, density, traces.places_m, traces.travel_s)
        # Of each walk, and of their mean, which is what a sharpness is chosen by.
        np.testing.assert_allclose(2 * ((distances * density).sum(axis=1) - found), spread, rtol=0.04)
        assert found.mean() == pytest.approx(exact.mean(), rel=0.01)


def test_energy_score_is_smooth_in_the_exponent() -> None:
    suitability, traces, captured = crowd(20, 800, 2)
    distances, means = captured_distances(traces, captured), []
    for exponent in np.geomspace(8, 12, 21):
        density = suitability**exponent / (suitability**exponent).sum(axis=1, keepdims=True)
        means.append(grid_energy(distances, density, traces.places_m, traces.travel_s).mean())
    rough = np.abs(np.diff(means, 2)).max()
    assert rough < 0.003 * np.mean(means)


def test_an_exactly_known_model_is_covered_as_often_as_it_says() -> None:
    """Times drawn from the forecast itself: every interval holds its share, the PIT is level, the bias is none."""
    rng = np.random.default_rng(3)
    count, people = 4000, 40
    mean = rng.uniform(2, 4, count)
    members = mean[:, None] + 0.3 * stats.norm.ppf((np.arange(200) + 0.5) / 200)
    captured = mean + 0.3 * rng.normal(size=count)
    walks = pd.DataFrame({"walk": np.arange(count), "participant": np.arange(count) % people, "inside_hull": True})
    far_m = np.full(len(members), 0.5)
    forecasts = {
        "known": Forecast(members, 0.6 * far_m),
        "regression": Forecast(members + 0.2),
        "quadratic log regression": Forecast(members + 0.2, far_m),
    }
    rows = walk_scores(captured, forecasts, walks).assign(scenario="s")
    table = score_table(rows, rng, 500).query("hull == 'all'").set_index("model")
    for level in (50, 80, 90, 95):
        held = round(table.loc["known", f"coverage_{level}"] * count)
        assert 1e-3 < stats.binom.cdf(held, count, level / 100) < 1 - 1e-3
    # The CRPS of a normal forecast of itself is sigma / sqrt(pi) on average.
    assert table.loc["known", "crps_s"] == pytest.approx(0.3 / np.sqrt(np.pi), rel=0.05)
    assert table.loc["known", "bias_s_low"] < 0 < table.loc["known", "bias_s_high"]
    assert table.loc["regression", "bias_s_low"] > 0.15
    assert table.loc["known", "crps_minus_regression_s_high"] < 0
    assert table.loc["known", "energy_minus_regression_m"] == pytest.approx(-0.2)
    assert table.loc["known", "pit_distance"] < 0.03 < table.loc["regression", "pit_distance"]
    shares = calibration_table(rows).query("model == 'known'")
    pit = shares.loc[shares["quantity"] == "pit", "value"]
    assert stats.chisquare(pit * count).pvalue > 1e-3
    coverage = shares[shares["quantity"] == "coverage"]
    np.testing.assert_allclose(coverage["value"], coverage["at"], atol=0.03)


def test_both_tables_state_the_same_coverage() -> None:
    """Few members, some of which tie, and times on and between them: where definitions of an interval part."""
    rng = np.random.default_rng(4)
    members = rng.integers(0, 8, (300, 7)) / 2
    captured = rng.integers(0, 16, 300) / 4
    walks = pd.DataFrame({"walk": np.arange(300), "participant": np.arange(300) % 5, "inside_hull": True})
    rows = walk_scores(captured, {"regression": Forecast(members), "quadratic log regression": Forecast(members)}, walks).assign(
        scenario="s"
    )
    scores = score_table(rows, rng, 20).query("hull == 'all'").iloc[0]
    curve = calibration_table(rows).query("quantity == 'coverage' and model == 'regression'").set_index("at")["value"]
    for level in (50, 80, 90, 95):
        assert curve[level / 100] == pytest.approx(scores[f"coverage_{level}"], abs=1e-9)
        low, high = (np.quantile(members, at, axis=1, method="hazen") for at in (0.5 - level / 200, 0.5 + level / 200))
        assert curve[level / 100] == ((low <= captured) & (captured <= high)).mean()
