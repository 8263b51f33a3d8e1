"""Trajectories of forecasts that give none: along the route, in the forecast time, as others progressed."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from walklab.capture.walks import Walk
from walklab.evaluation.route_forecasts import SHARES, mean_progress, route_energy
from walklab.evaluation.tracing import captured_places, score_times
from walklab.geometry import curves

ROUTE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])


def walk(duration_s: float, route: np.ndarray = ROUTE, power: float = 1.0, name: str = "w") -> Walk:
    """Along a route, the share ``(t / T)^power`` of it after t."""
    time_s = np.linspace(0.0, duration_s, 601)
    travelled = curves.arc_length(route)
    at = (time_s / duration_s) ** power * travelled[-1]
    places = np.column_stack([np.interp(at, travelled, route[:, axis]) for axis in (0, 1)])
    return Walk(pd.Series({"walk": name, "duration_s": duration_s}), time_s + 7.0, places)


def test_progress_is_the_mean_over_walks_whatever_their_length_and_time():
    np.testing.assert_allclose(mean_progress([walk(3.0)]), SHARES, atol=1e-6)
    found = mean_progress([walk(3.0), walk(9.0, 5 * ROUTE, power=2.0)])
    np.testing.assert_allclose(found, (SHARES + SHARES**2) / 2, atol=1e-3)
    assert (found[0], found[-1]) == (0.0, pytest.approx(1.0))


def test_who_walks_as_forecast_is_forecast_without_error():
    walks = [walk(2.5, power=2.0)]
    certain = np.full((1, 200), 2.5)
    assert route_energy(walks, {"w": ROUTE}, certain, SHARES**2)[0] < 2e-3
    assert route_energy(walks, {"w": ROUTE}, certain, SHARES)[0] > 0.1
    assert route_energy(walks, {"w": ROUTE}, 2 * certain, SHARES**2)[0] > 0.1


def test_the_score_is_that_of_independent_draws():
    """Beside a plain Monte Carlo estimate from the whole distribution, in which every draw is placed by itself."""
    rng = np.random.default_rng(3)
    walks, members = [walk(3.1, name="a"), walk(2.2, 0.7 * ROUTE, name="b")], np.sort(rng.gamma(20.0, 0.15, (2, 200)))
    routes = {"a": ROUTE, "b": ROUTE[:, ::-1] + 0.1}
    found = route_energy(walks, routes, members[:, rng.permutation(200)], SHARES)
    times = score_times(np.array([curves.length(routes[name]) for name in "ab"]))
    for row, name in enumerate("ab"):
        travelled = curves.arc_length(routes[name])

        def placed(duration_s: float, row=row, route=routes[name], travelled=travelled) -> np.ndarray:
            at = np.minimum(times[row] / duration_s, 1.0) * travelled[-1]
            return np.column_stack([np.interp(at, travelled, route[:, axis]) for axis in (0, 1)])

        def apart(first: np.ndarray, second: np.ndarray) -> float:
            return np.sqrt(((first - second) ** 2).sum(axis=1).mean())

        drawn = [placed(each) for each in rng.choice(members[row], 4000)]
        near = np.mean([apart(each, captured_places(walks, times)[row]) for each in drawn])
        gaps = np.mean([apart(drawn[k], drawn[k + 2000]) for k in range(2000)])
        assert found[row] == pytest.approx(near - gaps / 2, abs=0.01)


def test_an_honest_spread_is_scored_better_than_none_or_too_much():
    """The energy score is proper: of walkers whose times vary by a tenth, the least is that of a tenth."""
    rng = np.random.default_rng(5)
    times = 3.0 * np.exp(0.1 * rng.standard_normal(400))
    walks = [walk(each, name=str(row)) for row, each in enumerate(times)]
    quantiles = np.quantile(rng.standard_normal(20_000), (np.arange(200) + 0.5) / 200)
    routes = {str(row): ROUTE for row in range(400)}
    scores = [
        route_energy(walks, routes, np.tile(3.0 * np.exp(sd * quantiles), (400, 1)), SHARES).mean() for sd in (0.001, 0.1, 0.3)
    ]
    assert scores[1] < scores[0]
    assert scores[1] < scores[2]
