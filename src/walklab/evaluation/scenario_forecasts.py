"""The forecasts of a held-out scenario put together: what each may know of a walk is decided here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walklab.capture.walks import Walk
from walklab.evaluation.calibration import Calibration
from walklab.evaluation.forecasts import TIMES_ALONE, Asked, Forecast, Known, all_forecasts, effects_before, sharpened
from walklab.evaluation.grid_scores import captured_distances
from walklab.evaluation.route_forecasts import mean_progress, route_energy
from walklab.evaluation.tracing import drawn_energy, trace_walks
from walklab.geometry import curves
from walklab.geometry.standing import Standing
from walklab.planning.protocol import Planner
from walklab.randomness import generator
from walklab.steering.dependencies import planned_vectors
from walklab.steering.learned import ExtendedModel
from walklab.steering.models import ProbabilisticModel
from walklab.steering.routes import pack
from walklab.steering.sharpness import cell_volumes
from walklab.steering.suitability import Normalisation, normalise, score_walks

Array = NDArray[np.float64]

DRAWS = 8  # of P_Prob (extended) per walk; the energy score of so many is without bias, if not without noise


@dataclass(frozen=True)
class Learned:
    """What was made of the training walks, and how walks are followed.

    Attributes
    ----------
    model, calibration : as trained
    known : the training walks as the baselines see them
    planner, standing, time_limit_s, metric : as for the training walks
    """

    model: ProbabilisticModel
    calibration: Calibration
    known: Known
    planner: Planner
    standing: Standing
    time_limit_s: float
    metric: str

    @property
    def paced(self) -> ExtendedModel:
        """P_Prob (extended)."""
        return ExtendedModel(self.model, self.calibration.pace)

    @property
    def volumes(self) -> Array:
        """(C,) weights of the cells."""
        return cell_volumes(self.model.space)


def route_lengths(walks: Sequence[Walk], routes: Mapping[str, Array]) -> Array:
    """(W,) lengths of the planned routes, metres."""
    return np.array([curves.length(routes[str(walk.row["walk"])]) for walk in walks])


def durations(walks: Sequence[Walk]) -> Array:
    """(W,) captured travel times, seconds."""
    return np.array([float(walk.row["duration_s"]) for walk in walks])


def known_walks(
    walks: Sequence[Walk],
    routes: Mapping[str, Array],
    vectors: Array,
    scores: Array,
    residuals: pd.DataFrame,
    normalisation: Normalisation,
) -> Known:
    """The training walks as the baselines see them.

    Parameters
    ----------
    vectors, scores : (N, D) run-time dependencies and (N, C) maps, in the order of ``walks``
    residuals : DataFrame[walk, static_residual_s, adaptive_residual_s] of some of the walks
    """
    few = np.flatnonzero(np.isin([str(walk.row["walk"]) for walk in walks], residuals["walk"]))
    return Known(
        durations(walks),
        route_lengths(walks, routes),
        vectors,
        [str(walk.row["participant"]) for walk in walks],
        few,
        residuals["static_residual_s"].to_numpy(),
        residuals["adaptive_residual_s"].to_numpy(),
        normalise(scores, normalisation).mean(axis=0),
        mean_progress(walks),
    )


def asked_walks(
    walks: Sequence[Walk], routes: Mapping[str, Array], vectors: pd.DataFrame, trials: pd.DataFrame, learned: Learned
) -> Asked:
    """The walks of a scenario with what their forecasts need.

    Parameters
    ----------
    walks : in the order in which each person walked them
    vectors : DataFrame[walk, planned_<dependency>, captured_<dependency>]; the planned ones are read
    trials : DataFrame[walk, model, <parameter>, simulated_s] of ``P_Stat`` and ``P_Adapt`` at least
    """
    space, follow = learned.model.space, (learned.standing, learned.time_limit_s)
    names = [str(walk.row["walk"]) for walk in walks]
    asked = planned_vectors(vectors, learned.model.dependencies, names)
    traces, places = trace_walks(walks, routes, learned.planner, space, *follow)
    # The oracle alone reads the captured walks.
    batch = pack(walks, routes, learned.planner)
    own = score_walks(learned.planner, batch, space.cells, learned.metric, learned.time_limit_s)
    given = [trials[trials["model"] == name].set_index("walk").loc[names] for name in ("P_Stat", "P_Adapt")]
    static_s, adaptive_s = (rows["simulated_s"].to_numpy(dtype=float) for rows in given)
    static_m, adaptive_m = (
        drawn_energy(walks, routes, learned.planner, rows[list(space.names)].to_numpy(dtype=float)[:, None], learned.time_limit_s)
        for rows in given
    )
    distances_m, best = captured_distances(traces, places), (np.arange(len(walks)), own.argmin(axis=1))
    return Asked(
        durations(walks),
        route_lengths(walks, routes),
        asked,
        [str(walk.row["participant"]) for walk in walks],
        learned.model.blend(asked),
        learned.paced.density_model().blend(asked),
        static_s,
        adaptive_s,
        traces.travel_s[best].astype(float),
        static_m,
        adaptive_m,
        distances_m[best].astype(float),
        traces,
        distances_m,
    )


def forecast_scenario(
    walks: Sequence[Walk], routes: Mapping[str, Array], asked: Asked, learned: Learned, seed: int, replicate: int
) -> dict[str, Forecast]:
    """Every forecast of the walks; P_Prob (extended) with the energy score of what its public model draws, forecasts of times
    alone with that of the planned route.

    Parameters
    ----------
    asked : from :func:`asked_walks`
    seed, replicate : of the random numbers
    """
    calibration, paced = learned.calibration, learned.paced
    found = all_forecasts(learned.known, asked, calibration, learned.volumes)
    density = sharpened(asked.paced_suitability, calibration.pace.exponent, learned.volumes)
    for model, effect in effects_before(calibration.pace, asked, density).items():
        rngs = [generator(seed, replicate, "score_forecasts", model, str(walk.row["walk"])) for walk in walks]
        drawn = paced.sample_batch(asked.vectors, DRAWS, rngs, effect)
        energy_m = drawn_energy(walks, routes, learned.planner, drawn, learned.time_limit_s)
        found[model] = replace(found[model], energy_m=energy_m)
    for model in TIMES_ALONE:
        energy_m = route_energy(walks, routes, found[model].members_s, learned.known.progress)
        found[model] = replace(found[model], energy_m=energy_m)
    return found
