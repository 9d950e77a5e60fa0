"""What `/cmd_vel` asks, by calling: keys, streams, frozen processes, two at once, and what is refused."""

import math
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import pytest
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Twist as Twist
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3

from giraff_core.operator import Fault, Wish
from giraff_ros2.answers import Answers
from giraff_ros2.config import Ros2Config
from giraff_ros2.hand.publisher import PublisherClock
from giraff_ros2.hand.twist_hand import TwistHand
from giraff_ros2.port import Received, Refused, RosPublisher
from giraff_ros2.topics import CMD_VEL
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.trouble import Trouble

STEP = 0.02  # s
WALL = 1_800_000_000_000_000_000  # ns; the publishers' clocks, which agree with nobody's


class Desk:
    """A hand, the robot's ticks, and ROS processes, 50 steps a second."""

    def __init__(self) -> None:
        self.hand = TwistHand(Ros2Config(), "me")
        self.now = 0.0
        self.publishers: dict[str, RosPublisher] = {}
        self.frozen: set[str] = set()
        self.mute: set[str] = set()
        self.answers: defaultdict[str, Answers] = defaultdict(Answers)
        self.said: list[Wish | Fault | None] = []
        self.run(0.1)

    def come(self, name: str, *, answers: bool = True) -> None:
        self.publishers[name] = RosPublisher(name.encode(), f"/{name}", name, CMD_VEL)
        if not answers:
            self.mute.add(name)

    def send(self, name: str, linear: float, angular: float = 0.0, *, held_for: float = 0.0) -> None:
        twist: Any = Twist(Vector3(linear, 0.0, 0.0), Vector3(0.0, 0.0, angular))
        sent_ns = WALL + round((self.now - held_for) * 1e9)
        self.hand.on_twist(Received(CMD_VEL, twist, name.encode(), sent_ns, self.now), self.now)

    def run(self, seconds: float, each: Callable[[], None] | None = None, period: float = 0.1) -> list[object]:
        """What was said meanwhile. `each`: done every `period` s."""
        begun, due = len(self.said), self.now
        for _ in range(round(seconds / STEP)):
            if each is not None and self.now >= due - 1e-9:
                due += period
                each()
            awake = [name for name in self.publishers if name not in self.frozen | self.mute]
            for name in awake:
                self.answers[name].on_answer(self.now - 0.1, self.now)
            self.hand.review(self.publishers.values(), lambda process: self.answers[process], self.now)
            tick = Tick(epoch=1, robot_ns=round(self.now * 1e9) + 1)
            self.hand.operator.on_tick(tick, self.now)
            self.said.append(self.hand.poll(self.now))
            self.now += STEP
        return list(self.said[begun:])


def moves(said: list[object]) -> list[tuple[float, float]]:
    return [each[:2] for each in said if isinstance(each, Wish) and each[:2] != (0.0, 0.0)]


def faults(said: list[object]) -> set[str]:
    return {each.trouble.what for each in said if isinstance(each, Fault)}


def rests(said: list[object]) -> bool:
    return all(isinstance(each, Wish) and each[:2] == (0.0, 0.0) and not each.takes for each in said)


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_nobody_is_no_hand_and_neither_is_who_has_said_nothing(desk: Desk) -> None:
    assert set(desk.run(0.5)) == {None}
    desk.come("teleop")
    assert set(desk.run(0.5)) == {None}
    assert not desk.hand.operator.has_asked  # for the lease


@pytest.mark.parametrize("answers", [True, False])
def test_a_key_drives_for_as_long_as_a_press_and_then_rests_for_30_s(desk: Desk, answers: bool) -> None:
    desk.come("teleop", answers=answers)
    desk.run(1.5)
    desk.send("teleop", 0.3, -0.2)
    said = desk.run(0.6)
    wish = said[0]
    assert isinstance(wish, Wish)
    assert wish == Wish(0.3, -0.2, RobotTime(epoch=1, robot_ns=round((desk.now - 0.62) * 1e9) + 1), takes=True)
    assert {each for each in said if isinstance(each, Wish) and each.takes} == {wish}  # its tick is never renewed
    assert len(moves(said)) == pytest.approx(0.4 / STEP, abs=1)
    assert not faults(said)
    assert rests(desk.run(29.3))
    assert set(desk.run(1.0)[25:]) == {None}


