"""Whether paths lead through obstacles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray


def through(obstacles: shapely.Geometry, paths_m: Sequence[NDArray[np.float64]]) -> NDArray[np.bool_]:
    """Whether each path, an (n, 2) array, has a part of its length inside the obstacles; touching an outline is none.

    The obstacles are not grown by a body: it is the centre of the body that goes through.
    """
    # A path of one point has no length and crosses nothing.
    lines = np.array([shapely.linestrings(path) if len(path) > 1 else shapely.LineString() for path in paths_m])
    shapely.prepare(obstacles)
    return np.asarray(shapely.crosses(obstacles, lines) | shapely.contains(obstacles, lines), dtype=bool)
