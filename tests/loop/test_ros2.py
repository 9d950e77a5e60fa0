"""ROS's `/cmd_vel`, stop and goals drive the robot as an operator, in simulated time: motors and pose are the judge."""

import math
from collections.abc import Callable
from typing import Final

import pytest

from giraff_ros2.topics import CMD_VEL
from tests.loop.ros import Answer, Program, RosStage, ros_stage

STOPS: Final = 0.45
"""s to PWM 0 after the last message, as `tests/timing/faults.py` has it of a lost operator."""


def silent(_: RosStage, program: Program) -> None:
    program.asks = None


def gone(it: RosStage, program: Program) -> None:
    it.desk.programs.remove(program)


def second(it: RosStage, _: Program) -> None:
    it.desk.programs.append(other := Program("nav"))
    other.asks = (0.3, 0.0)


FAULTS: Final[dict[str, Callable[[RosStage, Program], object]]] = {
    "falls silent": silent,
    "ends": gone,
    "is not the only one": second,
    "service killed": lambda it, _: it.loop.kill("ros2"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_whatever_ends_a_hand_of_ros_stops_the_robot(name: str) -> None:
    with ros_stage() as it:
        teleop = it.add("teleop")
        since = it.now
        it.press(teleop, 0.3)  # before it is armed
        assert it.stage.driven_ms(since) == 0
        it.drive(teleop)
        since = it.now
        FAULTS[name](it, teleop)
        it.run(0.7)
        assert it.stage.last_driven(since) <= STOPS
        assert it.stage.driven_ms(since + STOPS) == 0


def test_a_frozen_program_that_wakes_moves_nothing() -> None:
    with ros_stage() as it:
        teleop = it.add("nav")
        it.drive(teleop)
        teleop.is_frozen = True
        held = [(it.now + 0.01, 0.3, 0.0), (it.now + 0.02, 0.3, 0.0)]
        it.run(1.2)
        assert "/nav did not answer" in it.said
        before, since = it.at, it.now
        teleop.held.extend(held)
        teleop.is_frozen = False
        it.run(1.0)
        assert it.at == before
        assert it.stage.driven_ms(since) == 0


def test_neither_a_stop_nor_a_person_is_driven_past_and_both_are_named() -> None:
    with ros_stage() as it:
        teleop = it.add("teleop")
        it.drive(teleop)
        it.desk.called.append(call := Answer())
        since = it.now
        it.run(1.0)
        assert call.success
        assert "base has confirmed" in call.message
        assert it.stage.last_driven(since) <= STOPS
        assert it.desk.published["~/estop_engaged"].data
        it.stage.start_stopper()
        it.stage.reset()
        since = it.now
        it.run(1.0)
        assert not it.desk.published["~/estop_engaged"].data
        assert it.stage.driven_ms(since) == 0  # it goes on publishing, and a release causes no motion
        teleop.asks = None
        it.stage.start_keyboard()
        it.stage.type(b"w", 1.0)
        since = it.now
        teleop.asks = (0.3, 0.0)
        it.run(1.0)
        assert it.driver == "keyboard"
        assert it.stage.driven_ms(since + STOPS) == 0
        assert "keyboard" in it.loop.processes["ros2"].told["lease"]


def test_a_goal_of_rviz_is_driven_to() -> None:
    with ros_stage() as it:
        x, _, yaw = it.at
        it.desk.give_goal(0.4, 0.0, math.pi / 2)
        it.stage.until_ended(8.0)
        it.run(0.3)
        assert it.at[0] - x == pytest.approx(0.4, abs=0.05)
        assert math.remainder(it.at[2] - yaw - math.pi / 2, math.tau) == pytest.approx(0.0, abs=0.1)


def zero(it: RosStage, program: Program) -> None:
    it.desk.say(program, 0.0, 0.0, it.desk.now)


ENDS: Final[dict[str, tuple[str, Callable[[RosStage, Program], object]]]] = {
    "a message of zero": ("/cmd_vel", zero),
    "a torn message": ("/cmd_vel", lambda it, _: it.desk.say_torn(CMD_VEL)),
    "a stop": ("a stop was asked for", lambda it, _: it.desk.called.append(Answer())),
    "the end of the service": ("", lambda it, _: it.loop.kill("ros2")),
}


@pytest.mark.parametrize("name", ENDS)
def test_a_goal_ends_with(name: str) -> None:
    why, end = ENDS[name]
    with ros_stage() as it:
        teleop = it.add("teleop")
        it.desk.give_goal(2.0, 0.0, 0.0)
        it.run(1.2)
        since = it.now
        assert it.stage.driven_ms(since - 0.1) > 90
        end(it, teleop)
        it.run(0.7)
        assert it.stage.driven_ms(since + STOPS) == 0
        if why:
            assert why in it.loop.processes["ros2"].told["goal"]


def test_without_a_publisher_that_is_known_there_is_no_hand_and_the_robot_is_shown_fifty_times_a_second_at_most() -> (
    None
):
    with ros_stage() as it:
        it.desk.say(Program("sdk"), 0.3, 0.0, it.now)  # no token has its id
        before = dict(it.desk.counts)
        heard = it.loop.newest["odom"].seq
        it.run(1.0)
        said = it.loop.newest["odom"].seq - heard  # a hundred times a second; every second one goes on
        assert it.desk.counts["odom"] - before["odom"] == pytest.approx(said / 2, abs=1)
        odom, message = it.loop.newest["odom"], it.desk.published["odom"]
        assert message.pose.pose.position.x == pytest.approx(odom.x, abs=1e-3)
        assert {"tf", "tf_static", "robot_description", "diagnostics", "battery_state"} <= it.desk.published.keys()
        it.run(0.1)
        assert "cmd_vel/ros2" not in it.loop.newest  # the robot's own chain hears nothing of it
        assert "no token has the id of their publisher" in it.loop.processes["ros2"].told["publisher"]
        assert sum(name.startswith("range/") for name in it.desk.published) == len(it.loop.settings.robot.sensor_types)
