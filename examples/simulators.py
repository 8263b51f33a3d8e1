"""What the examples with other simulators share: a corridor, its agents, and a model to draw their speeds from.

A simulator asks the model once per agent, with what it knows of the walk ahead of it: how long and how bent its path is, and
how tall the person is. Of the steering parameters drawn, ``v`` (m/s) is the speed the agent wishes to walk at.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from walklab import ProbabilisticModel

OWN_WALKS = Path(__file__).with_name("own_walks.csv")
CORRIDOR_M = (8.0, 4.0)
WALK_M = 3.0  # straight ahead
SLOWEST_M_S = 0.2  # the paper's parameter space begins at 0.1 m/s, which is hardly walking


def model_from(arguments: list[str]) -> ProbabilisticModel:
    """The model file named on the command line, or one that is trained on the small example of own walks."""
    if arguments:
        return ProbabilisticModel.load(arguments[0])
    from walklab.capture.own import OwnColumns
    from walklab.fitting import fit_walks
    from walklab.steering.training import TrainingSettings

    # Not the literal exponent of 1, with which drawn speeds are nearly uniform over the grid. No exponent can be learned from
    # a few invented walks; 8 is set by hand, so that agents differ about as people do. A study learns it: see docs/model.md.
    columns = OwnColumns(participant="person", height="height_cm")
    settings = TrainingSettings(count=None, basis="multilinear", exponent=8.0)
    return fit_walks(OWN_WALKS, columns, height_unit="cm", dependencies=("length", "height"), settings=settings)


def wished_speeds(model: ProbabilisticModel, heights_m: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Speed (m/s) each agent wishes to walk at, one draw per agent for a straight walk of WALK_M."""
    known = {"length": WALK_M, "curvature": 0.0, "start_speed": 0.0}
    vectors = [[height if name == "height" else known[name] for name in model.dependencies] for height in heights_m]
    drawn = model.sample_batch(vectors, rng=rng)[:, 0]
    return np.maximum(drawn[:, model.names.index("v")], SLOWEST_M_S)


def report(simulator: str, wished_m_s: np.ndarray, walked_m: np.ndarray, duration_s: float) -> None:
    """Print one line per agent."""
    print(f"{simulator}: {len(wished_m_s)} agents, {duration_s:.1f} s", file=sys.stdout)
    for index, (speed, way) in enumerate(zip(wished_m_s, walked_m, strict=True)):
        print(f"  agent {index}: wishes {speed:.2f} m/s, walked {way:.2f} m, {way / duration_s:.2f} m/s on average")
