"""Routes that are driven: what is asked of motion and when, and how each route ends."""

import math
from collections.abc import Callable
from typing import Final

import msgspec
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan, Wall
from giraff_maps.places_file import KnownPlaces
from giraff_places.driving.things import KEPT, Things
from giraff_places.driving.trip import CAREFUL, TRIES, WAITS
from giraff_places.route.floor import Floor
from giraff_schemas.messages import Range
from giraff_schemas.motion import GoTo, MotionCancel, MotionHold, Outcome, Turn
from giraff_schemas.places import Goal, NoGoLine, Place
from giraff_schemas.trouble import Trouble
from tests.support.robots import ROBOT
from tests.unit.places.homes import walls_of
from tests.unit.places.trips import FAR, MINE, NEAR, OUTER, START, STEP, End, Ride

KITCHEN: Final = Place(name="kitchen", x=1.0, y=3.0, yaw=0.0)
TURNED: Final = Goal(x=KITCHEN.x, y=KITCHEN.y, yaw=KITCHEN.yaw)
"""Ends with a turn."""


def test_motions_are_asked_leg_by_leg_and_it_has_arrived_when_localization_says_so() -> None:
    ride = Ride()
    ride.begin(msgspec.structs.replace(FAR, yaw=1.0))
    ride.until(lambda: bool(ride.asked))
    corners = ride.route.corners[1:]
    route = ride.end()
    assert (route.outcome, route.reason, route.at) == ("arrived", Trouble(), (5.0, 1.0))
    *legs, turn = [asked.step for asked in ride.asked]
    assert len(corners) > 1
    assert legs == [GoTo(x=x, y=y, frame="map") for x, y in corners]
    assert isinstance(turn, Turn)
    assert ride.pose.yaw == pytest.approx(1.0)
    assert {(asked.go.speed, asked.go.turn_speed) for asked in ride.asked} == {(None, None)}
    assert len({asked.go.id for asked in ride.asked} - {0}) == len(ride.asked)
    assert {asked.go.instance for asked in ride.asked} == {"places"}
    ended = next(at for at, told in ride.told if told.outcome)
    assert ended - ride.asked[-1].at > 1.0


def test_motion_gets_the_ticks_of_the_requesters_holds_and_no_newer_one() -> None:
    ride = Ride("")
    ride.begin()
    ride.run(2.0)
    assert len(ride.held) > 40
    assert all(tick == sent for tick, sent in ride.held)
    assert len({tick for tick, _ in ride.held}) == len(ride.held)
    assert ride.asked[0].go.tick == ride.held[0][0]
    ride.holds = None
    held = len(ride.held)
    assert ride.end().outcome == "lost_requester"
    assert len(ride.held) == held


@pytest.mark.parametrize(
    "holds",
    [
        None,
        lambda hold: msgspec.structs.replace(hold, instance="another"),
        lambda hold: msgspec.structs.replace(hold, id=MINE + 1),
    ],
    ids=["none", "another instance", "another id"],
)
def test_no_motion_is_asked_without_the_requesters_own_holds(holds: Callable[[MotionHold], MotionHold] | None) -> None:
    ride = Ride()
    ride.holds = holds
    ride.begin()
    assert ride.end(within=1.1).outcome == "lost_requester"
    assert (len(ride.asked), len(ride.held)) == (0, 0)


@pytest.mark.parametrize("holds", [None, lambda hold: msgspec.structs.replace(hold, instance="another")])
@pytest.mark.parametrize(("end", "words"), [("", ""), ("blocked", "motion says blocked"), ("blocked", "in a second")])
def test_a_requester_that_falls_silent_ends_it_while_it_drives_and_while_it_waits(
    end: End, words: str, holds: Callable[[MotionHold], MotionHold] | None
) -> None:
    ride = Ride(end)
    ride.begin()
    ride.until(lambda: bool(ride.asked) and words in str(ride.route.reason))
    ride.holds = holds
    ride.run(0.6)
    assert (ride.route.outcome, ride.route.stage, len(ride.cancelled)) == ("lost_requester", "ended", end == "")
    ride.holds = lambda hold: hold
    assert (ride.end().outcome, len(ride.asked)) == ("lost_requester", 1)


