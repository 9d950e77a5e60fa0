"""`Robot.move` and the others against a motion that is there by itself, in a time that only waits let pass."""

import math
from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import pytest

import giraff_client.motion
import giraff_client.robot
import giraff_node.motion_client
from giraff_client import (
    Arc,
    GoTo,
    LostRobotError,
    MotionBlockedError,
    MotionError,
    Move,
    NoRobotError,
    RefusedError,
    Robot,
    SilentError,
    Turn,
)
from giraff_schemas.messages import DriveCommand, Lease
from giraff_schemas.motion import Outcome, Step
from giraff_schemas.topics import BASE, LEASE, OPERATOR_CMD_VEL, key_of
from tests.support.motion_double import BLOCKED, MotionDouble
from tests.support.one_process import Clock, Session
from tests.unit.cli import samples

NAME = "sim-test"


class Network:
    """A session with a motion, and a guard that obeys whoever asks."""

    def __init__(self) -> None:
        self.clock = Clock()
        self.session = Session(self.clock)
        self.motion = MotionDouble(self.session, self.clock, NAME)
        self.commands: list[DriveCommand] = []
        self.holder = ""
        self.each: Callable[[], object] = lambda: None
        """What happens in each wait of whoever holds on to a motion."""
        self._heard_at = 0.0
        self.session.declare_subscriber(key_of(NAME, OPERATOR_CMD_VEL.at("script")), self._on_command)
        self.clock.every(0.1, self._tell)

    def monotonic(self) -> float:
        return self.clock.monotonic()

    def sleep(self, seconds: float) -> None:
        self.clock.sleep(seconds)
        self.each()

    def _on_command(self, received: Any) -> None:
        command = msgspec.msgpack.decode(received.payload, type=DriveCommand)
        self.commands.append(command)
        if command.source == "hand":
            self.holder, self._heard_at = command.instance, self.clock.monotonic()

    def _tell(self) -> None:
        if self.clock.monotonic() - self._heard_at > 1.0:
            self.holder = ""
        operator = "script" if self.holder else ""
        lease = Lease(operator=operator, holder=self.holder, counter=5 if self.holder else 0)
        self.motion.say(LEASE, lease)
        self.motion.say(BASE, samples.base())


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    made = Network()
    monkeypatch.setattr(giraff_client.robot, "open_session", lambda *_, **__: made.session)
    monkeypatch.setattr(giraff_client.robot, "open_hand", lambda _network, _robot, door: door)
    monkeypatch.setattr(giraff_client.robot, "close_session", lambda _: None)
    for module in (giraff_client.robot, giraff_node.motion_client):
        monkeypatch.setattr(module, "time", made.clock)
    monkeypatch.setattr(giraff_client.motion, "time", made)
    return made


@pytest.fixture
def robot(network: Network) -> Iterator[Robot]:
    assert network.motion.ticks
    with Robot(NAME, patience=3.0) as it:
        yield it


CALLS: tuple[tuple[Callable[[Robot], object], Step], ...] = (
    (lambda it: it.move(-1), Move(distance=-1.0)),
    (lambda it: it.turn(3 * math.pi), Turn(angle=3 * math.pi)),
    (lambda it: it.arc(1, -math.pi), Arc(radius=1.0, angle=-math.pi)),
    (lambda it: it.go_to(1, 2), GoTo(x=1.0, y=2.0)),
    (lambda it: it.go_to(1, 2, frame="map"), GoTo(x=1.0, y=2.0, frame="map")),
    (lambda it: it.go([Move(distance=0.5)]), Move(distance=0.5)),
)


@pytest.mark.parametrize(("call", "step"), CALLS)
def test_a_call_is_a_step_and_returns_when_it_has_arrived(
    network: Network, robot: Robot, call: Callable[[Robot], object], step: Step
) -> None:
    call(robot)
    [request] = network.motion.asked
    assert request.steps == (step,)
    assert request.by.startswith("script@")
    assert network.commands == []
    assert network.monotonic() == pytest.approx(1.0, abs=0.2)


def test_it_tells_how_far_it_came(network: Network, robot: Robot) -> None:
    result = robot.move(1.0, speed=0.2, time_limit=9.0)
    assert (result.arrived, result.achieved.path, result.asked.path) == (True, 0.998, 1.0)
    assert (network.motion.asked[0].speed, network.motion.asked[0].time_limit) == (0.2, 9.0)
    assert robot.motion().outcome == "arrived"
    robot.turn(1.0, speed=0.4)
    assert (network.motion.asked[1].speed, network.motion.asked[1].turn_speed) == (None, 0.4)


