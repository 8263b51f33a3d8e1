"""Cost against the number of maps, k, cells, walks and threads, with fitted exponents: ``results/bench/scaling.*``."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import replace

import matplotlib

matplotlib.use("agg")
import numba
import numpy as np
import pandas as pd
from bench_model import queries, synthetic_model
from bench_sweep import PLANNER, walks
from case import least_s
from summary import FOLDER

from walklab import OutsideTrainingRange
from walklab.figures.scaling import scaling
from walklab.figures.style import save
from walklab.storage import write_table

MAPS = (5_000, 50_000, 500_000)
NEIGHBOURS = (10, 20, 50, 100, 200, 500)
CELLS = (10, 20, 30)  # an axis
WALKS = (60, 120, 240, 480, 960)
SAMPLES = 300


def sample_s(model, asked: np.ndarray) -> float:
    rng = np.random.default_rng(2)

    def draw() -> None:
        for vector in asked:
            model.sample(vector, 1, rng)

    return least_s(draw, len(asked))


def sampling_costs() -> list[tuple[str, float, float, str]]:
    """One sample of the fast basis at exponent 1 (k = 100, 1000 cells, 5000 maps, but for what varies)."""
    rows = []
    for maps in MAPS:
        # Few cells: half a million maps of 1000 would take 4 GB, and a sample reads only the k it blends.
        model = synthetic_model("multilinear", maps, 4)
        rows.append(("maps", maps, sample_s(model, queries(model, SAMPLES)), "s per sample"))
    model = synthetic_model("multilinear")
    asked = queries(model, SAMPLES)
    rows += [("k", k, sample_s(replace(model, k=k), asked), "s per sample") for k in NEIGHBOURS]
    for cells in CELLS:
        model = synthetic_model("multilinear", 1000, cells)
        rows.append(("cells, sampling", cells**3, sample_s(model, queries(model, SAMPLES)), "s per sample"))
    return rows


def space(cells: int) -> np.ndarray:
    values = np.linspace(0.1, 1.99, cells)
    return np.stack(np.meshgrid(values, values, values, indexing="ij"), -1).reshape(-1, 3)


def sweeping_costs() -> list[tuple[str, float, float, str]]:
    """Maps of walks, wall time; one thread but where threads vary."""
    rows, paper = [], space(10)

    def wall_s(action: Callable[[], object]) -> float:
        action()
        times = []
        for _ in range(5):
            start = time.perf_counter()
            action()
            times.append(time.perf_counter() - start)
        return min(times)

    everything = numba.get_num_threads()
    numba.set_num_threads(1)
    for count in WALKS:
        batch = walks(count)
        rows.append(("walks", count, wall_s(lambda batch=batch: PLANNER.sweep_euclid(batch, paper)), "s for all maps"))
    few = walks(60)
    for cells in CELLS:
        parameters = space(cells)
        spent_s = wall_s(lambda parameters=parameters: PLANNER.sweep_euclid(few, parameters))
        rows.append(("cells, sweep", cells**3, spent_s, "s for all maps"))
    many = walks(480)
    for threads in range(1, everything + 1):
        numba.set_num_threads(threads)
        rows.append(("threads", threads, wall_s(lambda: PLANNER.sweep_euclid(many, paper)), "s for all maps"))
    numba.set_num_threads(everything)
    return rows


def main() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutsideTrainingRange)
        costs = pd.DataFrame([*sampling_costs(), *sweeping_costs()], columns=["quantity", "value", "cost_s", "unit"])
    for quantity, group in costs.groupby("quantity"):
        exponent = np.polyfit(np.log(group["value"]), np.log(group["cost_s"]), 1)[0] if len(group) > 1 else np.nan
        costs.loc[group.index, "exponent"] = exponent
        print(f"cost ~ ({quantity})^{exponent:.2f}")
    write_table(costs, FOLDER / "scaling.csv")
    save(scaling(costs), FOLDER / "scaling.svg", FOLDER / "scaling.png")


if __name__ == "__main__":
    main()