def test_where_it_is_blocked_it_waits_says_that_it_goes_on_and_then_creeps() -> None:
    ride = Ride("blocked")
    ride.begin(NEAR)
    ride.until_waiting()
    waits_from = ride.now
    assert str(ride.route.reason) == "motion says blocked"
    assert ride.route.at == ride.pose[:2]
    ride.until_waiting(announced=True)
    assert ride.now - waits_from > WAITS - STEP
    assert ride.end().outcome == "arrived"
    _, careful, last = ride.asked
    assert (careful.creeps, last.creeps) == (True, False)
    assert ride.announced(careful) > 1.0 - STEP / 2
    assert isinstance(careful.step, GoTo)
    assert (careful.step.x, careful.step.y) == pytest.approx((1.0, 1.0 + CAREFUL))


@pytest.mark.parametrize("end", ["blocked", "time_limit", "stuck"])
def test_each_time_that_it_goes_on_is_announced_and_it_does_so_a_few_times_only(end: End) -> None:
    ride = Ride(*[end] * 20)
    ride.begin(NEAR)
    route = ride.end(within=200.0)
    assert (route.outcome, route.at) == ("blocked", (1.0, 1.0))
    first, *others = ride.asked
    assert (first.creeps, len(others)) == (False, TRIES)
    assert all(asked.creeps for asked in others)
    assert min(ride.announced(asked) for asked in others) > 1.0 - STEP / 2


def test_a_robot_that_is_blocked_at_its_goal_has_arrived() -> None:
    ride = Ride("blocked", start=Pose(1.0, 2.8, 0.0))
    ride.begin(NEAR)
    assert (ride.end().outcome, len(ride.asked)) == ("arrived", 1)


@pytest.mark.parametrize("goal", [FAR, Goal(x=START.x, y=START.y, yaw=3.0)])
def test_it_ends_in_a_leg_and_in_a_turn_when_localization_is_silent(goal: Goal) -> None:
    ride = Ride("")
    ride.rolls = 0.1
    ride.begin(goal)
    ride.run(0.5)
    ride.is_located = False
    ride.run(1.1)
    assert (ride.route.outcome, len(ride.cancelled)) == ("lost_localization", 1)
    ride.is_located = True
    assert ride.end().outcome == "lost_localization"


def test_wheels_that_slip_and_a_pose_that_stands_still_take_it_no_farther_than_its_leg() -> None:
    ride = Ride("")
    ride.rolls = 0.3
    ride.begin(Goal(x=1.0, y=2.0))
    ride.until(lambda: ride.route.stage == "waiting")
    assert ride.now - ride.asked[0].at == pytest.approx(1.5 / 0.3, abs=0.1)
    assert "comes no nearer" in str(ride.route.reason)


def test_legs_that_bring_it_no_nearer_end_it() -> None:
    ride = Ride()
    ride.stays = True
    ride.begin()
    assert ride.end(400.0).outcome == "blocked"
    assert len(ride.asked) < 30


def test_a_line_that_is_drawn_meanwhile_has_it_stand_and_plan_anew() -> None:
    ride = Ride("")
    ride.begin()
    ride.run(0.5)
    ride.policy.known = KnownPlaces((), (NoGoLine(name="stairs", x=3.0, y=2.6, end_x=3.0, end_y=4.0),))
    ride.run(0.1)
    assert (ride.route.stage, len(ride.cancelled)) == ("waiting", 1)
    assert ride.end().outcome == "blocked"


def test_near_the_goal_it_waits_as_elsewhere_and_then_only_turns() -> None:
    ride = Ride("blocked")
    ride.begin(Goal(x=1.2, y=1.0, yaw=1.0))
    assert ride.end().outcome == "arrived"
    assert [type(asked.step) for asked in ride.asked] == [GoTo, Turn]
    assert ride.asked[1].at - ride.asked[0].at > WAITS + 1.0
    assert ride.asked[1].creeps


def test_a_turn_at_the_goal_that_is_blocked_is_waited_for_as_a_leg_is() -> None:
    blocked: list[End] = ["blocked"] * 20
    ride = Ride("arrived", *blocked)
    ride.begin(TURNED)
    assert ride.end().outcome == "blocked"
    _, turn, *others = ride.asked
    assert (turn.step, len(others)) == (Turn(angle=-math.pi / 2), TRIES)
    assert all(asked.creeps and ride.announced(asked) > 1.0 - STEP / 2 for asked in others)


def test_after_a_wait_it_creeps_even_where_it_has_turned_round_first() -> None:
    ride = Ride("blocked")
    ride.begin(NEAR)
    ride.until_waiting()
    ride.state = "lost"
    ride.until(lambda: len(ride.asked) > 1)
    ride.state = "localized"
    assert ride.end().outcome == "arrived"
    assert [(type(asked.step), asked.creeps) for asked in ride.asked[1:3]] == [(Turn, True), (GoTo, True)]