def test_a_place_is_gone_to_by_its_name(network: Network, robot: Robot) -> None:
    result = robot.go("kitchen")
    assert (network.motion.routes[0].goal, network.motion.asked) == ("kitchen", [])
    assert (result.place, result.at, result.way) == ("kitchen", (6.3, 1.8), "7.9 of 7.9 m")
    assert robot.route().outcome == "arrived"
    ends: tuple[tuple[Outcome, type[MotionError]], ...] = (("blocked", MotionBlockedError), ("too_narrow", MotionError))
    for outcome, kind in ends:
        network.motion.outcome = outcome
        with pytest.raises(kind, match=r"; it came 3\.2 of 7\.9 m$") as told:
            robot.go("kitchen")
        assert (told.type, told.value.result.at) == (kind, (4.1, 2.2))
        robot.drive(0.1, 0.0)
    asked = len(network.motion.routes)
    for limits in ({"speed": 0.2}, {"turn_speed": 0.2}, {"time_limit": 9.0}):
        with pytest.raises(ValueError, match="a route goes as the robot file has it"):
            robot.go("kitchen", **limits)
    with pytest.raises(ValueError, match="begin with a letter"):
        robot.go("1")
    assert len(network.motion.routes) == asked


def test_a_blocked_way_is_an_error_with_its_sensor(network: Network, robot: Robot) -> None:
    network.motion.outcome = "blocked"
    with pytest.raises(MotionBlockedError, match="front_left sees something") as told:
        robot.move(1.0)
    assert (told.value.sensor, told.value.result.reason) == ("front_left", BLOCKED)
    assert told.value.result.achieved.path == 0.5


def test_whatever_else_ends_it_is_an_error(network: Network, robot: Robot) -> None:
    network.motion.outcome = "lost_lease"
    with pytest.raises(MotionError, match=r"lost lease: it is lost_lease; it came 0\.500 of 1\.000 m") as told:
        robot.move(1.0)
    assert told.value.result.outcome == "lost_lease"
    network.motion.refusal = "held by joystick"
    with pytest.raises(MotionError, match=r"^refused: held by joystick$"):
        robot.move(1.0)
    network.motion.refusal, network.motion.answers, network.motion.speaks = "", False, False
    with pytest.raises(SilentError, match="check that giraff_motion runs"):
        robot.move(1.0)
    network.motion.ticks = False
    network.clock.sleep(1.0)
    with pytest.raises(LostRobotError, match="no tick of the robot"):
        robot.move(1.0)


def test_what_is_no_number_asks_for_nothing(network: Network, robot: Robot) -> None:
    calls: tuple[Callable[[], object], ...] = (
        lambda: robot.move(math.nan),
        lambda: robot.turn(math.inf),
        lambda: robot.arc(1.0, math.nan),
        lambda: robot.go_to(math.nan, 0.0),
        lambda: robot.move(1.0, speed=math.nan),
        lambda: robot.go([Move(distance=1.0)], time_limit=math.inf),
    )
    for call in calls:
        with pytest.raises(ValueError, match="must be finite numbers"):
            call()
    assert network.motion.asked == []


def test_ctrl_c_stops_it_and_raises(network: Network, robot: Robot) -> None:
    network.motion.takes, at = 60.0, list[float]()

    def interrupt() -> None:
        if not at and network.monotonic() > 0.5:
            at.append(network.monotonic())
            raise KeyboardInterrupt

    network.each = interrupt
    with pytest.raises(KeyboardInterrupt):
        robot.move(1.0)
    assert [cancel.id for cancel in network.motion.cancelled] == [network.motion.asked[0].id]
    assert network.motion.holds[-1][0] <= at[0]
    assert network.monotonic() < 1.0


def test_a_script_that_drives_lets_go_first_and_its_next_drive_arms_anew(network: Network, robot: Robot) -> None:
    robot.drive(0.1, 0.0)
    assert network.holder
    robot.move(1.0)
    assert network.commands[-1].source == "fault"
    assert network.holder == ""
    assert network.motion.asked[0].tick.robot_ns > 1_000_000_000
    robot.drive(0.1, 0.0)
    assert network.holder


def test_a_motion_that_is_refused_does_not_have_drive_arm_again(network: Network, robot: Robot) -> None:
    """Somebody may have taken the robot while the script let go of it."""
    robot.drive(0.1, 0.0)
    network.motion.refusal = "held by keyboard"
    with pytest.raises(MotionError):
        robot.move(1.0)
    with pytest.raises(RefusedError, match=r"call robot\.arm\(\)"):
        robot.drive(0.1, 0.0)
    assert network.holder == ""


def test_what_is_no_step_is_refused_here(network: Network, robot: Robot) -> None:
    wrong: Any = [1]
    with pytest.raises(ValueError, match="there are the frames 'odom' and 'map', and not 'kitchen'"):
        robot.go_to(1.0, 2.0, frame="kitchen")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="each step must be a Move, a Turn, an Arc or a GoTo"):
        robot.go(wrong)
    robot.move(1.0, speed=True)
    assert [type(asked.speed) for asked in network.motion.asked] == [float]


def test_what_has_taken_the_robot_away_takes_it_from_drive_as_well(network: Network, robot: Robot) -> None:
    network.motion.outcome = "disarmed"
    with pytest.raises(MotionError):
        robot.move(1.0)
    with pytest.raises(Exception, match=r"call robot\.arm\(\)"):
        robot.drive(0.1, 0.0)
    robot.arm()
    robot.drive(0.1, 0.0)


def test_outside_of_its_block_it_says_so() -> None:
    with pytest.raises(NoRobotError, match=r"use it as `with Robot\(\) as robot:`"):
        Robot(NAME).move(1.0)
