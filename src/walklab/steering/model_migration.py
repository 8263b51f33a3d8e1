"""Bringing model files of earlier versions up to the present one.

A model is stored with what makes sampling quick (coefficients, bounds). What was learned are the maps, their dependencies and
the settings; these are in every version, so an old file is read, and what is computed from them is computed again.

Version 1 (before 0.1.0): always radial basis functions, header key ``kernel``; bounds of blocks in double precision (``bounds``).
Version 2: header key ``basis``; bounds as one byte a block (``rungs``) in units of ``rung``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from walklab.errors import InputError
from walklab.steering.blending_space import BlendingSpace
from walklab.steering.building import probabilistic_model
from walklab.steering.interpolation import GridInterpolant
from walklab.steering.mapped_tensors import open_tensors
from walklab.steering.model_file import VERSION, version_of, write_model
from walklab.steering.probabilistic import ProbabilisticModel
from walklab.steering.scaling import Scaling
from walklab.steering.space import Axis, ParameterSpace


def migrate_model(source: str | Path, target: str | Path) -> int:
    """Write a model file of an earlier version as one of the present version.

    Returns
    -------
    the version of the source

    Raises
    ------
    InputError
        If the source is no model file, needs no migration, or is of a version that is not known.
    """
    tensors, header = open_tensors(source)
    if version_of(header, source) == VERSION:
        raise InputError(f"{source}: is of version {VERSION} already; nothing to migrate")
    try:
        model = _from_version_1(tensors, header)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{source}: the model is incomplete or inconsistent ({error}); train it again") from error
    write_model(model, target)
    return 1


def _from_version_1(tensors: dict[str, np.ndarray], header: dict[str, Any]) -> ProbabilisticModel:
    axes = tuple(Axis(axis["name"], axis["unit"], tuple(float(v) for v in axis["values"])) for axis in header["axes"])
    space = ParameterSpace(axes)
    named = header["dependencies"]
    blending = BlendingSpace(
        tuple(d["name"] for d in named),
        tuple(d["unit"] for d in named),
        tensors["vectors"],
        Scaling(np.array([d["offset"] for d in named], dtype=float), np.array([d["scale"] for d in named], dtype=float)),
        tensors["maps"],
        tensors["parents"],
        tensors["parent_weights"],
    )
    kernel = header["kernel"]
    return probabilistic_model(
        blending,
        space,
        GridInterpolant(space.shape, kernel["name"], float(kernel["epsilon"])),
        k=header["k"],
        weights=header["weights"],
        exponent=header["exponent"],
        fixed=header["fixed"],
        provenance=header["provenance"],
    )
