"""Model files that are well-formed, but were tampered with: refused in one line, at once or by a check."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save_file

from walklab.errors import InputError
from walklab.steering.blending_space import blending_space
from walklab.steering.interpolation import interpolant_named
from walklab.steering.mapped_tensors import open_tensors
from walklab.steering.model_file import read_model
from walklab.steering.models import probabilistic_model
from walklab.steering.scaling import fit_scaling
from walklab.steering.space import space_from_config


def rewritten(model: Path, tensors: Callable[[dict], None] = dict, header: Callable[[dict], None] = dict) -> Path:
    """A copy of a saved model that is well-formed, but tampered with."""
    arrays, described = open_tensors(model)
    arrays = {name: values.copy() for name, values in arrays.items()}
    tensors(arrays)
    header(described)
    path = model.with_name("tampered.safetensors")
    save_file(arrays, path, {"walklab": json.dumps(described)})  # not with walklab's own writer, which refuses some of this
    return path


@pytest.fixture(scope="module")
def saved(tmp_path_factory) -> Path:
    """A small model of random maps; as it is, it is read, checked and drawn from."""
    rng = np.random.default_rng(4)
    space = space_from_config([{"name": name, "unit": "m/s", "start": 0.1, "step": 0.4, "count": 4} for name in ("v", "a")])
    vectors = rng.uniform(1.0, 3.0, (30, 2))
    blending = blending_space(("length", "height"), ("m", "m"), vectors, rng.random((30, 16)), fit_scaling(vectors))
    path = tmp_path_factory.mktemp("models") / "model.safetensors"
    probabilistic_model(blending, space, interpolant_named("rbf", space.shape), k=5, provenance={"run": "test"}).save(path)
    assert read_model(path).sample(length=2.0, height=2.0, rng=rng).shape == (1, 2)
    return path


def put(name: str, value: float, rows: slice | int = slice(None)) -> Callable[[dict], None]:
    return lambda arrays: arrays[name].__setitem__(rows, value)


ARRAYS = {
    "a parent that is not there": (put("parents", 10**6, 3), "parents"),
    "no parent": (put("parents", -1, 3), "parents"),
    "an infinite map": (put("maps", np.inf, 3), "maps"),
    "a map above 1": (put("maps", 7.0, 3), "maps"),
    "a negative map": (put("maps", -0.5, 3), "maps"),
    "a map of nothing": (put("maps", 0.0, 3), "maps, row 3"),
    "coefficients of nothing": (put("coefficients", 0.0, 3), "coefficients, row 3"),
    "bounds of nothing": (put("rungs", 0, 3), "rungs, row 3"),
    "weights below a whole": (put("parent_weights", -3.0, 3), "parent_weights"),
    "weights above a whole": (put("parent_weights", 9.0, 3), "parent_weights"),
    "a dependency far beyond any walk": (put("vectors", 1e300, 3), "vectors"),
    "a dependency that is no number": (put("vectors", np.nan, 3), "vectors"),
    "a domain that is no number": (put("domain_equations", np.nan), "domain_equations"),
    "maps of another type": (lambda arrays: arrays.update(maps=arrays["maps"].astype(np.int64)), "maps"),
    "bounds of another type": (lambda arrays: arrays.update(rungs=arrays["rungs"].astype(float)), "rungs"),
    "maps of another size": (lambda arrays: arrays.update(maps=arrays["maps"][:, :-1].copy()), "maps"),
    "an array that is missing": (lambda arrays: arrays.pop("parents"), "parents"),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_that_were_tampered_with_are_found_by_a_check(name, saved):
    tamper, told = ARRAYS[name]
    path = rewritten(saved, tensors=tamper)
    with pytest.raises(InputError, match=rf"tampered\.safetensors: .*{told}"):
        read_model(path)


@pytest.mark.parametrize(
    ("name", "value"), [("coefficients", 0.0), ("coefficients", 200.0), ("coefficients", np.nan), ("rungs", 0)]
)
def test_arrays_that_were_tampered_with_are_one_line_when_drawn_from(name, value, saved):
    model = read_model(rewritten(saved, tensors=put(name, value)), check_all=False)
    with pytest.raises(InputError, match=r"tampered\.safetensors: the interpolated map is"):
        model.sample(length=2.0, height=2.0, size=100, rng=np.random.default_rng(1))


HEADERS = {
    "a later version": ({"version": 9}, "of version 9, .*update walklab"),
    "a version that is no number": ({"version": "2; rm"}, "not a walklab motion model"),
    "an earlier version": ({"version": 1}, "walklab migrate"),
    "a scale of 0": (
        {"dependencies": [{"name": n, "unit": "m", "offset": 0, "scale": 0} for n in ("length", "height")]},
        "scale",
    ),
    "an offset that is no number": (
        {"dependencies": [{"name": n, "unit": "m", "offset": float("nan"), "scale": 1} for n in ("length", "height")]},
        "offset",
    ),
    "an offset whose distances overflow": (
        {"dependencies": [{"name": n, "unit": "m", "offset": 1e308, "scale": 1e-308} for n in ("length", "height")]},
        "offset",
    ),
    "a dependency twice": ({"dependencies": [{"name": "length", "unit": "m", "offset": 0, "scale": 1}] * 2}, "twice"),
    "names that are no text": ({"dependencies": [{"name": n, "unit": "m", "offset": 0, "scale": 1} for n in (5, 6)]}, "no text"),
    "a unit of bounds that overflows": ({"rung": 1e300}, "rung"),
    "no axes": ({"axes": []}, "inconsistent"),
    "axes that are no mapping": ({"axes": ["v", "a"]}, "inconsistent"),
    "a unit of bounds of 0": ({"rung": 0.0}, "rung"),
    "more neighbours than maps": ({"k": 10**9}, "model.k"),
    "neighbours that are no number": ({"k": "all"}, "k is no whole number"),
    "a sharpness below 0": ({"exponent": -1.0}, "exponent"),
    "a kernel without width": ({"basis": {"name": "rbf", "kernel": "multiquadric", "epsilon": float("inf")}}, "epsilon"),
    "held parameters as a list": ({"fixed": ["v"]}, "fixed"),
    "a command to the terminal": ({"provenance": {"run": "\x1b[2Jgone"}}, "control characters"),
    "a command in a name": ({"provenance": {"run\x1b]0;title\x07": 1}}, "control characters"),
}


@pytest.mark.parametrize("name", HEADERS)
def test_a_header_that_was_tampered_with_is_refused_at_once(name, saved):
    changed, told = HEADERS[name]
    path = rewritten(saved, header=lambda header: header.update(changed))
    with pytest.raises(InputError, match=rf"tampered\.safetensors: .*{told}") as caught:
        read_model(path, check_all=False)
    assert str(caught.value).isprintable()
