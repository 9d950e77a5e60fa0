"""Goals of ROS in `map` where giraff_places is there, by calling."""

from typing import Any

import msgspec
import pytest

from giraff_schemas.motion import MotionAnswer, MotionCancel, MotionGo
from giraff_schemas.places import NO_ROUTE, Goal, Places, PlacesGo
from giraff_schemas.topics import MOTION_GO, PLACES_CANCEL, PLACES_GO, PLACES_HOLD
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from tests.support.motion_double import motion_state
from tests.unit.ros2.test_asks import Rviz

ANOTHER_PLAN = Trouble("localization goes by another plan")


def give(rviz: Rviz, frame: str = "map", heard_before: float = 0.0, reason: Trouble = NO_TROUBLE) -> Any:
    """Return what a goal makes the service ask; `heard_before`: s since giraff_places was heard."""
    rviz.goals.on_sample(Places(map="home", places=(), no_go=(), reason=reason), rviz.now)
    rviz.run(heard_before)
    rviz.place("localized")
    rviz.give(4.0, 3.0, -1.0, frame)
    (request,) = rviz.run()
    return request


def route(rviz: Rviz, wish: int, **changes: Any) -> None:
    """Say how the route goes."""
    changes = {"stage": "moving"} | changes
    rviz.goals.on_sample(msgspec.structs.replace(NO_ROUTE, instance="places", id=wish, **changes), rviz.now)


def test_a_goal_in_map_is_a_route_and_its_legs_do_not_count() -> None:
    rviz = Rviz()
    request = give(rviz)
    assert isinstance(request, PlacesGo)
    assert isinstance(request.goal, Goal)
    assert (request.goal.x, request.goal.y) == (4.0, 3.0)
    assert request.goal.yaw == pytest.approx(-1.0)
    rviz.robot.asked[-1].answers.append(MotionAnswer(accepted=True))
    rviz.run()
    for leg in (1, 2):
        route(rviz, request.id, seq=leg)
        rviz.goals.on_sample(motion_state(request.id, "ended", "blocked", instance="motion"), rviz.now)
        rviz.goals.on_sample(motion_state(leg, instance="motion"), rviz.now)
        rviz.run(0.5)
    assert not rviz.goals.trouble
    assert rviz.robot.held_on == {PLACES_HOLD.key}
    route(rviz, request.id, seq=3, stage="ended", outcome="forbidden", reason=Trouble("each way crosses stairs"))
    rviz.run()
    assert not rviz.goals.is_active
    assert "not driven to: each way crosses stairs" in str(rviz.goals.trouble)


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"heard_before": 2.8}, PLACES_GO.key),
        ({"heard_before": 3.2}, MOTION_GO.key),
        ({"reason": ANOTHER_PLAN}, PLACES_GO.key),  # which says why it does not go
        ({"frame": "odom"}, MOTION_GO.key),
    ],
    ids=str,
)
def test_a_goal_goes_straight_where_places_are_silent_or_it_is_in_odom(given: dict[str, Any], key: str) -> None:
    rviz = Rviz()
    request = give(rviz, **given)
    assert rviz.robot.asked[-1].key == key
    if isinstance(request, MotionGo):  # a route that somebody else drives is not its own
        rviz.robot.asked[-1].answers.append(MotionAnswer(accepted=True))
        rviz.goals.on_sample(motion_state(request.id, instance="motion"), rviz.now)
        route(rviz, request.id + 1)
        rviz.run()
        assert rviz.goals.is_active


def test_a_stop_ends_a_route() -> None:
    rviz = Rviz()
    request = give(rviz)
    rviz.goals.cancel("a stop was asked for", rviz.now)
    assert rviz.robot.asked[-1].key == PLACES_CANCEL.key
    assert rviz.robot.asked[-1].request == MotionCancel(by="ros2@desk", id=request.id)
