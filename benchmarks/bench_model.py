"""Speed of the run-time model beside what people would use instead, in the same run.

The baseline of a sample is scikit-learn's ``KDTree``, a numpy blend, scipy's
``RBFInterpolator`` solved for the blended map, and rejection under the grid's maximum. Its time does not depend
on what comes after the solution, so it draws at exponent 1, its cheapest, throughout.
"""

from __future__ import annotations

import atexit
import functools
import pickle
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from case import Case, Work, least_s
from scipy.interpolate import RBFInterpolator
from sklearn.neighbors import KDTree

from walklab import ProbabilisticModel
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


@functools.cache
def baseline_s(k: int) -> float:
    """Seconds for one sample of the baseline, the same for all rows of one k: the least of many rounds."""
    model, rng = synthetic_model("rbf"), np.random.default_rng(2)
    asked, baseline = queries(model), Baseline(model)

    def theirs() -> None:
        for vector in asked[:3]:
            baseline.sample(vector, k, rng)

    return least_s(theirs, 3, rounds=15)


def sampling(key: str, basis: str, k: int, exponent: float, batched: bool) -> Case:
    """One sample for each of many vectors, one call each or all in one."""

    def prepare() -> Work:
        model = replace(synthetic_model(basis), k=k, exponent=exponent)
        asked, rng = queries(model), np.random.default_rng(2)

        def singly() -> None:
            for vector in asked:
                model.sample(vector, 1, rng)

        ours = (lambda: model.sample_batch(asked, 1, rng)) if batched else singly
        return Work(ours, QUERIES, UNITS, lambda: baseline_s(k), BASELINE)

    return Case(key, prepare, f"exponent_{exponent:g}")


def loading() -> Work:
    """Opening and drawing one; the baseline unpickles the same object and draws with the same code."""
    folder = Path(tempfile.mkdtemp(prefix="walklab-bench-"))
    saved, pickled = folder / "model.safetensors", folder / "model.pickle"
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    model = synthetic_model("rbf")
    model.save(saved)
    fresh = ProbabilisticModel.load(saved)  # an object that has not drawn yet, so that no search tree is pickled
    pickled.write_bytes(pickle.dumps(fresh, protocol=5))
    vector, rng = queries(model, 1)[0], np.random.default_rng(0)

    def unpickle() -> None:
        with open(pickled, "rb") as file:
            pickle.load(file).sample(vector, 1, rng)

    return Work(
        lambda: ProbabilisticModel.load(saved).sample(vector, 1, rng),
        1,
        "s",
        lambda: least_s(unpickle, rounds=15),
        "unpickling the same arrays and drawing one",
    )


ROWS = (
    ("sample_rbf_k100", "rbf", 100, False),
    ("sample_k100", "multilinear", 100, False),
    ("sample_k500", "multilinear", 500, False),
    ("sample_batch", "multilinear", 100, True),
)
CASES = [
    *(sampling(key, basis, k, exponent, batched) for key, basis, k, batched in ROWS for exponent in EXPONENTS),
    Case("model_load", loading),
]