def test_neutral_carries_the_tick_of_its_proof(desk: Desk) -> None:
    desk.come("teleop")
    desk.send("teleop", 0.3)
    desk.run(1.0)
    wish = desk.run(STEP)[0]
    assert isinstance(wish, Wish)
    assert wish.tick is not None
    assert wish.tick.robot_ns * 1e-9 <= desk.now - STEP - 0.1 + 1e-6  # when the question was asked


@pytest.mark.parametrize(
    ("answers", "period"), [(True, 0.05), (True, 0.5), (True, 0.9), (False, 0.05), (False, 0.35), (False, 0.5)]
)
def test_a_frozen_process_that_wakes_and_drives_on_never_counts(desk: Desk, answers: bool, period: float) -> None:
    desk.come("nav", answers=answers)
    desk.run(1.2)
    assert moves(desk.run(3.0, lambda: desk.send("nav", 0.3), period))
    desk.frozen.add("nav")
    frozen = desk.run(5.0)
    assert not moves(frozen[21:])
    assert isinstance(frozen[-1], Fault)
    desk.frozen.clear()
    for age in (5.0, 4.0, 0.3):
        desk.send("nav", 0.3, held_for=age)
    woken = desk.run(5.0, lambda: desk.send("nav", 0.3), period)
    assert not moves(woken)
    assert all(isinstance(each, Fault) for each in woken)
    desk.run(1.2, lambda: desk.send("nav", 0.0), 0.05)
    assert moves(desk.run(1.0, lambda: desk.send("nav", 0.3), 0.05))


def test_a_process_that_was_frozen_for_longer_than_a_hand_rests_does_not_count_either(desk: Desk) -> None:
    desk.come("nav")
    desk.run(1.0, lambda: desk.send("nav", 0.3), 0.05)
    desk.frozen.add("nav")
    assert desk.run(32.0)[-1] is None
    desk.frozen.clear()
    woken = desk.run(2.0, lambda: desk.send("nav", 0.3), 0.05)
    assert not moves(woken)
    assert len(faults(woken)) == 1


def test_a_process_that_wakes_does_not_count_though_another_has_armed_the_robot_meanwhile(desk: Desk) -> None:
    desk.come("nav")
    desk.come("teleop")
    desk.run(1.0, lambda: desk.send("nav", 0.3), 0.05)
    desk.frozen.add("nav")
    desk.run(31.0)
    desk.send("teleop", 0.1)
    assert rests(desk.run(3.0)[75:])
    desk.frozen.clear()
    desk.run(0.5)  # it answers before it drives on
    assert not moves(desk.run(3.0, lambda: desk.send("nav", 0.3), 0.05))


@pytest.mark.parametrize("speed", [0.3, 0.0])
def test_a_hand_that_is_awake_does_not_answer_for_one_that_is_frozen(desk: Desk, speed: float) -> None:
    desk.come("nav")
    desk.come("teleop")
    desk.send("teleop", 0.1)
    desk.run(1.0)
    desk.run(1.0, lambda: desk.send("nav", speed), 0.05)
    desk.frozen.add("nav")
    still_proven = desk.run(0.46)[-1]
    assert isinstance(still_proven, Wish)
    assert still_proven.tick is not None
    assert still_proven.tick.robot_ns * 1e-9 <= desk.now - 0.46  # teleop has answered since
    assert "the process of /nav did not answer" in faults(desk.run(2.0)).pop()
    desk.frozen.clear()
    assert not moves(desk.run(2.0, lambda: desk.send("nav", 0.3), 0.05))


def test_an_old_message_moves_nothing_though_its_process_is_awake(desk: Desk) -> None:
    desk.come("nav")
    desk.run(1.0, lambda: desk.send("nav", 0.3), 0.05)
    assert rests(desk.run(0.6)[21:])
    desk.send("nav", 0.3, held_for=0.5)
    desk.send("nav", 0.3, held_for=0.25)
    said = desk.run(0.3)
    assert not moves(said)
    assert "older than those before it" in faults(said).pop()
    desk.run(1.5)
    desk.send("nav", 0.3, held_for=0.15)
    assert moves(desk.run(0.1))


