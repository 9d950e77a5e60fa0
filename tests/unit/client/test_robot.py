"""`Robot` where the network fails it, and what it reads, in a time that only its own waits let pass."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Never

import msgspec
import pytest
import zenoh

import giraff_client.frames
import giraff_client.robot
import giraff_node.network.query_client
from giraff_client import BlockedError, LostRobotError, NoRobotError, Robot, RobotError, SilentError, UnlocalizedError
from giraff_core.kinematics.pose import Pose
from giraff_node.network.consent import NoRobotError as UnknownRobotError
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Battery, Sample, Tick
from giraff_schemas.requests import OdomAnswer, OdomReset, OdomSetPose
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, ODOM, ODOM_SET_POSE, POSE, RANGE, TICK, Topic, key_of
from giraff_schemas.trouble import Trouble
from tests.support.map_poses import LOST, map_pose
from tests.support.robots import ULTRASONIC
from tests.unit.cli import samples


class FailingSession:
    """Of Zenoh, which opens and then takes no subscriber."""

    def declare_subscriber(self, *_: Any) -> Never:
        raise zenoh.ZError("the session is closed")


def test_a_session_that_fails_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    session = FailingSession()
    left: list[object] = []
    monkeypatch.setattr(giraff_client.robot, "open_session", lambda *_, **__: session)
    monkeypatch.setattr(giraff_client.robot, "open_hand", lambda _network, _robot, door: door)
    monkeypatch.setattr(giraff_client.robot, "close_session", left.append)
    with pytest.raises(NoRobotError, match=r"check the table \[network\]"), Robot("sim-test"):
        pass
    assert left == [session]


class Said:
    """A sample as Zenoh hands it over."""

    def __init__(self, key: str, sample: Sample) -> None:
        self.key_expr, self.payload, self.encoding = key, encode(sample), encoding_of(type(sample))


class Reply:
    """An answer as Zenoh hands it over."""

    def __init__(self, answer: msgspec.Struct) -> None:
        self.ok = Answered(encode(answer))


class Answered(msgspec.Struct):
    payload: bytes


class Network:
    """A session, and the clock of who uses it: each wait lets time pass, in which the robot goes on."""

    def __init__(self) -> None:
        self.now = 100.0
        self.ticks = True
        self.asked: list[tuple[str, bytes]] = []
        self.answer: msgspec.Struct | None = None
        """Of who is asked, to the second time that it is asked."""
        self._listeners: dict[str, Callable[[Any], None]] = {}
        self._due: list[tuple[float, Topic[Any], Sample, str]] = []

    def say(self, topic: Topic[Any], sample: Sample, *, name: str = "", after: float = 0.0) -> None:
        """Let the robot say this in `after` s; `name`: in the place of the key's `*`."""
        self._due.append((self.now + after, topic, sample, name))

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds
        if self.ticks:
            self._hand_over(TICK, Tick(epoch=samples.EPOCH, robot_ns=round(self.now * 1e9)), "")
        for due in [each for each in self._due if each[0] <= self.now]:
            self._due.remove(due)
            self._hand_over(*due[1:])

    def pass_time(self, seconds: float) -> None:
        until = self.now + seconds
        while self.now < until:
            self.sleep(0.02)

    def declare_subscriber(self, key: str, listener: Callable[[Any], None]) -> None:
        self._listeners[key] = listener

    def get(self, key: str, on_reply: Callable[[Any], None], *, payload: bytes = b"", **_: Any) -> None:
        self.asked.append((key, payload))
        if self.answer is not None and len(self.asked) > 1:
            on_reply(Reply(self.answer))

    def liveliness(self) -> "Network":
        return self

    def declare_token(self, _: str) -> None:
        """Nobody looks."""

    def _hand_over(self, topic: Topic[Any], sample: Sample, name: str) -> None:
        key = key_of("sim-test", topic)
        if listener := self._listeners.get(key):
            listener(Said(key.replace("*", name), stamped(sample, 0, 0, "one")))


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    made = Network()
    monkeypatch.setattr(giraff_client.robot, "open_session", lambda *_, **__: made)
    monkeypatch.setattr(giraff_client.robot, "open_hand", lambda _network, _robot, door: door)
    monkeypatch.setattr(giraff_client.robot, "close_session", lambda _: None)
    for module in (giraff_client.robot, giraff_client.frames, giraff_client.frames, giraff_node.network.query_client):
        monkeypatch.setattr(module, "time", made)
    return made


