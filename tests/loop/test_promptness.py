"""No service waits for its own pace: from what a board says to what another is told, in simulated time."""

from collections import Counter
from typing import Any, Final

import pytest

from giraff_core.timer import LEAST_GAP
from giraff_schemas.topics import CMD_VEL, OPERATOR_CMD_VEL, TICK, WHEELS
from giraff_schemas.wire import BoardKind, Frame, RangeFrame, ResetCause, SpeedFrame, TiltFrame
from giraff_sim.hosts.process import Observer, Process
from giraff_sim.settings import Services
from giraff_sim.world.world import STEP_US
from tests.loop.loops import FULL_TILT, arm, closed_loop, hold
from tests.loop.operators import scene
from tests.sim.robots import proving_room
from tests.support.floods import RATE, FloodingJoystick

PROMPT_US: Final = 3000
"""From a frame's arrival at one service to the drive frame that follows from it."""


class Watch(Observer):
    """Notes when frames come and go, and how often each kind of sample is published."""

    def __init__(self) -> None:
        self.came: list[tuple[int, TiltFrame | RangeFrame]] = []
        self.went: list[tuple[int, SpeedFrame]] = []
        self.said_by: Counter[str] = Counter()

    def read(self, process: Process, frame: Frame) -> None:
        if isinstance(frame, TiltFrame | RangeFrame):
            self.came.append((process.loop.agenda.now_us, frame))

    def wrote(self, process: Process, frame: Frame) -> None:
        if isinstance(frame, SpeedFrame):
            self.went.append((process.loop.agenda.now_us, frame))

    def said(self, process: Process, sample: Any) -> None:
        self.said_by[f"{process.name} {type(sample).__name__}"] += 1

    def forget(self) -> None:
        self.came.clear()
        self.went.clear()
        self.said_by.clear()

    def first_zero_us(self) -> int:
        return next(at for at, frame in self.went if (frame.left_um_s, frame.right_um_s) == (0, 0))


def test_a_level_hand_is_at_the_motors_board_as_soon_as_its_frame_has_come() -> None:
    watch = Watch()
    with closed_loop(proving_room(), step_us=STEP_US, observer=watch) as loop:
        arm(loop)
        for phase_ms in range(0, 20, 3):
            hold(loop, x=FULL_TILT)
            loop.run(0.2 + phase_ms * 1e-3)
            watch.forget()
            hold(loop)
            loop.run(0.1)
            level_us = next(at for at, frame in watch.came if isinstance(frame, TiltFrame) and abs(frame.x) < 100)
            assert watch.went[0][1].left_um_s > 0
            assert watch.first_zero_us() - level_us <= PROMPT_US


@pytest.mark.parametrize("phase_ms", [0, 8, 16])
def test_a_wall_stops_the_robot_as_soon_as_its_echo_has_come(phase_ms: int) -> None:
    """Wherever between two commands of the hand it comes."""
    watch = Watch()
    with closed_loop(proving_room(), step_us=STEP_US, observer=watch) as loop:
        loop.run(0.1 + phase_ms * 1e-3)
        loop.simulation.reset(BoardKind.JOYSTICK, ResetCause.EXTERNAL)
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(0.7)
        place = loop.simulation.world.plant.pose
        loop.simulation.world.room.add_wall("sudden", [(place.x + 0.55, -1.0), (place.x + 0.55, 1.0)])
        watch.forget()
        loop.run(0.4)
    short_us = next(at for at, frame in watch.came if isinstance(frame, RangeFrame) and 0 < frame.echo_us < 2500)
    assert watch.first_zero_us() - short_us <= PROMPT_US


def test_nobody_speaks_twice_as_often_for_it() -> None:
    """A second of driving where nothing is near: each early turn puts off the one by pace."""
    watch = Watch()
    with closed_loop(proving_room(), step_us=STEP_US, observer=watch) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT / 2.0)
        loop.run(1.0)
        watch.forget()
        loop.run(1.0)
    assert abs(watch.said_by["joystick DriveCommand"] - OPERATOR_CMD_VEL.rate_hz) <= 1
    assert CMD_VEL.rate_hz - 1 <= watch.said_by["guard GuardedCommand"] <= CMD_VEL.rate_hz + 10
    assert abs(watch.said_by["base Tick"] - TICK.rate_hz) <= 1
    assert len(watch.went) <= 100 + 60 + 1  # an answer to each report, and a frame for each command


def test_a_flood_of_who_drives_makes_few_turns_and_no_delay() -> None:
    watch, flood = Watch(), Services(joystick=FloodingJoystick)
    with closed_loop(proving_room(), services=flood, step_us=STEP_US, observer=watch) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT / 2.0)
        loop.run(1.0)
        watch.forget()
        loop.run(1.0)
        assert watch.said_by["joystick DriveCommand"] > RATE
        assert watch.said_by["guard GuardedCommand"] <= 1.0 / LEAST_GAP + 20  # and what readings take away
        assert len(watch.went) <= 2 * WHEELS.rate_hz + 1
        watch.forget()
        hold(loop)
        loop.run(0.1)
    level_us = next(at for at, frame in watch.came if isinstance(frame, TiltFrame) and abs(frame.x) < 100)
    assert watch.first_zero_us() - level_us <= PROMPT_US + LEAST_GAP * 1e6


def test_without_a_hand_the_robot_side_keeps_its_pace() -> None:
    watch = Watch()
    with closed_loop(proving_room(), step_us=STEP_US, observer=watch) as loop:
        arm(loop)
        loop.kill("joystick")
        watch.forget()
        loop.run(1.0)
    assert abs(watch.said_by["guard GuardedCommand"] - CMD_VEL.rate_hz) <= 1


def test_a_press_is_told_in_the_turn_that_it_makes_due() -> None:
    with scene() as it:
        for phase in range(3):
            it.run(0.7 + 0.008 * phase)
            assert it.loop.newest["cmd_vel/keyboard"].neutral
            it.type(b"w")
            it.loop.step()
            assert not it.loop.newest["cmd_vel/keyboard"].neutral
