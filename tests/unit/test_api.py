"""The public interface: what other programs import, what it costs them, and what it says."""

import json
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from shapely import Point, box

import walklab
from walklab import (
    Body,
    InputError,
    OutsideTrainingRange,
    ProbabilisticModel,
    Scene,
    State,
    Task,
    simulate,
    simulate_draws,
    travel_time_quantiles,
)
from walklab.planning.protocol import Arrival, Trajectory
from walklab.steering.blending_space import blending_space
from walklab.steering.interpolation import interpolant_named
from walklab.steering.mapped_tensors import open_tensors
from walklab.steering.models import probabilistic_model
from walklab.steering.scaling import fit_scaling
from walklab.steering.space import space_from_config

ROOT = Path(__file__).parents[2]
INSIDE = {"length": 2.5, "curvature": 0.3, "height": 1.78}


def smooth_model(basis="rbf", entries=300, cells=6, **settings):
    rng = np.random.default_rng(0)
    vectors = np.column_stack([rng.uniform(0.5, 4, entries), rng.uniform(0, 1, entries), rng.uniform(1.6, 1.95, entries)])
    axis = {"start": 0.2, "step": 1.8 / (cells - 1), "count": cells}
    space = space_from_config([{"name": n, "unit": u, **axis} for n, u in (("v", "m/s"), ("a", "m/s2"), ("omega", "1/m"))])
    peak = np.column_stack([0.5 + 0.25 * vectors[:, 0], 0.8 + 0.2 * vectors[:, 0], 1 + 0.5 * vectors[:, 1]])
    gaps = np.linalg.norm(space.cells[None] - peak[:, None], axis=2)
    maps = 1 - gaps / gaps.max(axis=1, keepdims=True)
    blending = blending_space(tuple(INSIDE), ("m", "1/m", "m"), vectors, maps, fit_scaling(vectors))
    return probabilistic_model(blending, space, interpolant_named(basis, space.shape), k=40, **settings)


@pytest.fixture(scope="module", params=["rbf", "multilinear"])
def model(request):
    return smooth_model(request.param)


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "model.safetensors"
    smooth_model("rbf", 5000, 10).save(path)
    return path


def test_every_public_name_is_there():
    for name in walklab._HOMES:
        assert getattr(walklab, name).__name__ == name
        assert name in dir(walklab)
    stub = (ROOT / "src/walklab/__init__.pyi").read_text()
    assert sorted(line.split(" as ")[1] for line in stub.splitlines()) == sorted(walklab._HOMES)
    with pytest.raises(AttributeError, match="nonsense"):
        walklab.nonsense  # noqa: B018


