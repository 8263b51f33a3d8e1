"""What the planning scripts make of their parameters."""

from collections.abc import Mapping, Sequence
from typing import Any

from walklab.planning.protocol import Planner
from walklab.planning.registry import make_planner
from walklab.steering.space import ParameterSpace, space_from_config


def planner_of(planner: Mapping[str, Any], space: Sequence[Mapping[str, Any]]) -> tuple[Planner, ParameterSpace]:
    """The planner and the space of its steering parameters."""
    axes = space_from_config(space)
    return make_planner(planner["name"], axes.names, planner["step_s"], planner["options"]), axes
