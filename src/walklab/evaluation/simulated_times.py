"""Travel times simulated with one parameter vector per walk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walklab.capture.walks import Walk
from walklab.geometry.standing import Standing
from walklab.planning.durations import trajectory_travel_time_s
from walklab.planning.protocol import Arrival, Planner
from walklab.steering.routes import task_of

Array = NDArray[np.float64]


def travel_times(
    planner: Planner,
    walks: Sequence[Walk],
    routes: Mapping[str, Array],
    parameters: ArrayLike,
    standing: Standing,
    time_limit_s: float,
) -> Array:
    """(W,) travel times with the (W, P) parameters; the time limit where it was reached."""
    result = np.empty(len(walks))
    for row, (walk, values) in enumerate(zip(walks, np.asarray(parameters, dtype=float), strict=True)):
        task = task_of(walk.row)
        trajectory = planner.follow(routes[str(walk.row["walk"])], task, values, time_limit_s)
        timeout = trajectory.arrival == Arrival.TIMEOUT
        result[row] = time_limit_s if timeout else trajectory_travel_time_s(trajectory, task, standing.standing_speed_m_s)
    return result
