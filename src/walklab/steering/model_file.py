"""A run-time model as one safetensors file with a JSON header: loads in milliseconds, cannot execute code."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from walklab.errors import InputError
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.domain import DomainOfValidity
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.models import ProbabilisticModel
from walklab.steering.scaling import Scaling
from walklab.steering.space import Axis, ParameterSpace
from walklab.storage import read_tensors, write_tensors

FORMAT = "walklab motion model"
VERSION = 1


def write_model(model: ProbabilisticModel, path: str | Path) -> None:
    """Write a probabilistic model (an adaptive one is the same file, used by its mode)."""
    blending = model.blending
    tensors: dict[str, np.ndarray] = {
        "vectors": blending.vectors,
        "maps": blending.maps,
        "parents": blending.parents,
        "parent_weights": blending.parent_weights,
        "coefficients": model.coefficients,
        "bounds": model.bounds,
        "domain_centre": model.domain.centre,
        "domain_basis": model.domain.basis,
        "domain_equations": model.domain.equations,
    }
    scaling = blending.scaling
    header = {
        "format": FORMAT,
        "version": VERSION,
        "axes": [{"name": axis.name, "unit": axis.unit, "values": list(axis.values)} for axis in model.space.axes],
        "dependencies": [
            {"name": name, "unit": unit, "offset": float(offset), "scale": float(scale)}
            for name, unit, offset, scale in zip(blending.names, blending.units, scaling.offset, scaling.scale, strict=True)
        ],
        "k": model.k,
        "weights": model.weights,
        "exponent": model.exponent,
        "fixed": dict(model.fixed),
        "kernel": {"name": model.interpolant.kernel, "epsilon": model.interpolant.epsilon},
        "domain": "convex hull of the captured dependencies, scaled: domain_equations in the coordinates of domain_basis",
        "provenance": dict(model.provenance),
    }
    write_tensors(tensors, header, path)


def read_model(path: str | Path) -> ProbabilisticModel:
    """Read a model.

    Raises
    ------
    InputError
        If the file is damaged, is something else, or its parts do not fit each other.
    """
    tensors, header = read_tensors(path)
    if not isinstance(header, dict) or header.get("format") != FORMAT or header.get("version") != VERSION:
        raise InputError(f"{path}: not a {FORMAT} of version {VERSION}; train the model again")
    try:
        return _assemble(tensors, header)
    except (KeyError, TypeError, ValueError) as error:  # InputError is a ValueError: its line gets the file's name here
        raise InputError(f"{path}: the model is incomplete or inconsistent ({error}); train it again") from error


def _assemble(tensors: dict[str, np.ndarray], header: dict[str, Any]) -> ProbabilisticModel:
    axes = tuple(Axis(axis["name"], axis["unit"], tuple(float(v) for v in axis["values"])) for axis in header["axes"])
    space = ParameterSpace(axes)
    named = header["dependencies"]
    interpolant = GridInterpolant(space.shape, header["kernel"]["name"], float(header["kernel"]["epsilon"]))
    entries, blocks, count = len(tensors["vectors"]), int(np.prod(np.array(space.shape) - 1)), len(named)
    rank = len(tensors["domain_basis"])
    expected = {
        "vectors": (entries, count),
        "maps": (entries, interpolant.cells),
        "parents": (entries, tensors["parents"].shape[1]),
        "parent_weights": tensors["parents"].shape,
        "coefficients": (entries, interpolant.terms),
        "bounds": (entries, blocks),
        "domain_centre": (count,),
        "domain_basis": (rank, count),
        "domain_equations": (len(tensors["domain_equations"]), rank + 1),
    }
    for name, shape in expected.items():
        if tensors[name].shape != shape:
            raise ValueError(f"tensor {name} has shape {tensors[name].shape}, not {shape}")
        if tensors[name].dtype.kind == "f" and not np.all(np.isfinite(tensors[name])):
            raise ValueError(f"tensor {name} holds a value that is not finite")
    scaling = Scaling(np.array([d["offset"] for d in named], dtype=float), np.array([d["scale"] for d in named], dtype=float))
    blending = BlendingSpace(
        tuple(d["name"] for d in named),
        tuple(d["unit"] for d in named),
        tensors["vectors"],
        scaling,
        tensors["maps"],
        tensors["parents"],
        tensors["parent_weights"],
    )
    domain = DomainOfValidity(scaling, tensors["domain_centre"], tensors["domain_basis"], tensors["domain_equations"])
    return ProbabilisticModel(
        blending,
        space,
        interpolant,
        tensors["coefficients"],
        tensors["bounds"],
        domain,
        header["k"],
        header["weights"],
        header["exponent"],
        header["fixed"],
        header["provenance"],
    )
