"""Planners by name, and walks they refuse."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

from walklab.errors import InputError
from walklab.geometry.scene import State, Task
from walklab.planning import registry
from walklab.planning.path_following import PathFollowing
from walklab.planning.protocol import Planner, SweepingPlanner
from walklab.planning.registry import make_planner, require_start_supported
from walklab.planning.social_force import SocialForce

STEP_S = 1 / 60


def test_options_reach_the_planner() -> None:
    planner = make_planner(
        "path_following", ["a", "v"], 0.02, {"cell_m": 0.05, "snap_m": 0.2, "fixed": {"omega": 1.1}, "braking": False}
    )
    assert isinstance(planner, PathFollowing)
    assert isinstance(planner, SweepingPlanner)
    assert (planner.parameters, planner.step_s, planner.braking, planner.fixed) == (("a", "v"), 0.02, False, {"omega": 1.1})
    assert (planner.finder.cell_m, planner.finder.snap_m) == (0.05, 0.2)


def test_social_force_is_a_planner_that_does_not_sweep() -> None:
    planner = make_planner("social_force", ["v", "tau"], STEP_S)
    assert isinstance(planner, Planner)
    assert not isinstance(planner, SweepingPlanner)


def test_planners_of_other_packages_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    offered = EntryPoint("relaxing", "walklab.planning.social_force:SocialForce", registry.ENTRY_POINTS)
    factory = EntryPoint("other", f"{__name__}:other_planner", registry.ENTRY_POINTS)
    monkeypatch.setattr(registry, "entry_points", lambda group: [offered, factory] if group == "walklab.planners" else [])
    planner = make_planner("other", ["tau", "v"], STEP_S, {"look_ahead_m": 0.5})
    assert isinstance(planner, SocialForce)
    assert (planner.parameters, planner.look_ahead_m) == (("tau", "v"), 0.5)
    with pytest.raises(InputError, match="known are other, path_following, relaxing, social_force"):
        make_planner("nobody", ["v"], STEP_S)


def other_planner(parameters, step_s, options):
    return SocialForce(parameters=parameters, step_s=step_s, **options)


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (("walking", ["v"], STEP_S, {}), "unknown name 'walking'"),
        (("path_following", ["v", "a", "speed"], STEP_S, {}), "unknown parameter 'speed'"),
        (("social_force", ["v", "a"], STEP_S, {}), "unknown parameter 'a'"),
        (("social_force", ["v"], STEP_S, {}), "no value for tau"),
        (("path_following", ["v", "a"], STEP_S, {"lookahead": 1}), "unknown option 'lookahead'"),
        (("social_force", ["v", "tau"], STEP_S, {"braking": True}), "unknown option 'braking'"),
        (("path_following", ["v", "a"], STEP_S, {"cell_m": 0}), "cell_m 0.0 must be above 0"),
        (("path_following", ["v", "a"], STEP_S, {"fixed": {"tau": 1.0}}), "unknown parameter 'tau'"),
    ],
)
def test_what_is_unknown_is_named(args: tuple, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make_planner(*args)


def test_a_moving_start_under_a_standing_planner_is_refused() -> None:
    standing, moving = SocialForce(), PathFollowing()
    rest = Task(State((0, 0)), State((1, 0)))
    walking_start = Task(State((0, 0), None, 1.2), State((1, 0)))
    walking_end = Task(State((0, 0)), State((1, 0), None, 0.4))
    require_start_supported(standing, rest, "a/b")
    for task in (rest, walking_start, walking_end):
        require_start_supported(moving, task, "a/b")
    with pytest.raises(InputError, match=r"walk cmu/02/1: starts at 1\.20 m/s.*SocialForce only starts and ends standing"):
        require_start_supported(standing, walking_start, "cmu/02/1")
    with pytest.raises(InputError, match=r"ends at 0\.40 m/s"):
        require_start_supported(standing, walking_end, "cmu/02/1")
