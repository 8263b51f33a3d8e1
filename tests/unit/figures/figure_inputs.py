"""Small made-up inputs of every figure, and every figure drawn from them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from walklab.figures import (
    blending,
    capture,
    claims,
    evaluation,
    forecasts,
    maps,
    multiverse,
    real,
    realism,
    recovery,
    replicates,
)
from walklab.geometry.plans import Plan, Station
from walklab.geometry.scene import Scene, disc
from walklab.multiverse.choices import Choices
from walklab.multiverse.specifications import specifications
from walklab.multiverse.table import specification_table
from walklab.randomness import generator
from walklab.steering.space import Axis, ParameterSpace

NAMES, UNITS = ("length", "curvature", "height"), ("m", "1/m", "m")
PERCENTILES = ("p05", "p25", "median", "p75", "p95")
PUBLISHED_ERRORS = {"P_Stat": {"p05": 0.05, "p25": 0.26, "median": 0.51, "p75": 0.84, "p95": 1.46}, "P_Prob": {"median": 0.45}}
PUBLISHED_ABLATIONS = {"full": 0.45, "without_length": 0.51, "without_v": 0.55}
PUBLISHED_ERROR_OF_K, PUBLISHED_MS = {10: 1.4, 100: 0.45}, {100: 38.0}

Draw = Callable[[], Figure]


def space() -> ParameterSpace:
    values = tuple(0.1 + 0.4 * i for i in range(4))
    return ParameterSpace((Axis("v", "m/s", values), Axis("a", "m/s2", values), Axis("omega", "1/m", values)))


def suitability(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random(space().shape)


def vectors(count: int = 30) -> np.ndarray:
    return np.random.default_rng(1).uniform([0.5, 0.0, 1.6], [4.0, 1.2, 1.9], (count, 3))


def clouds() -> pd.DataFrame:
    return pd.DataFrame(vectors(), columns=NAMES)


def classes() -> pd.DataFrame:
    rows = {"low_m": [0.0, 2.0, 4.0], "high_m": [2.0, 4.0, np.inf], "published_cumulative_share": [0.75, 0.95, np.nan]}
    shares = {"share": [0.6, 0.3, 0.1], "cumulative_share": [0.6, 0.9, 1.0]}
    return pd.concat([pd.DataFrame({"dataset": name, **rows, **shares}) for name in ("scenario_1", "scenario_2")])


def plan(name: str) -> Plan:
    stations = {"start": Station((-1.0, 0.5)), "end": Station((0.5, -1.0), -90.0)}
    return Plan(Scene(name, {"pole": disc((0.0, 0.0), 0.15)}), stations, (("start", "end"),))


def walks() -> pd.DataFrame:
    rows = [("a", "turn_90", "turn_90_3.0", -1.0, 0.5, 0.5, -1.0), ("b", "open", "straight_2.0", 0.0, 0.0, 2.0, 0.0)]
    return pd.DataFrame(rows, columns=["walk", "scene", "configuration", "start_x_m", "start_y_m", "end_x_m", "end_y_m"])


def samples() -> pd.DataFrame:
    turn = {"walk": "a", "x_m": [-1.0, 0.4, 0.5], "y_m": [0.5, 0.4, -1.0]}
    return pd.concat([pd.DataFrame(turn), pd.DataFrame({"walk": "b", "x_m": [0.0, 1.0, 2.0], "y_m": [0.0, 0.02, 0.0]})])


def simulated() -> pd.DataFrame:
    path = {"time_s": [0.0, 0.6, 1.2], "x_m": [-1.0, 0.4, 0.5], "y_m": [0.5, 0.4, -1.0]}
    return pd.concat([pd.DataFrame({"model": model, **path}) for model in ("Ref", "P_Stat", "P_Adapt", "P_Prob")])


def trials() -> pd.DataFrame:
    rng = np.random.default_rng(2)
    frames = [pd.DataFrame({"model": name, "abs_dt_s": rng.gamma(2, 0.3, 40)}) for name in ("P_Stat", "P_Adapt", "P_Prob")]
    return pd.concat(frames, ignore_index=True).assign(arrival="arrived")


def description() -> pd.DataFrame:
    fixed = {"n": 40, "mean": 0.6, "iqr": 0.5, "skew": 1.1, "shapiro_w": 0.9, "shapiro_p": 1e-9}
    levels = dict(zip(PERCENTILES, (0.05, 0.25, 0.5, 0.75, 1.4), strict=True))
    return pd.DataFrame([{"model": name, **fixed, **levels} for name in ("P_Stat", "P_Adapt", "P_Prob")])


def pairs() -> pd.DataFrame:
    row = {
        "n": 40,
        "zeros": 1,
        "w": 300.0,
        "p": 0.02,
        "rank_biserial": 0.2,
        "cles": 0.55,
        "median_difference_s": 0.03,
        "power": 0.9,
    }
    return pd.DataFrame([{"first": "P_Stat", "second": "P_Adapt", **row}])


def ablations() -> pd.DataFrame:
    rows = [("full", 0.5, 0.45, 0.55, np.nan), ("without_length", 0.52, 0.5, 0.6, np.nan), ("without_v", 0.7, 0.6, 0.8, 0.94)]
    return pd.DataFrame(rows, columns=["variant", "value", "low", "high", "held_at"])


def sweep() -> pd.DataFrame:
    rows = [(k, name, value) for k in (10, 100) for name, value in zip(PERCENTILES, (0.05, 0.25, 0.5, 0.8, 1.4), strict=True)]
    return pd.DataFrame(rows, columns=["k", "statistic", "value"])


def timings() -> pd.DataFrame:
    return pd.DataFrame({"k": [10, 100], "interpolation_ms": [0.01, 0.05]})


def long_times() -> pd.DataFrame:
    frames = [
        pd.DataFrame({"distance_m": 10.0, "model": "Ref", "travel_time_s": [6.0, 6.2, 6.5]}),
        pd.DataFrame({"distance_m": 10.0, "model": "P_Prob", "travel_time_s": [5.9, 6.1, 6.4]}),
        pd.DataFrame({"distance_m": 10.0, "model": "P_Stat", "travel_time_s": [6.3, 6.3, 6.3]}),
    ]
    return pd.concat(frames)


def long_published() -> pd.DataFrame:
    rows = [(10, "Ref", 6.31, 0.54), (10, "P_Stat", 6.4, np.nan)]
    return pd.DataFrame(rows, columns=["distance_m", "model", "median_s", "iqr_s"])


def claim_rows() -> pd.DataFrame:
    rows = [
        ("a", "7.4", "a median", "0.5", 0.6, 0.4, 0.7, "reproduced"),
        ("b", "8.2", "a time", "38.4", 0.05, 0.04, 0.06, "not reproduced"),
        ("c", "8.1", "a statement", "", np.nan, np.nan, np.nan, "partly"),
    ]
    return pd.DataFrame(rows, columns=["id", "section", "statement", "published", "ours", "ours_low", "ours_high", "verdict"])


def scores() -> pd.DataFrame:
    rows = [(p, m, 3, 0.2 + 0.01 * p, 0.3, 0.8) for p in range(3) for m in ("P_Stat", "P_Prob", "climatology")]
    return pd.DataFrame(rows, columns=["participant", "model", "walks", "crps_s", "median_abs_dt_s", "coverage_90"])


def summary() -> pd.DataFrame:
    table = scores().groupby("model", sort=False)[["crps_s", "median_abs_dt_s", "coverage_90"]].mean().reset_index()
    for measure in ("crps_s", "median_abs_dt_s", "coverage_90"):
        table[f"{measure}_low"], table[f"{measure}_high"] = table[measure] * 0.9, table[measure] * 1.1
    return table


LONGEST_NAME = "quadratic log regression, earlier walks"  # of all forecasts of a run


def forecast_scores() -> pd.DataFrame:
    rows = [
        (scenario, hull, model, info, 0.2, 0.1, 0.3, 0.85, 0.7, 1.0)
        for scenario in ("scenario_1", "scenario_2")
        for hull in ("all", "inside")
        for model, info in (
            ("P_Stat with residual spread", "task"),
            ("P_Prob (calibrated)", "task"),
            ("regression, earlier walks", "task and earlier walks"),
            (LONGEST_NAME, "task and earlier walks"),
        )
    ]
    names = ["crps_s", "crps_s_low", "crps_s_high", "coverage_90", "coverage_90_low", "coverage_90_high"]
    held = {f"coverage_{level}_{end}": value for level in (50, 80, 95) for end, value in (("low", 0.4), ("high", 0.9))}
    return pd.DataFrame(rows, columns=["scenario", "hull", "model", "information", *names]).assign(bias_s=-0.1, **held)


def calibration() -> pd.DataFrame:
    models = ("P_Prob (literal)", "P_Prob (calibrated)", "regression")
    rows = [("scenario_1", m, "coverage", at, at * 0.9) for m in models for at in (0.2, 0.5, 0.9)]
    rows += [("scenario_1", m, "pit", at, 0.25) for m in models for at in (0.125, 0.375, 0.625, 0.875)]
    rows += [(s, "P_Prob", "crps_by_exponent", at, 1 / at) for s in ("training", "scenario_1") for at in (1.0, 10.0, 80.0)]
    rows += [("training", "P_Prob", "coverage_by_exponent", at, 1 - at / 160) for at in (1.0, 10.0, 80.0)]
    rows += [("training", "P_Prob", f"{name}_of_law", 10.0, value) for name, value in (("crps", 0.2), ("coverage", 0.94))]
    rows += [("training", "P_Prob", "required_coverage", 0.9, 0.93)]
    rows += [("training", "P_Prob", "exponent_by_curvature", at, 8 + 4 * at) for at in (0.0, 0.5, 1.0)]
    return pd.DataFrame(rows, columns=["scenario", "model", "quantity", "at", "value"])


def counted_claims() -> pd.DataFrame:
    rows = [
        ("7.4", "a median", 20, 3, 0.05, 0.36, 15, 0.53, 0.89),
        ("8.1", "a statement", 20, 20, 0.84, 1.0, np.nan, np.nan, np.nan),
        ("8.1", "an ablation", 0, *[np.nan] * 6),
    ]
    names = [f"{name}{end}" for name in ("reproduced", "direction_held") for end in ("", "_low", "_high")]
    return pd.DataFrame(rows, columns=["section", "statement", "replicates", *names])


def pooled_scores() -> pd.DataFrame:
    models = (
        "P_Stat with residual spread",
        "P_Prob (calibrated)",
        "P_Prob (extended)",
        "regression, earlier walks",
        LONGEST_NAME,
    )
    keys = ["scenario", "hull", "measure", "model", "information", "against"]
    rows = [
        (scenario, "all", measure, model, "task" if "earlier" not in model else "task and earlier walks", "")
        for scenario in ("scenario_1", "scenario_2")
        for measure in ("crps_s", "coverage_90")
        for model in models
    ]
    rows += [
        (scenario, "all", "crps_difference_s", model, "task", other)
        for scenario in ("scenario_1", "scenario_2")
        for model in models[1:3]
        for other in models
        if other != model
    ]
    return pd.DataFrame(rows, columns=keys).assign(value=0.5, low=0.4, high=0.6)


def recovered() -> pd.DataFrame:
    rows = [
        (walks, resolution, 0, task, model, measure, parameter, 0.3)
        for walks, resolution in ((100, 5), (300, 5), (100, 9))
        for task in ("straight_2.0", "turn_90_3.0")
        for model in ("P_Prob (literal)", "P_Prob (one exponent by the scores)", "P_Prob, sharpened before blending")
        for measure, parameter in (("ks", "v"), ("ks", "a"), ("ks", "omega"), ("energy", "all"))
    ]
    names = ["walks", "resolution", "repetition", "task", "model", "measure", "parameter", "value"]
    return pd.DataFrame(rows, columns=names)


def recovered_densities() -> pd.DataFrame:
    rows = [
        (task, model, parameter, at, at)
        for task in ("straight_2.0", "turn_90_3.0")
        for model in ("known", "P_Prob (literal)", "P_Prob, sharpened before blending")
        for parameter in ("v", "a", "omega")
        for at in (0.2, 1.0, 1.8)
    ]
    return pd.DataFrame(rows, columns=["task", "model", "parameter", "at", "density"])


def listed() -> pd.DataFrame:
    """Seven specifications, the last of which failed."""
    table = specification_table(specifications(Choices(), 2, generator(1), vary=["weights", "start"]))
    return table.assign(outcome=["ran"] * (len(table) - 1) + ["failed"])


def effects() -> pd.DataFrame:
    """Every effect of the specification curve, in both scenarios."""
    names = listed()["specification"][:-1]
    rows = [
        (name, claim.format(scenario), 0.3 * np.sin(index + shift), index % 2 == 0)
        for shift, claim in enumerate(multiverse.EFFECTS)
        for scenario in ("scenario_1", "scenario_2")
        for index, name in enumerate(names)
    ]
    frame = pd.DataFrame(rows, columns=["specification", "claim", "ours", "held"])
    return frame.assign(ours_low=frame["ours"] - 0.1, ours_high=frame["ours"] + 0.1)


def run_time() -> dict[str, Any]:
    fine = np.linspace(0.1, 1.3, 9)
    draws = np.random.default_rng(3).uniform(0.1, 1.3, (12, 3))
    return {
        "vectors": vectors(), "names": NAMES, "units": UNITS, "query": vectors()[0], "neighbours": np.arange(5),
        "weights": np.linspace(1, 0, 5), "blended": suitability(), "space": space(), "fine_values": (fine, fine),
        "fine": np.outer(fine, fine), "accepted": draws[:6], "rejected": draws[6:], "held_at": {"omega": 0.9},
    }  # fmt: skip


def realism_values() -> pd.DataFrame:
    rng = np.random.default_rng(5)
    groups = {"synthetic": 40, "recorded": 9, realism.SPIKED: 5}
    measured = [*realism.BY_DISTANCE, *(name for _, names in realism.BY_PERSON.values() for name in names)]
    rows = [(name, group, "made up") for name in measured for group, count in groups.items() for _ in range(count)]
    numbers = {"distance_m": rng.uniform(0.4, 4.2, len(rows)), "value": rng.uniform(0.1, 2.0, len(rows))}
    measures = pd.DataFrame(rows, columns=["quantity", "group", "source"]).assign(at=np.nan, **numbers)
    ramps = [
        (name, group, "made up", at, 4.0, 0.1 + 0.8 * at + shift)
        for name in realism.PROFILES
        for group, shift in (("synthetic", 0.0), ("synthetic", 0.05), ("recorded", 0.1))
        for at in (0.0, 0.5, 1.0)
    ]
    return pd.concat([measures, pd.DataFrame(ramps, columns=[*list(measures.columns[:3]), "at", "distance_m", "value"])])


FIGURES: dict[str, Draw] = {
    "fig03": lambda: capture.fig03(classes(), 3197),
    "fig04": lambda: capture.fig04(walks(), samples(), {"turn_90": plan("turn_90")}),
    "fig05": lambda: maps.fig05(suitability(), space()),
    "fig06": lambda: blending.fig06(vectors(), np.arange(30) > 10, NAMES, UNITS, {0: suitability(), 7: suitability(1)}, space()),
    "dependency_clouds": lambda: blending.dependency_clouds(
        clouds(), clouds(), {"scenario_1": clouds()}, dict(zip(NAMES, UNITS, strict=True))
    ),
    "fig08": lambda: maps.fig08([suitability(i) for i in range(3)], [0.5, 1.0, 3.0], space(), 0.0, 1.8),
    "fig09": lambda: blending.fig09(**run_time()),
    "fig10": lambda: capture.fig10({"scenario_1": plan("scenario_1")}, {"scenario_1": samples()}, {"scenario_1": simulated()}),
    "fig11": lambda: evaluation.fig11(trials(), description(), pairs(), PUBLISHED_ERRORS),
    "fig12": lambda: evaluation.fig12(trials(), description(), pairs(), PUBLISHED_ERRORS),
    "fig13": lambda: evaluation.fig13(ablations(), PUBLISHED_ABLATIONS, ablations()),
    "fig14": lambda: evaluation.fig14(sweep(), timings(), PUBLISHED_ERROR_OF_K, PUBLISHED_MS, sweep()),
    "fig15": lambda: evaluation.fig15(long_times(), long_published()),
    "claims": lambda: claims.fig_claims(claim_rows()),
    "scores": lambda: real.fig_scores(scores(), summary()),
    "forecast_scores": lambda: forecasts.fig_forecast_scores(forecast_scores()),
    "calibration": lambda: forecasts.fig_calibration(calibration(), forecast_scores()),
    "pit": lambda: forecasts.fig_pit(calibration()),
    "realism": lambda: realism.fig_realism(realism_values()),
    "realism_alone": lambda: realism.fig_realism(realism_values().query("group == 'synthetic'")),
    "replicated_claims": lambda: replicates.fig_counted_claims(counted_claims()),
    "replicated_scores": lambda: replicates.fig_pooled_scores(pooled_scores()),
    "recovery": lambda: recovery.fig_recovery(recovered(), recovered_densities()),
    "specification_curve": lambda: multiverse.fig_specification_curve(effects(), listed(), ["scenario_1", "scenario_2"]),
}
