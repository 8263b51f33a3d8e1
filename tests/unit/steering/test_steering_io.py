import dataclasses
import json

import numpy as np
import pytest

from walklab.errors import InputError
from walklab.steering.io import (
    SuitabilityMaps,
    concatenate_maps,
    read_blending_space,
    read_maps,
    read_model,
    read_static_fit,
    write_blending_space,
    write_maps,
    write_model,
    write_static_fit,
)
from walklab.steering.static_fit import StaticFit
from walklab.storage import read_tensors, write_tensors

FIT = StaticFit(("v", "a"), (0.94, 1.58), 0.3, (0.95, 1.5), 0.31, ("a",), (0.3,), (0.3,), (0.0, 0.01), 1000)


@pytest.fixture(scope="module")
def maps(world):
    vectors = world.vectors.rename(columns={"length": "planned_length"}).assign(captured_length=world.vectors["length"] + 0.1)
    names = tuple(f"training/P{i:02d}" for i in range(80))
    units = {"planned_length": "m", "captured_length": "m", "height": "m"}
    return SuitabilityMaps(names, tuple(world.participants), world.scores, world.space, "euclid", "s", vectors, units)


def same_maps(first, second):
    return (
        (first.walks, first.participants, first.space, first.metric)
        == (second.walks, second.participants, second.space, second.metric)
        and np.array_equal(first.scores, second.scores)
        and sorted(first.vectors) == sorted(second.vectors)
        and all(np.array_equal(first.vectors[name], second.vectors[name]) for name in first.vectors)
    )


def test_maps_come_back_as_they_were(maps, tmp_path):
    write_maps(maps, tmp_path / "maps.nc")
    assert same_maps(read_maps(tmp_path / "maps.nc"), maps)


def test_maps_are_labelled(maps, tmp_path):
    import xarray as xr

    write_maps(maps, tmp_path / "maps.nc")
    score = xr.load_dataset(tmp_path / "maps.nc", engine="h5netcdf")["score"]
    assert score.dims == ("walk", "v", "a")
    assert score["v"].attrs["units"] == "m/s"
    assert score.sel(walk="training/P03", v=0.7, a=2.0, method=None) == maps.scores[3].reshape(maps.space.shape)[2, 3]


def test_shards_join_to_the_whole(maps, tmp_path):
    for index, rows in enumerate((slice(0, 30), slice(30, 80))):
        part = dataclasses.replace(
            maps,
            walks=maps.walks[rows],
            participants=maps.participants[rows],
            scores=maps.scores[rows],
            vectors=maps.vectors[rows].reset_index(drop=True),
        )
        write_maps(part, tmp_path / f"{index}.nc")
    parts = [read_maps(tmp_path / f"{index}.nc") for index in (0, 1)]
    assert same_maps(concatenate_maps(parts), maps)
    with pytest.raises(InputError, match="shards differ"):
        concatenate_maps([parts[0], dataclasses.replace(parts[1], metric="frechet")])


def test_blending_space_comes_back_as_it_was(model, tmp_path):
    write_blending_space(model.blending, model.space, tmp_path / "dbs.nc")
    blending, space = read_blending_space(tmp_path / "dbs.nc")
    assert space == model.space
    assert (blending.names, blending.units) == (model.blending.names, model.blending.units)
    for name in ("vectors", "maps", "parents", "parent_weights", "is_blend"):
        assert np.array_equal(getattr(blending, name), getattr(model.blending, name))
    assert np.array_equal(blending.nearest([[2.0, 1.7]], 9)[0], model.blending.nearest([[2.0, 1.7]], 9)[0])


def test_a_model_without_dependencies_can_be_stored(world, tmp_path):
    from walklab.steering.training import TrainingSettings, train

    none = train(
        world.scores,
        world.vectors[[]],
        world.participants,
        world.space,
        TrainingSettings(count=None, k=5),
        np.random.default_rng(0),
    )
    write_model(none, tmp_path / "m.safetensors")
    write_blending_space(none.blending, none.space, tmp_path / "dbs.nc")
    assert np.array_equal(read_model(tmp_path / "m.safetensors").mode(np.zeros((1, 0))), none.mode(np.zeros((1, 0))))
    assert read_blending_space(tmp_path / "dbs.nc")[0].names == ()


