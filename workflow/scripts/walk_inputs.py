"""What scripts make of walks and routes that lie in several shards."""

from collections.abc import Sequence

from numpy.typing import NDArray

from walklab.capture.walks import Walk, read_walks
from walklab.planning.io import read_routes


def all_walks(walks: Sequence[str], samples: Sequence[str]) -> list[Walk]:
    """The walks of all shards, in the order of their names."""
    found = [walk for pair in zip(walks, samples, strict=True) for walk in read_walks(*pair)]
    return sorted(found, key=lambda walk: walk.row["walk"])


def all_routes(paths: Sequence[str]) -> dict[str, NDArray]:
    """The routes of all shards by walk."""
    return {name: route for path in paths for name, route in read_routes(path).items()}
