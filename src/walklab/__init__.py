"""walklab learns from captured human walks how people steer and simulates them with it.

What stands here is the public interface for other programs. Each name is imported when it is
first used, so that a program which only samples does not load what training needs.
"""

import importlib
from typing import Any

# Names are given as text on purpose: an import statement would make every rule of the workflow depend on all of them.
_HOMES = {
    "AdaptiveModel": "walklab.steering.models",
    "Body": "walklab.geometry.scene",
    "InputError": "walklab.errors",
    "OutsideTrainingRange": "walklab.steering.domain",
    "ProbabilisticModel": "walklab.steering.probabilistic",
    "Scene": "walklab.geometry.scene",
    "State": "walklab.geometry.scene",
    "StaticModel": "walklab.steering.models",
    "Task": "walklab.geometry.scene",
    "Trajectory": "walklab.planning.protocol",
    "load_plan": "walklab.geometry.plans",
    "simulate": "walklab.simulation",
    "simulate_draws": "walklab.simulation",
    "task_vector": "walklab.simulation",
    "travel_time_quantiles": "walklab.simulation",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'walklab' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