def test_a_model_behaves_the_same_after_reading(model, tmp_path):
    variant = dataclasses.replace(model, fixed={"a": 0.7}, exponent=7.5, weights="inverse", k=12)
    for written in (model, variant):
        write_model(written, tmp_path / "m.safetensors")
        read = read_model(tmp_path / "m.safetensors")
        asked = np.array([[1.2, 1.7], [5.0, 1.7]])
        assert (read.names, read.dependencies, read.dependency_units) == (
            written.names,
            written.dependencies,
            written.dependency_units,
        )
        assert (read.k, read.weights, read.exponent, read.fixed) == (written.k, written.weights, written.exponent, written.fixed)
        assert read.provenance == {"run": "test"}
        assert np.array_equal(read.mode(asked), written.mode(asked))
        assert np.array_equal(
            read.sample(asked[0], 50, np.random.default_rng(0)), written.sample(asked[0], 50, np.random.default_rng(0))
        )
        assert np.array_equal(read.inside(asked), [True, False])


def test_the_static_fit_comes_back_as_it_was(tmp_path):
    write_static_fit(FIT, tmp_path / "fit.json")
    assert read_static_fit(tmp_path / "fit.json") == FIT


def test_same_content_same_bytes(model, maps, tmp_path):
    for name, write in {
        "maps.nc": lambda path: write_maps(maps, path),
        "dbs.nc": lambda path: write_blending_space(model.blending, model.space, path),
        "m.safetensors": lambda path: write_model(model, path),
        "fit.json": lambda path: write_static_fit(FIT, path),
    }.items():
        for folder in ("first", "second"):
            write(tmp_path / folder / name)
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes(), name


READERS = {"maps.nc": read_maps, "dbs.nc": read_blending_space, "m.safetensors": read_model, "fit.json": read_static_fit}


@pytest.mark.parametrize("name", READERS)
def test_a_broken_file_is_named_in_one_line(name, model, maps, tmp_path):
    path = tmp_path / name
    writers = {
        "maps.nc": lambda: write_maps(maps, path),
        "dbs.nc": lambda: write_blending_space(model.blending, model.space, path),
        "m.safetensors": lambda: write_model(model, path),
        "fit.json": lambda: write_static_fit(FIT, path),
    }
    writers[name]()
    whole = path.read_bytes()
    for damaged in (whole[: len(whole) // 2], b"", b"something else entirely"):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=name) as caught:
            READERS[name](path)
        assert "\n" not in str(caught.value)
    path.unlink()
    with pytest.raises(InputError, match=name):
        READERS[name](path)


def test_a_file_of_another_kind_is_refused(model, maps, tmp_path):
    write_maps(maps, tmp_path / "maps.nc")
    write_blending_space(model.blending, model.space, tmp_path / "dbs.nc")
    with pytest.raises(InputError, match="not a file of suitability maps"):
        read_maps(tmp_path / "dbs.nc")
    with pytest.raises(InputError, match="not a blending space"):
        read_blending_space(tmp_path / "maps.nc")
    (tmp_path / "fit.json").write_text(json.dumps({"format": "walklab static fit", "version": 1, "mean": 3}))
    with pytest.raises(InputError, match="not a static fit"):
        read_static_fit(tmp_path / "fit.json")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t, h: h.update(version=99), "version 99, .* up to 2; update walklab"),
        (lambda t, h: h.update(format="another"), "not a walklab motion model"),
        (lambda t, h: h.pop("basis"), "basis"),
        (lambda t, h: h.update(k=10_000), "model.k = 10000"),
        (lambda t, h: h["axes"].pop(), "shape"),
        (lambda t, h: t.pop("rungs"), "rungs"),
        (lambda t, h: t.update(maps=t["maps"][:, :-1]), "tensor maps"),
        (lambda t, h: t["coefficients"].__setitem__((0, 0), np.nan), "not finite"),
    ],
)
def test_a_model_whose_parts_do_not_fit_is_refused(model, tmp_path, change, words):
    path = tmp_path / "m.safetensors"
    write_model(model, path)
    tensors, header = read_tensors(path)
    change(tensors, header)
    write_tensors(tensors, header, path)
    with pytest.raises(InputError, match=words) as caught:
        read_model(path)
    assert "m.safetensors" in str(caught.value)
    assert "\n" not in str(caught.value)
