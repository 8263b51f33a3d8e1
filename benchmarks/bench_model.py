"""Speed of the run-time model beside what people would use instead, in the same run.

``python benchmarks/bench_model.py`` prints a table. The baseline of a sample is scikit-learn's ``KDTree``, a numpy blend, scipy's
``RBFInterpolator`` solved for the blended map, and rejection under the grid's maximum. Its time does not depend
on what comes after the solution, so it draws at exponent 1, its cheapest, throughout.
"""

from __future__ import annotations

import gc
import pickle
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import RBFInterpolator
from sklearn.neighbors import KDTree

from walklab import OutsideTrainingRange, ProbabilisticModel
from walklab.steering.blending_space import blending_space
from walklab.steering.interpolation import interpolant_named
from walklab.steering.models import probabilistic_model
from walklab.steering.scaling import fit_scaling
from walklab.steering.space import space_from_config

MAPS, CELLS_PER_AXIS = 5000, 10
EXPONENTS = (1.0, 30.0)
QUERIES = 1000  # different dependency vectors, so that no cache holds the maps that are needed next
UNITS = "s per sample"
BASELINE = "KD-tree + blend + scipy RBFInterpolator + rejection"
PROPOSALS = 64

Row = dict[str, float | str]


def synthetic_model(basis: str, maps: int = MAPS, cells: int = CELLS_PER_AXIS, seed: int = 0) -> ProbabilisticModel:
    """Smooth maps of one peak each, whose place depends on length, curvature and height as it does in the study."""
    rng = np.random.default_rng(seed)
    vectors = np.column_stack([rng.uniform(0.5, 4.0, maps), rng.gamma(1.0, 0.2, maps), rng.normal(1.78, 0.07, maps)])
    axis = {"start": 0.1, "step": 1.89 / (cells - 1), "count": cells}
    space = space_from_config([{"name": n, "unit": u, **axis} for n, u in (("v", "m/s"), ("a", "m/s2"), ("omega", "1/m"))])
    speed = 0.4 + 0.28 * vectors[:, 0] - 0.4 * vectors[:, 1] + rng.normal(0, 0.1, maps)
    peak = np.column_stack([speed, 0.6 + 0.5 * speed, 0.5 + vectors[:, 1]])
    gaps = np.sqrt(sum(((space.cells[:, i] - peak[:, i, None]) / (0.6, 0.9, 2.0)[i]) ** 2 for i in range(3)))
    suitability = 1 - gaps / gaps.max(axis=1, keepdims=True)
    names, units = ("length", "curvature", "height"), ("m", "1/m", "m")
    blending = blending_space(names, units, vectors, suitability, fit_scaling(vectors))
    return probabilistic_model(blending, space, interpolant_named(basis, space.shape))


def queries(model: ProbabilisticModel, count: int = QUERIES) -> np.ndarray:
    """Vectors between those of the model."""
    rng = np.random.default_rng(1)
    vectors = model.blending.vectors
    first, second = vectors[rng.integers(0, len(vectors), (2, count))]
    return first + rng.random((count, 1)) * (second - first)


class Baseline:
    """One sample as one would write it with scikit-learn and scipy."""

    def __init__(self, model: ProbabilisticModel) -> None:
        self.scaling, self.maps, self.space = model.blending.scaling, model.blending.maps, model.space
        self.nodes = model.space.to_unit(model.space.cells)
        self.tree = KDTree(self.scaling.apply(model.blending.vectors))

    def sample(self, vector: np.ndarray, k: int, rng: np.random.Generator) -> np.ndarray:
        distances, indices = self.tree.query(self.scaling.apply(vector)[None], k + 1)
        shares = distances[0, -1] - distances[0, :-1]
        blended = shares / shares.sum() @ self.maps[indices[0, :-1]]
        surface = RBFInterpolator(self.nodes, blended, kernel="multiquadric", epsilon=1.0)
        low, high = self.space.bounds.T
        bound = 1.05 * blended.max()
        while True:
            proposals = rng.uniform(low, high, (PROPOSALS, len(low)))
            accepted = rng.random(PROPOSALS) * bound < surface(self.space.to_unit(proposals))
            if accepted.any():
                return proposals[np.argmax(accepted)]