def test_a_short_lag_of_a_stream_slows_by_its_ticks_and_disarms_nothing(desk: Desk) -> None:
    desk.come("nav")
    desk.run(1.0, lambda: desk.send("nav", 0.3), 0.05)
    desk.run(0.3)
    desk.send("nav", 0.3, held_for=0.3)
    desk.send("nav", 0.3, held_for=0.1)
    assert not faults(desk.run(0.3))


def test_an_old_message_is_refused_however_long_its_publisher_was_silent() -> None:
    clock = PublisherClock()
    assert clock.lateness(WALL, 10.0) == 0.0
    assert clock.lateness(WALL + 90_000_000_000, 100.5) == pytest.approx(0.5)
    assert clock.lateness(WALL + 100_000_000_000, 110.5) == pytest.approx(0.0)  # the clocks differ by so much now
    assert clock.lateness(WALL + 50_000_000_000, 111.0) == pytest.approx(50.5)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_moves_nothing(desk: Desk, value: float) -> None:
    desk.come("teleop")
    desk.run(STEP)
    for linear, angular in ((value, 0.0), (0.0, value)):
        desk.send("teleop", linear, angular)
        said = desk.run(0.3)
        assert not moves(said)
        assert faults(said) == {"a message of /teleop has a speed that is not a number"}


def test_two_that_drive_are_named_and_neither_counts(desk: Desk) -> None:
    desk.come("nav")
    desk.come("teleop")

    def both(teleop: float) -> list[object]:
        def send() -> None:
            desk.send("nav", 0.3)
            desk.send("teleop", teleop)

        return desk.run(1.0, send, 0.05)

    assert moves(both(0.0))
    said = both(-0.1)
    assert not moves(said)
    assert faults(said) == {"/nav and /teleop drive at once"}


def test_the_end_of_a_publisher_that_drives_is_told_and_then_there_is_no_hand(desk: Desk) -> None:
    desk.come("teleop")
    desk.run(1.0, lambda: desk.send("teleop", 0.3), 0.1)
    desk.publishers.clear()
    said = desk.run(1.5)
    assert faults(said) == {"/teleop was driving, and is not there any more"}
    assert not moves(said)
    assert said[-1] is None


def test_who_publishes_by_an_id_that_no_token_has_is_told_and_moves_nothing(desk: Desk) -> None:
    desk.come("sdk")  # its own token has another id than its messages
    said = desk.run(0.9, lambda: desk.send("random", 0.3))
    assert not desk.hand.token_fault(desk.now), "for its token may come yet"
    said += desk.run(1.0, lambda: desk.send("random", 0.3))
    assert set(said) == {None}
    assert "no token has the id of their publisher" in str(desk.hand.token_fault(desk.now))
    desk.run(0.5)
    desk.send("random", math.nan)
    assert faults(desk.run(0.1)) == {"a message of a publisher that no token names has a speed that is not a number"}
    desk.run(29.0)
    assert desk.hand.token_fault(desk.now)
    desk.run(1.0)
    assert not desk.hand.token_fault(desk.now), "which is long ago"
    desk.send("random", 0.3)
    desk.come("random")
    desk.run(0.5)
    assert not desk.hand.token_fault(desk.now)


def test_a_message_of_nobody_and_a_torn_one_move_nothing(desk: Desk) -> None:
    desk.send("stranger", 0.3)
    assert not moves(desk.run(1.0))
    desk.come("teleop")
    desk.hand.on_refused(Refused(CMD_VEL, Trouble("torn")), desk.now)
    assert faults(desk.run(0.3)) == {"torn"}
    for number in range(100):
        desk.send(f"stranger{number}", 0.3)
    said = desk.run(1.0)
    assert not moves(said)
    assert len(desk.hand._publishers) <= 33


def test_without_the_robot_while_a_stop_is_asked_and_while_another_part_drives_nothing_moves(desk: Desk) -> None:
    desk.come("teleop")
    desk.send("teleop", 0.3)
    desk.hand.stopping = True
    said = desk.run(0.1)
    assert "/giraff/estop" in faults(said).pop()
    desk.hand.stopping, desk.hand.paused = False, True
    desk.send("teleop", 0.3)
    assert set(desk.run(0.1)) == {None}
    desk.hand.paused = False
    desk.now += 1.0  # no tick meanwhile
    desk.send("teleop", 0.3)
    asked = desk.hand.poll(desk.now)
    assert isinstance(asked, Fault)
    assert "no tick of the robot" in asked.trouble.what
