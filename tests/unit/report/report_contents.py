"""A small made-up run, as the report reads it: a model over random maps, drawn figures, tables, walks to play."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import figure_inputs
import numpy as np
import pandas as pd
import yaml

from walklab.capture.walks import Walk
from walklab.figures.style import save
from walklab.geometry.plans import Plan
from walklab.geometry.scene import Body, Scene, Task
from walklab.planning.protocol import Arrival, Trajectory
from walklab.report.contents import Contents, ReportFigure, ReportTable
from walklab.report.io import read_figure
from walklab.report.map_lattice import Exponents, map_lattice
from walklab.report.shown_walks import scene_data
from walklab.steering.blending_space import blending_space
from walklab.steering.building import probabilistic_model
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.scaling import fit_scaling
from walklab.steering.space import ParameterSpace

ROOT = Path(__file__).parents[3]
PAPER: Mapping[str, Any] = yaml.safe_load((ROOT / "config/papers/agethen_steering.yaml").read_text())
HOSTILE = '<img src=x onerror="document.title=1">&amp;</script>'
MODELS = ("P_Stat", "P_Adapt", "P_Prob", "P_Prob (calibrated)")


def small_model(
    space: ParameterSpace | None = None, vectors: np.ndarray | None = None, exponent: float = 1.0
) -> ProbabilisticModel:
    """A model over random maps at random dependencies."""
    space = space or figure_inputs.space()
    vectors = figure_inputs.vectors() if vectors is None else vectors
    names, units = ("length", "curvature", "height")[: vectors.shape[1]], ("m", "1/m", "m")[: vectors.shape[1]]
    maps = np.random.default_rng(4).random((len(vectors), len(space.cells)))
    blending = blending_space(names, units, vectors, maps, fit_scaling(vectors))
    return probabilistic_model(blending, space, k=min(8, len(vectors)), exponent=exponent)


def constant(exponent: float) -> Exponents:
    """The same exponent everywhere."""
    return lambda points: np.full(len(points), exponent)


@dataclass(frozen=True)
class Straight:
    """Follows the route at the speed that is its first parameter."""

    parameters: tuple[str, ...] = ("v", "a", "omega")
    step_s: float = 1 / 60
    moving_start: bool = False

    def route(self, scene: Scene, task: Task, body: Body) -> np.ndarray:
        return np.array([task.start.position_m, task.end.position_m])

    def follow(self, route_m: np.ndarray, task: Task, parameters: np.ndarray, time_limit_s: float) -> Trajectory:
        length_m = float(np.linalg.norm(route_m[-1] - route_m[0]))
        steps = int(min(length_m / parameters[0], time_limit_s) / self.step_s)
        share = np.minimum(np.arange(steps + 1) * self.step_s * parameters[0] / length_m, 1.0)[:, None]
        return Trajectory(route_m[0] + share * (route_m[-1] - route_m[0]), self.step_s, Arrival.ARRIVED)


def walk(number: int, participant: str = "scenarios_P01", configuration: str = "start-end") -> Walk:
    """A straight captured walk of 2 m in 2 + number / 10 s."""
    duration_s = 2 + number / 10
    time_s = np.linspace(0, duration_s, 61)
    row = pd.Series(
        {
            "walk": f"w{number}",
            "participant": participant,
            "configuration": configuration,
            "duration_s": duration_s,
            "start_x_m": -1.0,
            "start_y_m": 0.5,
            "end_x_m": 1.0,
            "end_y_m": 0.5,
            "start_speed_m_s": 0.0,
            "end_speed_m_s": 0.0,
        }
    )
    return Walk(row, time_s, np.column_stack([-1 + 2 * time_s / duration_s, np.full(61, 0.5)]))


def trials_of(walks: list[Walk]) -> pd.DataFrame:
    rows = []
    for number, each in enumerate(walks):
        for place, model in enumerate(MODELS):
            v = 0.8 + 0.1 * place
            captured_s = float(each.row["duration_s"])
            rows.append((each.row["walk"], model, v, 1.0, 1.0, captured_s, 2 / v, 2 / v - captured_s, "arrived", number == 0))
    names = ["walk", "model", "v", "a", "omega", "captured_s", "simulated_s", "dt_s", "arrival", "collided"]
    return pd.DataFrame(rows, columns=names)


def scene(name: str, participant: str = "scenarios_P01") -> dict[str, Any]:
    walks = [walk(number, participant) for number in range(4)]
    routes = {str(each.row["walk"]): np.array([[-1.0, 0.5], [1.0, 0.5]]) for each in walks}
    plan: Plan = figure_inputs.plan(name)
    return scene_data(name, plan, walks, routes, trials_of(walks), Straight(), ("v", "a", "omega"), 60.0)


def record(run: str = "made_up", kind: str = "synthetic") -> dict[str, Any]:
    return {
        "run": run,
        "seed": 1,
        "commit": {"id": "0123456789abcdef", "dirty": False},
        "config": {
            "replicates": 1,
            "source": {"kind": kind, "path": "walks.csv"},
            "space": [{"name": "v", "values": [1, 2]}, {"name": "a", "start": 0.1, "step": 0.2, "count": 3}],
        },
        "machine": {"platform": "a machine", "python": "3.11", "cores": 2},
        "totals": {"jobs_wall_s": 12.5, "peak_memory_mb": 100.0},
        "stages": [{"stage": "score_maps", "part": "0", "replicate": 0, "wall_s": 1.25, "cpu_s": 1.5, "peak_memory_mb": 90.0}],
        "versions": {"numpy": "2"},
    }


def claims() -> pd.DataFrame:
    """Claims under their true ids, with every kind of value that the table of a run has."""
    rows = [
        (
            "scenario_1_p_stat_median",
            "7.4",
            "scenario 1, P_Stat: median of |dt| (s)",
            "0.514",
            0.15,
            0.1333,
            0.216667,
            "not reproduced",
            "why",
        ),
        ("scenario_2_p_stat_median", "7.4", "scenario 2, P_Stat: median of |dt| (s)", "0.85", 0.3, 0.2, 0.9, "reproduced", None),
        ("wilcoxon_p_scenario_1_p_stat_vs_p_prob", "7.4", "p", "0.0", 8.83325e-185, 0.0, 0.0, "partly", None),
        (
            "normality",
            "7.4",
            "no error is normally distributed",
            "a long statement in words",
            np.nan,
            np.nan,
            np.nan,
            "reproduced",
            None,
        ),
        ("ablation_full", "8.1", "full", "0.453", 0.441667, 0.4, 0.47, "not reproduced", None),
        ("k_sweep_10", "8.2", "k = 10", "1.43", 0.433, 0.4, 0.45, "not reproduced", None),
        ("sample_ms", "5", "time", "100.0", np.nan, np.nan, np.nan, "not checkable", "another machine"),
        ("long_distance_10_p_prob_median", "8.3", "10 m", "6.2", 12.8, 11.0, 14.0, "not reproduced", None),
    ]
    names = ["id", "section", "statement", "published", "ours", "ours_low", "ours_high", "verdict", "note"]
    return pd.DataFrame(rows, columns=names)


def tables(claim_table: pd.DataFrame) -> dict[str, ReportTable]:
    described = pd.DataFrame({"model": MODELS, "n": 40, "median": [0.15, 0.14, 0.44, 0.18]})
    capture = pd.DataFrame(
        {"dataset": ["training", "scenario_1"], "participants": [30, 10], "walks": [1848, 1984], "total_length_km": [4.9, 4.1]}
    )
    frames = {
        "claims": claim_table,
        "description_scenario_1": described,
        "capture": capture,
        "classes": figure_inputs.classes(),
        "scores": figure_inputs.forecast_scores(),
        "realism": pd.DataFrame(
            {"quantity": ["curvature"], "synthetic_median": [0.2], "recorded_median": [0.8], "n_recorded": [9], "source": ["A"]}
        ),
        "assumptions": pd.DataFrame({"file": ["a.py"], "line": [3], "text": [HOSTILE]}),
    }
    return {name: ReportTable(name.replace("_", " "), f"results/made_up/{name}.csv", frame) for name, frame in frames.items()}


def figures(folder: Path) -> dict[str, ReportFigure]:
    """Two figures of the paper and one that no section names."""
    drawn = {}
    for name, category, draw in (
        ("fig13", "Analyses", figure_inputs.FIGURES["fig13"]),
        ("claims", "Verdicts", figure_inputs.FIGURES["claims"]),
        ("fig99", "Unheard of", figure_inputs.FIGURES["fig03"]),
    ):
        save(draw(), folder / f"{name}.svg", folder / f"{name}.png", dpi=100)
        caption = ROOT / f"workflow/report/{name if name != 'fig99' else 'fig03'}.rst"
        drawn[name] = read_figure(name, category, folder / f"{name}.svg", caption)
    return drawn


def contents(folder: Path, run: str = "made_up") -> Contents:
    """Everything a synthetic run has, with names that would be markup if they were not escaped."""
    model = small_model()
    sharpness = {"P_Prob": constant(1.0), "P_Prob (calibrated)": lambda points: np.where(points[:, 0] < 2, 4.0, 9.0)}
    maps = map_lattice(model, sharpness, np.random.default_rng(0))
    scenes = [scene("scenario_1", HOSTILE), scene("scenario_2")]
    return Contents(record(run), PAPER, figures(folder), tables(claims()), maps, scenes)