def take(ride: Ride) -> None:
    ride.driver = "web"


@pytest.mark.parametrize("announced", [False, True])
@pytest.mark.parametrize(
    ("befalls", "outcome"), [(Ride.stop, "disarmed"), (take, "lost_lease")], ids=["stop", "another driver"]
)
def test_a_stop_or_another_driver_in_a_wait_ends_it_for_good(
    befalls: Callable[[Ride], None], outcome: Outcome, announced: bool
) -> None:
    ride = Ride("blocked")
    ride.begin(NEAR)
    ride.until_waiting(announced)
    befalls(ride)
    ride.run(0.2)
    assert ride.route.outcome == outcome
    ride.driver = ""
    ride.stop(engaged=False)
    ride.run(2.0 * WAITS)
    assert (ride.end().outcome, len(ride.asked)) == (outcome, 1)


@pytest.mark.parametrize(
    ("end", "outcome"),
    [
        ("cancelled", "cancelled"),
        ("lost_lease", "lost_lease"),
        ("lost_requester", "lost_requester"),
        ("disarmed", "disarmed"),
        ("lost_odometry", "lost_odometry"),
        ("refused", "disarmed"),
        ("unheard", "disarmed"),
    ],
)
def test_it_ends_as_its_motion_does(end: End, outcome: Outcome) -> None:
    ride = Ride("arrived", end)
    ride.begin()
    route = ride.end()
    assert (route.outcome, len(ride.asked), bool(route.reason)) == (outcome, 2, True)
    assert route.at is not None


def test_a_stop_and_a_cancel_end_the_motion_too() -> None:
    for ending, outcome in (
        (Ride.stop, "disarmed"),
        (lambda it: it.driving.on_cancel(MotionCancel(by="you", id=MINE), it.now), "cancelled"),
    ):
        ride = Ride("")
        ride.begin()
        ride.run(1.0)
        ending(ride)
        route = ride.end(within=0.1)
        assert (route.outcome, len(ride.asked), len(ride.cancelled)) == (outcome, 1, 1)
        assert not ride.driving.on_cancel(MotionCancel(by="you", id=MINE), ride.now).accepted


def test_where_localization_is_lost_it_turns_round_once_slowly() -> None:
    for ends, outcome in (
        (("lost_localization",), "arrived"),
        (("lost_localization", "arrived", "lost_localization"), "lost_localization"),
    ):
        ride = Ride(*ends)
        ride.begin(NEAR)
        assert ride.end().outcome == outcome
        _, turn, goes_on, *_ = ride.asked
        assert (turn.step, turn.creeps) == (Turn(angle=math.tau), True)
        assert ride.announced(turn) > 1.0 - STEP / 2
        assert isinstance(goes_on.step, GoTo)


@pytest.mark.parametrize(
    ("slip", "spread", "explained", "outcome"),
    [
        (Pose(0.2, 0.0, 0.2), 0.05, 0.85, "arrived"),
        (Pose(0.3, 0.0, 0.0), 0.05, 0.9, "lost_localization"),
        (Pose(0.0, 0.0, math.radians(16.0)), 0.05, 0.9, "lost_localization"),
        (Pose(0.0, 0.0, 0.0), 0.3, 0.9, "lost_localization"),
        (Pose(0.0, 0.0, 0.0), 0.05, 0.7, "lost_localization"),
    ],
)
def test_it_has_not_arrived_elsewhere_or_unsure(slip: Pose, spread: float, explained: float, outcome: Outcome) -> None:
    ride = Ride()
    ride.slip, ride.spread, ride.explained = slip, spread, explained
    ride.begin(TURNED)
    assert ride.end().outcome == outcome
    assert ride.asked[0].go.speed == (0.1 if spread > 0.25 else None)


def house(*walls: Wall) -> FloorPlan:
    return FloorPlan("home", (*OUTER, *walls))