@pytest.fixture
def robot(network: Network) -> Iterator[Robot]:
    assert network.ticks
    with Robot("sim-test") as it:
        yield it


def say_ranges(network: Network, *sensors: str, after: float = 0.0) -> None:
    for sensor in sensors:
        network.say(RANGE, samples.reading(sensor, 1.2), name=sensor, after=after)


def test_the_first_ranges_are_of_each_sensor(network: Network, robot: Robot) -> None:
    say_ranges(network, "rear", after=0.05)
    network.say(GUARD, samples.guard(samples.verdict()), after=0.1)
    say_ranges(network, "front_left", after=0.15)
    say_ranges(network, "front_right", after=0.3)
    began = network.now
    assert {name: reading.range for name, reading in robot.ranges().items()} == dict.fromkeys(samples.SENSORS, 1.2)
    assert network.now - began == pytest.approx(0.3, abs=0.02), "it waits no longer than it must"


def test_a_sensor_that_is_never_heard_delays_a_script_once(network: Network, robot: Robot) -> None:
    """One that waited at each call would stop the robot at each call."""
    network.say(GUARD, samples.guard(samples.verdict()))
    say_ranges(network, "front_left", "rear")
    began = network.now
    assert robot.ranges()["front_right"].state == "fault"
    waited = network.now - began
    assert waited == pytest.approx(2.0, abs=0.02)
    assert "never heard" in str(robot.ranges()["front_right"].reason)
    with pytest.raises(SilentError):
        robot.odom()
    assert network.now - began == waited


def test_without_the_guard_the_ranges_are_those_heard_in_the_patience_of_a_first_reading(
    network: Network, robot: Robot
) -> None:
    say_ranges(network, "rear")
    say_ranges(network, "front_left", after=1.9)
    assert set(robot.ranges()) == {"rear", "front_left"}


def test_without_any_range_and_guard_it_says_so(robot: Robot) -> None:
    with pytest.raises(SilentError, match="no range was ever heard"):
        robot.ranges()


def test_the_pose_on_the_map_is_read_with_its_state(network: Network, robot: Robot) -> None:
    """And where it is in a frame, once that is known."""
    with pytest.raises(SilentError, match="pose was never heard; start giraff_localization"):
        robot.map_pose()
    where = Pose(4.0, 1.0, 0.0), Pose(0.5, 0.0, 0.0)
    tick = samples.at(round(network.now * 1e9))
    network.say(POSE, map_pose(*where, tick, "lost"))
    network.say(ODOM, samples.odometry(tick.robot_ns - 1, 0.0))
    network.say(ODOM, samples.odometry(tick.robot_ns, 0.5))
    network.pass_time(0.1)
    assert (robot.map_pose().state, str(robot.map_pose().reason)) == ("lost", LOST)
    with pytest.raises(UnlocalizedError, match=LOST):
        robot.lookup("map", "base_link")
    network.say(POSE, map_pose(*where, tick))
    network.pass_time(0.1)
    assert (robot.map_pose().x, robot.lookup("map", "base_link").x) == (4.5, 4.5)
    assert robot.map_pose().standard_deviations == pytest.approx((0.1, 0.1, 0.0316), abs=1e-4)
    network.say(POSE, map_pose(*where, tick, "told"))
    network.pass_time(0.1)
    with pytest.raises(UnlocalizedError):
        robot.lookup("map", "base_link")
    network.pass_time(1.0)
    with pytest.raises(SilentError, match=r"pose is silent for 1\.1 s"):
        robot.map_pose()


