import numpy as np
import pytest
from shapely import LineString, Point, box, union_all

from walklab.capture.paths import Habit, _shortest, habitual_path, move_ends, wander
from walklab.capture.timeline import scattered
from walklab.capture.walker import person_from_row
from walklab.errors import InputError
from walklab.geometry.curves import length
from walklab.geometry.scene import Scene
from walklab.randomness import generator

BODY_RADIUS_M = 0.25
HABIT = Habit(clearance_m=0.4, least_clearance_m=0.25, freedom_m=0.6, rounding_m=0.16)


def test_open_floor_is_crossed_straight():
    path = habitual_path(Scene("open"), (0.0, 0.0), (3.0, 1.0), HABIT)
    assert length(path) == pytest.approx(np.hypot(3, 1), abs=1e-9)


def test_route_round_a_box_is_the_shortest():
    blocked = box(1, -1, 2, 1)
    route = _shortest(blocked, (0.0, 0.0), (3.0, 0.0), "box")
    assert length(route) == pytest.approx(2 * np.hypot(1, 1) + 1, abs=1e-9)


def test_walled_in_is_reported():
    walls = Scene("cell", {"ring": Point(0, 0).buffer(3).difference(Point(0, 0).buffer(2))})
    with pytest.raises(InputError, match="no way"):
        habitual_path(walls, (0.0, 0.0), (5.0, 0.0), HABIT)


def test_everybody_keeps_clear_of_every_obstacle(training, plans, constants):
    people = [person_from_row(row, constants) for _, row in training.participants.iterrows()]
    for plan in plans.values():
        walks = plan.walks or tuple((f"start_{d}", f"end_{d}") for d in (3, 4))
        obstacles = union_all(list(plan.scene.obstacles.values()))
        for start, end in set(walks):
            for person in people[::5]:
                path = habitual_path(plan.scene, plan.stations[start].position_m, plan.stations[end].position_m, person.habit)
                assert LineString(path).distance(obstacles) > 0.22


def test_stations_lie_outside_what_a_planner_may_not_enter(plans, constants):
    reach = constants.place_reach_m
    for plan in plans.values():
        for station in plan.stations.values():
            room = min(obstacle.distance(Point(station.position_m)) for obstacle in plan.scene.obstacles.values())
            assert room - reach > BODY_RADIUS_M + 0.05


def test_turns_bend_for_the_planner_too(plans):
    """The barrier leaves no shorter way than the one round the pole."""
    for angle in (45, 90, 135, 180):
        plan = plans[f"turn_{angle}"]
        grown = union_all([obstacle.buffer(BODY_RADIUS_M, quad_segs=32) for obstacle in plan.scene.obstacles.values()])
        for distance in (3, 4):
            start, end = (plan.stations[f"{name}_{distance}"].position_m for name in ("start", "end"))
            route = _shortest(grown, start, end, plan.scene.name)
            first, last = np.diff(route, axis=0)[[0, -1]]
            turned = np.degrees(np.abs(np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)))
            assert len(route) > 2
            assert LineString(route).distance(Point(0, 0)) < 0.45
            assert 0.8 * distance < length(route) < 1.05 * distance
            assert turned > 0.5 * angle


@pytest.mark.parametrize("name", ["scenario_1", "scenario_2"])
def test_three_in_ten_walks_of_a_set_bend_round_something(plans, name):
    plan = plans[name]
    grown = union_all([obstacle.buffer(BODY_RADIUS_M) for obstacle in plan.scene.obstacles.values()])
    bends = [len(_shortest(grown, plan.stations[a].position_m, plan.stations[b].position_m, name)) > 2 for a, b in plan.walks]
    assert np.mean(bends) >= 0.3


def test_published_distances_of_the_scenarios(plans):
    def apart(plan, a, b):
        return np.hypot(*np.subtract(plan.stations[a].position_m, plan.stations[b].position_m))

    one, two = plans["scenario_1"], plans["scenario_2"]
    assert apart(one, "rack_3", "car") == pytest.approx(0.7, abs=0.01)
    assert apart(one, "rack_2", "car") == pytest.approx(2.2, abs=0.01)
    assert apart(one, "rack_1", "car") == pytest.approx(2.9, abs=0.01)
    directions = [np.arctan2(*one.stations[name].position_m[::-1]) for name in ("rack_1", "rack_2")]
    assert np.degrees(abs(directions[0] - directions[1])) == pytest.approx(90, abs=1)
    assert apart(two, "rack_1", "assembly_3") == pytest.approx(2.0, abs=0.01)
    assert apart(two, "rack_2", "assembly_3") == pytest.approx(2.4, abs=0.01)
    assert (len(one.walks), len(two.walks)) == (11, 6)


def test_moved_and_wandering_paths_hit_their_ends():
    path = np.column_stack([np.linspace(0, 2, 201), np.zeros(201)])
    moved = move_ends(path, np.array([0.1, 0.1]), np.array([2.0, -0.2]))
    np.testing.assert_allclose(moved[[0, -1]], [[0.1, 0.1], [2.0, -0.2]])
    strayed = wander(path, 0.02, 3, generator(5))
    np.testing.assert_allclose(strayed[[0, -1]], path[[0, -1]], atol=1e-12)
    assert 0 < np.abs(strayed[:, 1]).max() < 0.02 * 2 * 3 * 3


def test_scatter_stays_within_reach(constants):
    rng = generator(3)
    offsets = np.array([scattered(np.zeros(2), constants, rng) for _ in range(2000)])
    assert np.hypot(*offsets.T).max() <= constants.place_reach_m + 1e-12
    assert np.abs(offsets.mean(axis=0)).max() < 0.002