def test_dependencies_by_name_or_as_a_vector(model):
    named = model.sample(**INSIDE, size=5, rng=np.random.default_rng(3))
    assert named.shape == (5, 3)
    assert np.array_equal(named, model.sample(list(INSIDE.values()), 5, np.random.default_rng(3)))
    assert model.sample(**INSIDE).shape == (1, 3)
    with pytest.raises(InputError, match=r"height \(m\) is missing"):
        model.sample(length=2.5, curvature=0.3)
    with pytest.raises(InputError, match="no dependency 'weight'"):
        model.sample(**INSIDE, weight=70)
    with pytest.raises(InputError, match="not both"):
        model.sample([2.5, 0.3, 1.78], length=2.5)
    with pytest.raises(InputError, match="curvature is nan"):
        model.sample(length=2.5, curvature=np.nan, height=1.78)
    with pytest.raises(InputError, match="sample_batch"):
        model.sample([[2.5, 0.3, 1.78]] * 2)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"size": -1}, r"size = -1: give how many to draw"),
        ({"size": 2.5}, r"size = 2\.5: give how many to draw"),
        ({"size": True}, "size = True"),
        ({"rng": 3}, "rng = 3: give a numpy generator"),
        ({"length": "a"}, "dependencies length, curvature, height: .* is not all numbers"),
        ({"length": [1, 2]}, "is not all numbers"),
        ({"length": -2.5}, r"length is -2\.5; it cannot be below 0"),
        ({"height": -1.78}, r"height is -1\.78; it cannot be below 0"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_one_line(model, asked, message):
    with pytest.raises(InputError, match=message) as caught:
        model.sample(**{**INSIDE, **asked})
    assert "\n" not in str(caught.value)


def test_what_cannot_be_below_zero_is_what_the_study_knows():
    from walklab.steering.arguments import NON_NEGATIVE
    from walklab.steering.dependencies import DEPENDENCIES

    assert [name for name, one in DEPENDENCIES.items() if one.minimum == 0.0] == list(NON_NEGATIVE)


def test_batches_refuse_what_single_draws_refuse(model):
    for settings, message in (({"size": -1}, "size = -1"), ({"rng": 3}, "rng = 3")):
        with pytest.raises(InputError, match=message):
            model.sample_batch([list(INSIDE.values())], **settings)
    with pytest.raises(InputError, match="is not all numbers"):
        model.sample_batch([["a", 0.3, 1.78]])


def test_a_sample_outside_the_training_range_says_so_once(model):
    with pytest.warns(OutsideTrainingRange, match=r"length 9 m \(trained 0\.5\d* to [34]\.\d*\)") as told:
        model.sample(length=9.0, curvature=0.3, height=1.78, size=50)
    assert len(told) == 1
    assert told[0].filename == __file__
    with pytest.warns(OutsideTrainingRange, match="2 of 3 walks") as told:
        model.sample_batch([[2.5, 0.3, 1.78], [9, 0.3, 1.78], [2.5, 0.3, 2.4]])
    assert len(told) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model.sample(**INSIDE)
        model.parameters([[9, 0.3, 1.78]], [np.random.default_rng(0)])  # trials keep their own record of it


def test_marginals_integrate_to_one_and_agree(model):
    vector = model.vector(**INSIDE)
    pair = model.marginal(vector, "v", "omega")
    assert (pair.density * np.outer(*pair.widths)).sum() == pytest.approx(1)
    for position, name in enumerate(("v", "omega")):
        single = model.marginal(vector, name)
        assert (single.density * single.widths[0]).sum() == pytest.approx(1)
        assert (pair.density * pair.widths[1 - position].reshape((1, -1) if position == 0 else (-1, 1))).sum(
            1 - position
        ) == pytest.approx(single.density)
    assert model.marginal(vector, "omega", "v").density == pytest.approx(pair.density.T)
    with pytest.raises(InputError, match="one or two of the free parameters"):
        model.marginal(vector, "v", "v")


def test_a_saved_model_draws_the_same(model, tmp_path):
    path = tmp_path / "model.safetensors"
    model.save(path)
    loaded = ProbabilisticModel.load(path)
    asked = model.blending.vectors[:20]
    first, second = (m.sample_batch(asked, 3, np.random.default_rng(0)) for m in (model, loaded))
    assert np.array_equal(first, second)
    assert np.array_equal(model.mode(asked[:3]), loaded.mode(asked[:3]))


def test_a_mapped_file_is_read_as_safetensors_reads_it_and_never_written(tmp_path, saved):
    from walklab.storage import read_tensors

    mine, header = open_tensors(saved)
    theirs, other = read_tensors(saved)
    assert header == other
    assert sorted(mine) == sorted(theirs)
    for name in mine:
        assert mine[name].dtype == theirs[name].dtype
        assert mine[name].flags.aligned
        assert np.array_equal(mine[name], theirs[name])
    before = saved.read_bytes()
    mine["vectors"][0] = -1
    assert saved.read_bytes() == before


@pytest.mark.parametrize(
    "entry",
    [
        {"dtype": "F64", "shape": [2], "data_offsets": [0, 8]},
        {"dtype": "F64", "shape": [-1], "data_offsets": [8, 0]},
        {"dtype": "F64", "shape": [10**12], "data_offsets": [0, 8 * 10**12]},
        {"dtype": "O", "shape": [1], "data_offsets": [0, 8]},
        {"shape": [1]},
        [],
    ],
)
def test_a_header_that_lies_is_refused(tmp_path, entry):
    header = json.dumps({"__metadata__": {"walklab": "{}"}, "maps": entry}).encode()
    path = tmp_path / "m.safetensors"
    path.write_bytes(len(header).to_bytes(8, "little") + header + bytes(16))
    with pytest.raises(InputError, match=r"m\.safetensors: not a walklab model file"):
        open_tensors(path)


HALL = Scene("hall", {"machine": box(1.5, -1.0, 2.0, 0.6)})
WALK = Task(State((0.0, 0.0)), State((3.0, 0.0)))


def test_simulating_with_given_parameters():
    walk = simulate(HALL, WALK, [1.2, 1.0, 3.0])
    assert isinstance(walk, Trajectory)
    assert walk.arrival == Arrival.ARRIVED
    slow, fast = simulate(HALL, WALK, np.array([[0.6, 1.0, 3.0], [1.5, 1.0, 3.0]]))
    assert slow.duration_s > fast.duration_s
    with pytest.raises(InputError, match="v, a, omega"):
        simulate(HALL, WALK, [1.2, 1.0])


def test_travel_times_of_drawn_walks(model):
    walks = simulate_draws(model, HALL, WALK, 60, np.random.default_rng(0), height=1.78)
    assert walks.vector[0] == pytest.approx(3.5, abs=0.2)  # the route goes round the machine
    assert walks.vector[2] == 1.78
    assert walks.inside
    table = walks.table()
    assert list(table) == ["draw", "v", "a", "omega", "travel_time_s", "arrival", "collided"]
    low, middle, high = walks.quantiles((0.05, 0.5, 0.95))
    assert low < middle < high
    assert (table["travel_time_s"] <= middle).mean() == pytest.approx(0.5, abs=0.02)
    again = travel_time_quantiles(model, HALL, WALK, (0.05, 0.5, 0.95), 60, np.random.default_rng(0), height=1.78)
    assert np.array_equal(again, [low, middle, high])
    hurried = simulate_draws(model, HALL, WALK, 60, np.random.default_rng(0), height=1.78, time_limit_s=2.0)
    assert np.isinf(hurried.quantiles((0.9,)))
    with pytest.raises(InputError, match="height"):
        simulate_draws(model, HALL, WALK, 2)


def test_walks_that_miss_the_end_or_go_through_an_obstacle_are_told(model):
    # So thin a body passes close by the machine, and whoever turns slowly goes through it.
    walks = simulate_draws(model, HALL, WALK, 60, np.random.default_rng(0), height=1.78, body=Body(0.02))
    table = walks.table()
    assert np.array_equal(walks.missed, table["arrival"] == "passed")
    machine = HALL.obstacles["machine"]
    inside = [any(machine.contains(Point(at)) for at in walk.positions_m) for walk in walks.trajectories]
    # Between two samples a corner may be cut without a sample inside.
    assert walks.collided.sum() >= sum(inside) > 0
    assert not any(deep and not told for deep, told in zip(inside, walks.collided, strict=True))
    straight = simulate_draws(model, Scene("open"), WALK, 5, np.random.default_rng(0), height=1.78)
    assert not straight.collided.any()
    assert not straight.missed.any()


@pytest.mark.parametrize("limit_s", [-1.0, 0.0, np.nan, np.inf])
def test_a_time_limit_that_is_none_is_refused(model, limit_s):
    with pytest.raises(InputError, match=r"time_limit_s = .*: give a number of seconds above 0"):
        simulate(HALL, WALK, [1.2, 1.0, 3.0], time_limit_s=limit_s)
    with pytest.raises(InputError, match="time_limit_s"):
        simulate_draws(model, HALL, WALK, 2, height=1.78, time_limit_s=limit_s)


HEAVY = ("xarray", "pandas", "sklearn", "pandera", "matplotlib", "snakemake", "shapely", "safetensors", "seaborn", "h5py")
SAMPLER = r"""
import pathlib, re, sys
import numpy as np
from walklab import ProbabilisticModel
model = ProbabilisticModel.load(sys.argv[1])
rng = np.random.default_rng(0)
model.sample(length=2.5, curvature=0.3, height=1.78, size=100, rng=rng)
model.parameters(model.blending.vectors[::10], [rng] * len(model.blending.vectors[::10]))
# Not ru_maxrss, which a child inherits from the process that starts it.
peak_mb = int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path("/proc/self/status").read_text())[1]) / 1024
print([name for name in sys.argv[2:] if name in sys.modules], peak_mb)
"""


def test_a_process_that_only_samples_stays_small(saved):
    """Imports little and stays below 200 MB once the kernels are compiled (compiling them, once, takes about 90 MB more)."""
    command = [sys.executable, "-c", SAMPLER, str(saved), *HEAVY]
    subprocess.run(command, check=True, capture_output=True)  # fills the cache of compiled kernels
    loaded, peak_mb = subprocess.run(command, check=True, capture_output=True, text=True).stdout.rsplit(" ", 1)
    assert loaded == "[]"
    assert float(peak_mb) <= 200


def test_importing_the_interface_loads_no_more_than_sampling_needs():
    """Of what is loaded, the package can leave out all but numpy and numba, which take most of the time."""
    code = "import sys; from walklab import ProbabilisticModel, Scene; print([m for m in sys.argv[1:] if m in sys.modules])"
    never = (*HEAVY, "statsmodels", "pingouin", "typer", "scipy.stats", "scipy.spatial", "scipy.ndimage", "scipy.optimize")
    assert subprocess.run([sys.executable, "-c", code, *never], capture_output=True, check=True).stdout == b"[]\n"
