from pathlib import Path

import pytest

from walklab.errors import InputError
from walklab.geometry.plans import load_plan

SCENES = Path(__file__).parents[3] / "config" / "scenes"

GOOD = """
name: hall
obstacles:
  car: {box: [0, 0, 2, 1]}
stations:
  a: {position_m: [-1, 0], facing_deg: 0, work_height_m: 0.6}
  b: {position_m: [3, 0]}
walks: [[a, b], [b, a]]
"""


def load(text: str, folder: Path):
    path = folder / "hall.yaml"
    path.write_text(text)
    return load_plan(path)


def test_a_plan_is_read_whole(tmp_path):
    plan = load(GOOD, tmp_path)
    assert plan.scene.name == "hall"
    assert plan.scene.obstacles["car"].area == pytest.approx(2.0)
    assert plan.stations["a"].work_height_m == 0.6
    assert plan.stations["b"].work_height_m is None
    assert plan.walks == (("a", "b"), ("b", "a"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("walks: [[a, b], [b, a]]", "walks: [[a, c]]", "no station 'c'"),
        ("name: hall", "title: hall", "unknown keys"),
        ("box: [0, 0, 2, 1]", "box: [0, 0, 2, 0]", "no area"),
        ("box: [0, 0, 2, 1]", "polygon: [[0, 0], [1, 1], [1, 0], [0, 1]]", "crosses itself"),
        ("box: [0, 0, 2, 1]", "cube: [0, 0, 2, 1]", "box, polygon or circle"),
        ("position_m: [3, 0]", "position_m: [3]", "not described"),
        ("position_m: [3, 0]", "place: [3, 0]", "not described"),
        ("stations:", "stations: [", "not valid YAML"),
        ("  car: {box: [0, 0, 2, 1]}", "  [1, 2]", r"obstacles: give each a name.*, not \[1, 2\]"),
        ("box: [0, 0, 2, 1]", "box: [0, 0, 2]", "obstacle car: box .* is not as docs/second-scene.md says"),
        ("box: [0, 0, 2, 1]", "box: [0, 0, 2, .inf]", "obstacle car: .*no area"),
        ("box: [0, 0, 2, 1]", "polygon: [1, 2, 3]", "obstacle car: polygon .* is not as docs/second-scene.md says"),
        ("box: [0, 0, 2, 1]", "circle: {centre: [0, 0], radius: -1}", "give a radius above 0 m"),
        ("box: [0, 0, 2, 1]", "circle: {radius: 1}", "'centre'"),
        ("box: [0, 0, 2, 1]", "1: 2", "needs one of box, polygon or circle"),
        ("{box: [0, 0, 2, 1]}", "3", "obstacle car: needs one of box, polygon or circle, has 3"),
        ("position_m: [3, 0]", "position_m: [.nan, 0]", "station b: every number must be finite"),
        ("b: {position_m: [3, 0]}", "b: 7", "station b: not described"),
        ("walks: [[a, b], [b, a]]", "walks: [a, b]", "'a' is no pair of stations"),
    ],
)
def test_mistakes_end_in_one_line_that_names_the_file(tmp_path, old, new, message):
    assert old in GOOD
    with pytest.raises(InputError, match=message) as caught:
        load(GOOD.replace(old, new), tmp_path)
    assert "hall.yaml" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("text", "message"), [("", "hall.yaml: is empty; a plan view"), ("- 1", r"hall.yaml: holds \[1\];")])
def test_a_file_that_describes_no_plan_is_told_so(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        load(text, tmp_path)


def test_a_missing_plan_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nowhere\.yaml"):
        load_plan(tmp_path / "nowhere.yaml")


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_plan_of_the_project_loads_under_its_own_name(path):
    plan = load_plan(path)
    assert plan.scene.name == path.stem
    assert plan.scene.obstacles
    assert plan.stations