def test_battery_and_emergency_stop_are_read(network: Network, robot: Robot) -> None:
    network.say(BATTERY, Battery(voltage=24.3), after=0.4)
    network.say(ESTOP, samples.estop(engaged=True), after=0.4)
    assert robot.battery().voltage == 24.3
    assert (robot.estop().engaged, robot.estop().by) == (True, "ann@desk")
    network.pass_time(1.6)
    with pytest.raises(SilentError, match=r"battery is silent for 1\.6 s; .*battery_volts_per_count"):
        robot.battery()
    with pytest.raises(SilentError, match="estop is silent"):
        robot.estop()


def test_a_robot_that_is_lost_is_told_from_a_part_of_it_that_is_silent(network: Network, robot: Robot) -> None:
    say_ranges(network, *samples.SENSORS)
    network.say(GUARD, samples.guard(samples.verdict()))
    network.say(BASE, samples.base())
    assert robot.base().armed
    robot.ranges()
    network.pass_time(1.2)
    assert {reading.state for reading in robot.ranges().values()} == {"fault"}
    with pytest.raises(SilentError, match="base is silent"):
        robot.base()
    network.ticks = False
    network.pass_time(0.6)
    for read in (robot.base, robot.ranges, robot.odom, lambda: robot.check_way(0.2, 0.0)):
        with pytest.raises(LostRobotError, match="no tick of the robot"):
            read()


def test_a_blocked_way_is_told_to_who_asks(network: Network, robot: Robot) -> None:
    with pytest.raises(SilentError, match="guard was never heard"):
        robot.check_way(0.2, 0.0)
    wall = samples.verdict(0.0, "blocked", "front_left", "front_left sees something at 0.40 m", "turn left")
    network.say(GUARD, samples.guard(wall))
    network.sleep(0.02)
    with pytest.raises(BlockedError, match=r"forward blocked: .*; turn left"):
        robot.check_way(0.2, 0.0)
    robot.check_way(-0.2, 0.0)
    with pytest.raises(ValueError, match="finite"):
        robot.check_way(float("nan"), 0.0)


def odometry(x: float, jumps: int) -> Sample:
    return msgspec.structs.replace(samples.odometry(0, x), jumps=jumps)


def test_a_pose_that_is_set_is_what_is_read_next(network: Network, robot: Robot) -> None:
    """Samples from before are still on their way when odometry has answered, and one wish is asked until it has."""
    network.answer = OdomAnswer(done=True, jumps=3)
    network.say(ODOM, odometry(9.0, 2))
    network.say(ODOM, odometry(9.0, 2), after=0.3)
    network.say(ODOM, odometry(1.0, 3), after=0.4)
    began = network.now
    robot.set_odom(1.0, -2.0, 0.5, yaw_sd=0.1)
    assert network.now - began == pytest.approx(0.4, abs=0.03), "it waits no longer than it must"
    assert (robot.odom().x, robot.odom().jumps) == (1.0, 3)
    asked = {(key, msgspec.msgpack.decode(payload, type=OdomSetPose)) for key, payload in network.asked}
    [(key, request)] = asked
    assert len(network.asked) == 2
    assert key == key_of("sim-test", ODOM_SET_POSE)
    assert (request.x, request.y, request.yaw, request.position_sd, request.yaw_sd) == (1.0, -2.0, 0.5, 0.0, 0.1)
    assert request.by.startswith("script@")


def test_each_reset_is_a_wish_of_its_own(network: Network, robot: Robot) -> None:
    network.answer = OdomAnswer(done=True, jumps=1)
    for _ in range(2):
        network.say(ODOM, odometry(0.0, 1), after=0.5)
        robot.reset_odom()
    wishes = [msgspec.msgpack.decode(payload, type=OdomReset).id for _, payload in network.asked]
    assert len(set(wishes)) == 2


