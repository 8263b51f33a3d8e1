"""A model file of version 1 becomes one of the present version that behaves the same."""

import json

import numpy as np
import pytest

from walklab.errors import InputError
from walklab.steering.mapped_tensors import open_tensors
from walklab.steering.model_file import FORMAT, VERSION, read_model, write_model
from walklab.steering.model_migration import migrate_model
from walklab.storage import write_tensors


def as_version_1(model, path):
    """The model as version 1 stored it."""
    write_model(model, path)
    tensors, header = open_tensors(path)
    tensors = {name: np.array(values) for name, values in tensors.items() if name != "rungs"}
    tensors["bounds"] = np.ones((len(model.blending), model.rungs.shape[1]))
    basis = header.pop("basis")
    header |= {"version": 1, "kernel": {"name": basis["kernel"], "epsilon": basis["epsilon"]}}
    del header["rung"]
    write_tensors(tensors, header, path)
    return path


def test_a_migrated_model_draws_what_the_model_draws(model, tmp_path):
    old = as_version_1(model, tmp_path / "old.safetensors")
    with pytest.raises(InputError, match="of version"):
        read_model(old)
    assert migrate_model(old, tmp_path / "new.safetensors") == 1
    migrated = read_model(tmp_path / "new.safetensors")
    vector = model.blending.vectors[3]
    given = dict(zip(model.dependencies, vector, strict=True))
    draws = [one.sample(size=50, rng=np.random.default_rng(5), **given) for one in (model, migrated)]
    np.testing.assert_array_equal(*draws)


@pytest.mark.parametrize(
    ("header", "reason"),
    [
        ({"format": FORMAT, "version": VERSION}, "nothing to migrate"),
        ({"format": FORMAT, "version": 99}, "of version 99, .*update walklab"),
        ({"format": "other"}, "not a walklab motion model"),
        ({"format": FORMAT, "version": 1}, "incomplete or inconsistent"),
    ],
)
def test_what_cannot_be_migrated_is_told(tmp_path, header, reason):
    path = tmp_path / "model.safetensors"
    write_tensors({"vectors": np.zeros((2, 1))}, json.loads(json.dumps(header)), path)
    with pytest.raises(InputError, match=reason):
        migrate_model(path, tmp_path / "new.safetensors")
    assert not (tmp_path / "new.safetensors").exists()