def _turns(*actions: tuple[Callable[[], object], int], rounds: int = 7) -> list[float]:
    """Best CPU seconds per call of each action, taken in turns so that they share good and bad moments."""
    best = [np.inf] * len(actions)
    gc.disable()
    for _ in range(rounds):
        for index, (action, calls) in enumerate(actions):
            start = time.process_time()
            action()
            best[index] = min(best[index], (time.process_time() - start) / calls)
    gc.enable()
    return best


def _row(ours: float, baseline: float, name: str, unit: str = UNITS) -> Row:
    return {"ours": ours, "baseline": baseline, "baseline_name": name, "ratio": baseline / ours, "unit": unit}


def _sampling_rows(models: dict[str, ProbabilisticModel]) -> dict[str, Row]:
    asked = queries(models["rbf"])
    rng = np.random.default_rng(2)
    baseline = Baseline(models["rbf"])
    rows: dict[str, Row] = {}
    for key, basis, k in (
        ("sample_rbf_k100", "rbf", 100),
        ("sample_k100", "multilinear", 100),
        ("sample_k500", "multilinear", 500),
    ):
        variants = [replace(models[basis], k=k, exponent=exponent) for exponent in EXPONENTS]

        def singly(model: ProbabilisticModel) -> None:
            for vector in asked:
                model.sample(vector, 1, rng)

        def theirs(count: int = k) -> None:
            for vector in asked[:3]:
                baseline.sample(vector, count, rng)

        for model in variants:
            model.sample(asked[0], 1, rng)  # compiled before it counts
        *ours, other = _turns(*(((lambda m=m: singly(m)), QUERIES) for m in variants), (theirs, 3))
        rows[key] = _row(max(ours), other, BASELINE)
        if key == "sample_k100":
            ours = _turns(*(((lambda m=m: m.sample_batch(asked, 1, rng)), QUERIES) for m in variants), rounds=40)
            rows["sample_batch"] = _row(max(ours), other, BASELINE)
    return rows


def _loading_row(model: ProbabilisticModel, folder: Path) -> Row:
    """Opening and drawing one; the baseline unpickles the same object and draws with the same code."""
    saved, pickled = folder / "model.safetensors", folder / "model.pickle"
    model.save(saved)
    fresh = ProbabilisticModel.load(saved)  # an object that has not drawn yet, so that no search tree is pickled
    pickled.write_bytes(pickle.dumps(fresh, protocol=5))
    vector, rng = queries(model, 1)[0], np.random.default_rng(0)

    def load() -> None:
        ProbabilisticModel.load(saved).sample(vector, 1, rng)

    def unpickle() -> None:
        with open(pickled, "rb") as file:
            pickle.load(file).sample(vector, 1, rng)

    load()
    unpickle()
    return _row(*_turns((load, 1), (unpickle, 1), rounds=15), "unpickling the same arrays and drawing one", "s")


def measure() -> dict[str, Row]:
    """Rows of the table of speeds: seconds of ours and of the baseline, at exponent 1 or 30, whichever is slower for us."""
    models = {basis: synthetic_model(basis) for basis in ("rbf", "multilinear")}
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
        warnings.simplefilter("ignore", OutsideTrainingRange)
        return {**_sampling_rows(models), "model_load": _loading_row(models["rbf"], Path(folder))}


if __name__ == "__main__":
    for name, row in measure().items():
        print(
            f"{name:16} {row['ours']:.3g} {row['unit']}, {row['baseline_name']}: {row['baseline']:.3g}, ratio {row['ratio']:.0f}"
        )