def test_a_pose_that_is_not_set_says_why(network: Network, robot: Robot) -> None:
    with pytest.raises(SilentError, match=r"nobody answers odom/set_pose; check that giraff_odometry runs"):
        robot.set_odom(1.0, 0.0, 0.0)
    network.answer = OdomAnswer(done=False, jumps=0, reason=Trouble("x is 1e+09: it must be within -1e+06..1e+06 m"))
    with pytest.raises(RobotError, match=r"odometry refuses: x is 1e\+09"):
        robot.set_odom(1e9, 0.0, 0.0)
    network.answer = OdomAnswer(done=True, jumps=1)
    with pytest.raises(SilentError, match=r"odom is not heard since; check that giraff_base runs"):
        robot.set_odom(1.0, 0.0, 0.0)
    for pose in ((float("nan"), 0.0, 0.0), (0.0, float("inf"), 0.0), (0.0, 0.0, 0.0, -1.0)):
        with pytest.raises(ValueError, match=r"nan|inf|negative"):
            robot.set_odom(*pose)
    with pytest.raises(ValueError, match=r"set_odom\(a, 0\.0, 0\.0, 0\.0, 0\.0\): all must be finite numbers"):
        robot.set_odom("a", 0.0, 0.0)  # type: ignore[arg-type]  # as a script may
    network.ticks = False
    with pytest.raises(LostRobotError, match="no tick of the robot"):
        robot.reset_odom()


def test_a_frame_is_looked_up_where_the_robot_is(network: Network, robot: Robot) -> None:
    network.answer = ULTRASONIC["rear"].transform("rear")
    network.say(ODOM, odometry(1.0, 0), after=0.1)
    found = robot.lookup("odom", "range_rear_link")
    assert (found.parent, found.child, found.x, found.tick) == ("odom", "range_rear_link", 0.75, robot.odom().tick)
    assert robot.wait_for("odom", "range_rear_link", robot.odom().tick).x == 0.75
    network.pass_time(1.2)
    with pytest.raises(SilentError, match=r"odom is silent for 1\.\d s; check that giraff_odometry"):
        robot.lookup("odom", "range_rear_link")
    network.ticks = False
    network.pass_time(0.6)
    with pytest.raises(LostRobotError, match="no tick of the robot"):
        robot.lookup("odom", "nowhere")


def test_what_is_read_outside_of_its_block_says_so() -> None:
    robot = Robot("sim-test")
    frames = (lambda: robot.lookup("odom", "base_link"), lambda: robot.wait_for("odom", "base_link"))
    for read in (robot.odom, robot.ranges, robot.arm, robot.reset_odom, lambda: robot.drive(0.1, 0.0), *frames):
        with pytest.raises(NoRobotError, match=r"use it as `with Robot\(\) as robot:`"):
            read()


@pytest.mark.usefixtures("network")
def test_a_robot_that_nobody_has_named_and_that_is_no_simulation_of_this_host_takes_a_yes_each_time(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """No terminal is here, so nobody can say it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(giraff_client.robot, "find_robot", lambda *_: "sim-test")
    asked: list[tuple[str, str]] = []

    def refuse(_: object, name: str, line: str) -> Never:
        asked.append((name, line))
        raise UnknownRobotError("nobody has named it")

    monkeypatch.setattr(giraff_client.robot, "require_consent", refuse)
    found = Robot()
    for _ in range(2):
        with found:
            with pytest.raises(NoRobotError, match="nobody has named it"):
                found.drive(0.1, 0.0)
            with pytest.raises(NoRobotError, match="nobody has named it"):
                found.reset_odom()
            with pytest.raises(NoRobotError, match="nobody has named it"):
                found.move(1.0)
    assert asked == [("sim-test", 'Robot("sim-test")')] * 6


def test_one_address_is_an_address(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def find_silent(addresses: Sequence[str]) -> dict[str, str]:
        asked.extend(addresses)
        return {"192.168.1.9": "Connection refused"}

    monkeypatch.setattr(giraff_client.robot, "find_silent", find_silent)
    with (
        pytest.raises(NoRobotError, match=r"connect: 192\.168\.1\.9: Connection refused"),
        Robot(connect="192.168.1.9"),
    ):
        pass
    assert asked == ["192.168.1.9"]


def test_it_can_be_used_again(network: Network) -> None:
    robot = Robot("sim-test")
    for _ in range(2):
        with robot:
            network.say(BATTERY, Battery(voltage=24.0), after=0.1)
            assert robot.battery().voltage == 24.0
        with pytest.raises(NoRobotError, match=r"use it as `with Robot\(\) as robot:`"):
            robot.battery()
