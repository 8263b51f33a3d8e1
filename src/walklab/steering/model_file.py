"""A run-time model as one safetensors file with a JSON header: loads in milliseconds, cannot execute code."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from walklab.errors import InputError
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.domain import DomainOfValidity
from walklab.steering.interpolation import GridInterpolant, Interpolant, interpolant_named
from walklab.steering.mapped_tensors import open_tensors
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.scaling import Scaling
from walklab.steering.space import Axis, ParameterSpace

FORMAT = "walklab motion model"
VERSION = 2

LARGE = ("maps", "coefficients", "rungs", "parents", "parent_weights")  # not looked through when a model is opened to draw from


def write_model(model: ProbabilisticModel, path: str | Path) -> None:
    """Write a probabilistic model (an adaptive one is the same file, used by its mode).

    Raises
    ------
    InputError
        If it holds a value that is not finite.
    """
    from walklab.storage import write_tensors  # late: a process that only samples must not pay for what storage imports

    blending = model.blending
    tensors: dict[str, np.ndarray] = {
        "vectors": blending.vectors,
        "maps": blending.maps,
        "parents": blending.parents,
        "parent_weights": blending.parent_weights,
        "rungs": model.rungs,
        "domain_centre": model.domain.centre,
        "domain_basis": model.domain.basis,
        "domain_equations": model.domain.equations,
    }
    basis: dict[str, Any] = {"name": model.interpolant.name}
    if isinstance(model.interpolant, GridInterpolant):
        basis |= {"kernel": model.interpolant.kernel, "epsilon": model.interpolant.epsilon}
        tensors["coefficients"] = model.coefficients
    for name, values in tensors.items():
        _require_finite(name, values)
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
        "basis": basis,
        "rung": model.rung,
        "domain": "convex hull of the captured dependencies, scaled: domain_equations in the coordinates of domain_basis",
        "provenance": dict(model.provenance),
    }
    write_tensors(tensors, header, path)


def read_model(path: str | Path, check_all: bool = True) -> ProbabilisticModel:
    """Open a model; its arrays stay in the file, memory-mapped, until they are used.

    Parameters
    ----------
    check_all : look through the large arrays for values that are not finite, which reads the whole file; without it a
        damaged map is noticed when it is drawn from

    Raises
    ------
    InputError
        If the file is damaged, is something else, or its parts do not fit each other.
    """
    tensors, header = open_tensors(path)
    if not isinstance(header, dict) or header.get("format") != FORMAT or header.get("version") != VERSION:
        raise InputError(f"{path}: not a {FORMAT} of version {VERSION}; use `walklab migrate`, or train the model again")
    try:
        return _assemble(tensors, header, check_all)
    except (KeyError, TypeError, ValueError) as error:  # InputError is a ValueError: its line gets the file's name here
        raise InputError(f"{path}: the model is incomplete or inconsistent ({error}); train it again") from error


def _assemble(tensors: dict[str, np.ndarray], header: dict[str, Any], check_all: bool) -> ProbabilisticModel:
    axes = tuple(Axis(axis["name"], axis["unit"], tuple(float(v) for v in axis["values"])) for axis in header["axes"])
    space = ParameterSpace(axes)
    named = header["dependencies"]
    basis = header["basis"]
    interpolant: Interpolant = interpolant_named(
        basis["name"], space.shape, basis.get("kernel", "multiquadric"), float(basis.get("epsilon", 1.0))
    )
    radial = isinstance(interpolant, GridInterpolant)
    coefficients = tensors["coefficients"] if radial else tensors["maps"]
    entries, blocks, count = len(tensors["vectors"]), int(np.prod(np.array(space.shape) - 1)), len(named)
    rank = len(tensors["domain_basis"])
    expected = {
        "vectors": (entries, count),
        "maps": (entries, interpolant.cells),
        "parents": (entries, tensors["parents"].shape[1]),
        "parent_weights": tensors["parents"].shape,
        "rungs": (entries, blocks if radial else interpolant.cells),
        "domain_centre": (count,),
        "domain_basis": (rank, count),
        "domain_equations": (len(tensors["domain_equations"]), rank + 1),
    }
    if radial:
        expected["coefficients"] = (entries, interpolant.terms)
    for name, shape in expected.items():
        if tensors[name].shape != shape:
            raise ValueError(f"tensor {name} has shape {tensors[name].shape}, not {shape}")
        if check_all or name not in LARGE:
            _require_finite(name, tensors[name])
    if tensors["rungs"].dtype != np.uint8 or not np.isfinite(header["rung"]):
        raise ValueError("tensor rungs or its unit is no bound")
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
        coefficients,
        tensors["rungs"],
        float(header["rung"]),
        domain,
        header["k"],
        header["weights"],
        header["exponent"],
        header["fixed"],
        header["provenance"],
    )


def _require_finite(name: str, values: np.ndarray) -> None:
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise InputError(f"tensor {name} holds a value that is not finite")