@pytest.mark.parametrize(
    ("walls", "goal", "outcome", "at"),
    [
        ((), Goal(x=5.9, y=1.0), "no_room", (5.9, 1.0)),
        (((3.0, 0.0, 3.0, 4.0),), FAR, "no_way", (5.0, 1.0)),
        (((3.0, 0.0, 3.0, 3.5),), FAR, "too_narrow", (3.0, 3.75)),
        ((), Goal(x=5.0, y=3.0), "forbidden", (4.0, 2.5)),
    ],
)
def test_where_there_is_no_way_it_ends_at_once_and_tells_the_place(
    walls: tuple[Wall, ...], goal: Goal, outcome: Outcome, at: tuple[float, float]
) -> None:
    ride = Ride(plan=house(*walls))
    ride.policy.known = KnownPlaces((), (NoGoLine(name="across", x=4.0, y=0.0, end_x=4.0, end_y=4.0),) * (not walls))
    ride.begin(goal)
    route = ride.end(within=0.2)
    assert route.at is not None
    assert (route.outcome, math.dist(route.at, at) < 0.6, ride.asked) == (outcome, True, [])
    assert route.reason


def second(ride: Ride) -> None:
    ride.begin()


def torn(ride: Ride) -> None:
    ride.policy.on_map(walls_of(house()))


def lost(ride: Ride) -> None:
    ride.state = "lost"
    ride.run(0.2)


@pytest.mark.parametrize(
    ("befalls", "goal", "id_", "age", "why"),
    [
        (None, FAR, 0, 0.0, "its id is 0; give a random one"),
        (None, FAR, 6, 1.1, "it was wished 1.1 s ago; ask again"),
        (None, "kitchn", 6, 0.0, "no place is called kitchn; did you mean kitchen?"),
        (second, FAR, 6, 0.0, "a route of me goes on; wait for its end"),
        (Ride.stop, FAR, 6, 0.0, "emergency stop, engaged by me: pressed"),
        (lost, FAR, 6, 0.0, "it is lost; drive it 2 m"),
        (torn, FAR, 6, 0.0, "localization goes by another floor plan"),
    ],
)
def test_a_request_is_refused_in_one_line(
    befalls: Callable[[Ride], object] | None, goal: str | Goal, id_: int, age: float, why: str
) -> None:
    ride = Ride("")
    ride.policy.known = KnownPlaces((KITCHEN,))
    if befalls is not None:
        befalls(ride)
    answer = ride.go(goal, id_, age)
    assert not answer.accepted
    assert str(answer.reason).startswith(why)
    assert "\n" not in str(answer.reason)
    ride.run(0.5)
    assert len(ride.asked) == (befalls is second)


def test_without_a_plan_there_are_no_routes() -> None:
    assert str(Ride(plan=Trouble("no map is given")).go().reason) == "no map is given"


def test_it_goes_to_a_place_by_its_name_and_asked_again_it_begins_nothing() -> None:
    ride = Ride()
    ride.policy.known = KnownPlaces((KITCHEN,))
    ride.begin("kitchen")
    route = ride.end()
    assert (route.outcome, route.place, route.goal) == ("arrived", "kitchen", TURNED)
    ride.begin("kitchen")
    assert ride.end() == route


def echo(metres: float) -> Range:
    """Return what the sensor at the front hears, on the left."""
    return Range(sensor="front_left", state="echo", range=metres, echo_us=1, tick=None)


def test_only_what_is_seen_thrice_lately_and_stands_on_no_plan_is_a_thing() -> None:
    things = Things(ROBOT, Floor.of(house(), 1.0))

    def seen(metres: float, times: int) -> int:
        for _ in range(times):
            things.on_sample(echo(metres), Pose(3.7, 2.0, 0.0), 100.0)
        return len(things.walls(100.0))

    assert seen(2.05, 9) == 0  # the wall
    assert seen(1.5, 9) == 0  # too far for a cone
    assert seen(0.7, 2) == 0
    assert seen(0.7, 1) > 0
    assert things.walls(100.0 + KEPT)
    assert things.walls(100.1 + KEPT) == []


def test_a_way_leads_around_a_thing_that_has_blocked_it() -> None:
    ride = Ride("blocked", plan=house(), start=Pose(1.0, 2.0, 0.0))
    ride.begin(Goal(x=5.0, y=2.0))
    ride.senses = [echo(0.6)]
    ride.until_waiting()
    straight = ride.route.corners
    assert straight == ((1.0, 2.0), (5.0, 2.0))
    assert ride.route.at is not None
    assert math.dist(ride.route.at, (1.85, 2.1)) < 0.3
    ride.until_waiting(announced=True)
    _, (x, y), *_, goal = ride.route.corners
    assert (goal, y < 1.7 or y > 2.6, 1.0 < x < 4.0) == ((5.0, 2.0), True, True)
