"""What the paper leaves open, and the readings of it that are compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Literal

from walklab.errors import InputError

if TYPE_CHECKING:  # a workflow lists its specifications before it needs the kernels that these modules bring along
    from walklab.steering.scaling import ScalingRule
    from walklab.steering.suitability import Normalisation
    from walklab.steering.weighting import Weighting

Value = str | bool


@dataclass(frozen=True)
class Choices:
    """One reading of everything the paper leaves open; the fields are those of :data:`READINGS`."""

    normalisation: Normalisation = "per_map_max"
    weights: Weighting = "linear"
    scaling: ScalingRule = "standard_deviation"
    index: Literal["planned", "captured"] = "planned"
    curvature: Literal["mean", "sample_sum"] = "mean"
    interpolation: str = "multiquadric"
    held: Literal["P_Stat", "middle"] = "P_Stat"
    metric: str = "euclid"
    turn_law: str = "proportional"
    braking: bool = True
    ends_at: str = "line"

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if value not in READINGS[name].values:
                raise InputError(f"choice {name}: there is no {value!r}; choose from {READINGS[name].values}")

    def with_values(self, values: Mapping[str, Value]) -> Choices:
        """The same with some fields replaced."""
        return Choices(**{**asdict(self), **values})

    def differences(self, other: Choices) -> dict[str, Value]:
        """Fields of this reading that are not those of another."""
        own, others = asdict(self), asdict(other)
        return {name: value for name, value in own.items() if value != others[name]}


@dataclass(frozen=True)
class Reading:
    """One ambiguity: where it is in the paper, what it is, its readings, and those that combinations draw from."""

    section: str
    question: str
    values: tuple[Value, ...]
    combined: tuple[Value, ...]


def _reading(section: str, question: str, *values: Value, combined: tuple[Value, ...] | None = None) -> Reading:
    return Reading(section, question, values, values if combined is None else combined)


READINGS: Mapping[str, Reading] = {
    "normalisation": _reading("4.3", "how the metric becomes a suitability", "per_map_max", "global_max", "min_max"),
    "weights": _reading("5", "how a neighbour counts by its distance", "linear", "inverse", "uniform"),
    "scaling": _reading("4.4", "how dependencies are made comparable", "standard_deviation", "range", "none"),
    "index": _reading("4.4, 7.3", "which path a training walk is filed under", "planned", "captured"),
    "curvature": _reading("4.4", "formula of the curvature", "mean", "sample_sum"),
    "interpolation": _reading(
        "5", "radial basis function, or another basis",
        "multiquadric", "thin_plate_spline", "cubic", "linear", "gaussian", "multilinear",
    ),
    "held": _reading("8.1", "value of a removed steering parameter", "P_Stat", "middle"),
    # Scores that are not swept by compiled code take minutes a specification: combinations leave them out.
    "metric": _reading(
        "4.3", "distance between captured and simulated walk, and when it ends",
        "euclid", "euclid_until_both_end", "mean_distance", "end_point", "frechet", "travel_time",
        combined=("euclid", "euclid_until_both_end", "mean_distance"),
    ),
    "turn_law": _reading("4.3", "what omega limits: turning per metre, or per second", "proportional", "constant"),
    "braking": _reading("4.3", "whether the agent brakes for its end", True, False),
    "ends_at": _reading("4.3, 7.3", "when a simulated walk has ended", "line", "radius"),
}  # fmt: skip
