"""A run-time model as one safetensors file with a JSON header: loads in milliseconds, cannot execute code."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from walklab.errors import InputError
from walklab.steering.arguments import LARGEST
from walklab.steering.blending_space import MAP_RANGE, BlendingSpace
from walklab.steering.domain import DomainOfValidity
from walklab.steering.interpolation import GridInterpolant, Interpolant, interpolant_named
from walklab.steering.mapped_tensors import open_tensors
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.scaling import Scaling
from walklab.steering.space import Axis, ParameterSpace

FORMAT = "walklab motion model"
VERSION = 2

KINDS = {"parents": "i", "rungs": "u"}  # of numbers; all other arrays are of floats
LARGE = ("maps", "coefficients", "rungs", "parents", "parent_weights")  # not looked through when a model is opened to draw from


def write_model(model: ProbabilisticModel, path: str | Path) -> None:
    """Write a probabilistic model (an adaptive one is the same file, used by its mode).

    Raises
    ------
    InputError
        If it holds a value that is not finite, or text with control characters.
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
    _require_plain(header)
    write_tensors(tensors, header, path)


def read_model(path: str | Path, check_all: bool = True) -> ProbabilisticModel:
    """Open a model; its arrays stay in the file, memory-mapped, until they are used.

    Parameters
    ----------
    check_all : look through the large arrays for values that cannot be, which reads the whole file; without it a
        damaged map is noticed when it is drawn from

    Raises
    ------
    InputError
        If the file is damaged, is something else or of another version, or its parts do not fit each other.
    """
    tensors, header = open_tensors(path)
    if version_of(header, path) != VERSION:
        raise InputError(
            f"{path}: a {FORMAT} of version {header['version']}, this walklab reads {VERSION}; use `walklab migrate`"
        )
    try:
        return _assemble(tensors, header, check_all, str(path))
    except (AttributeError, KeyError, TypeError, ValueError) as error:  # InputError is a ValueError: the file's name comes here
        raise InputError(f"{path}: the model is incomplete or inconsistent ({error}); train it again") from error


def version_of(header: Any, path: str | Path) -> int:
    """The version of a model file, at most the present one.

    Raises
    ------
    InputError
        If it is no model file, or of a later version.
    """
    version = header.get("version") if isinstance(header, dict) and header.get("format") == FORMAT else None
    if type(version) is not int or version < 1:
        raise InputError(f"{path}: not a {FORMAT}; give the file of a trained model")
    if version > VERSION:
        raise InputError(f"{path}: a {FORMAT} of version {version}, this walklab reads up to {VERSION}; update walklab")
    return version


def _assemble(tensors: dict[str, np.ndarray], header: dict[str, Any], check_all: bool, origin: str) -> ProbabilisticModel:
    _require_plain(header)
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
        if tensors[name].dtype.kind != KINDS.get(name, "f"):
            raise ValueError(f"tensor {name} holds numbers of type {tensors[name].dtype}")
        if check_all or name not in LARGE:
            _require_finite(name, tensors[name])
    if not 0.0 < header["rung"] <= LARGEST:
        raise ValueError(f"rung = {header['rung']} is no unit of bounds")
    _require_entries(tensors["parents"])
    if check_all:
        _require_possible(tensors, coefficients)
    scaling = Scaling(np.array([d["offset"] for d in named], dtype=float), np.array([d["scale"] for d in named], dtype=float))
    if not (np.abs(scaling.offset) <= LARGEST).all() or not ((scaling.scale >= 1 / LARGEST) & (scaling.scale <= LARGEST)).all():
        raise ValueError(f"offset or scale of a dependency is not finite or beyond {LARGEST:g}, or scale is not above 0")
    if not (np.abs(tensors["vectors"]) <= LARGEST).all():
        raise ValueError(f"tensor vectors holds a dependency beyond {LARGEST:g}")
    names = [d["name"] for d in named]
    if not all(isinstance(d[key], str) for d in named for key in ("name", "unit")) or len(set(names)) < len(names):
        raise ValueError("names and units of dependencies are no text, or a name is there twice")
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
        origin,
    )


def _require_plain(header: dict[str, Any]) -> None:
    """Text of a header may reach a terminal or a page, so it holds no control characters; counts are whole numbers."""

    def texts(value: Any) -> Iterator[str]:
        if isinstance(value, str):
            yield value
        elif isinstance(value, dict):
            for name, part in value.items():
                yield name
                yield from texts(part)
        elif isinstance(value, list):
            for part in value:
                yield from texts(part)

    for text in texts(header):
        if not text.isprintable():
            raise InputError(f"the header holds control characters: {text[:40]!a}")
    if type(header["k"]) is not int or not isinstance(header["fixed"], dict) or not isinstance(header["provenance"], dict):
        raise InputError("k is no whole number, or fixed or provenance is no mapping")


def _require_entries(parents: np.ndarray) -> None:
    if parents.shape[1] < 1 or (parents[:, 0] < 0).any() or parents.min() < -1 or parents.max() >= len(parents):
        raise ValueError("tensor parents names an entry that is not there")


def _require_possible(tensors: dict[str, np.ndarray], coefficients: np.ndarray) -> None:
    """Maps lie between 0 and 1 and are positive somewhere, as are bounds; weights, some below 0, add up to 1."""
    if not np.allclose(tensors["parent_weights"].sum(axis=1), 1.0, atol=1e-4):
        raise ValueError("tensor parent_weights holds weights that do not add up to 1")
    if tensors["maps"].min() < MAP_RANGE[0] or tensors["maps"].max() > MAP_RANGE[1]:
        raise ValueError(f"tensor maps holds values outside of {MAP_RANGE[0]:g} to {MAP_RANGE[1]:g}")
    for name, values in (("maps", tensors["maps"]), ("coefficients", coefficients), ("rungs", tensors["rungs"])):
        if not values.any(axis=1).all():
            row = int(np.flatnonzero(~values.any(axis=1))[0])
            raise ValueError(f"tensor {name}, row {row}, is 0 throughout; nothing could be drawn from that map")


def _require_finite(name: str, values: np.ndarray) -> None:
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise InputError(f"tensor {name} holds a value that is not finite")
