"""What the joystick says when its sensor, its board or the robot is not there."""

import math
from typing import cast

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.live import Live
from giraff_core.tilt.clutch import BOUNCE
from giraff_joystick.policy import BOARD_SILENCE, JoystickPolicy
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.messages import DriveCommand, RobotTime, Tick, Tilt
from giraff_schemas.trouble import NO_TROUBLE
from giraff_schemas.wire import FrameType, TickFrame, TiltFrame, TiltStatus
from tests.support.operators import said
from tests.unit.joystick.frames import ANGLE, EPOCH, ROBOT, SOURCE, tilt_frame


def policy() -> JoystickPolicy:
    return JoystickPolicy(Live(SOURCE), ROBOT, "me")


def after(frame: TiltFrame) -> tuple[Tilt, DriveCommand]:
    joystick = policy()
    return joystick.on_frame(frame, 10.0), said(joystick, 10.0)


def assert_fault(command: DriveCommand, *words: str) -> None:
    assert command.neutral
    assert command.source == "fault"
    for word in words:
        assert word in str(command.reason)


@pytest.fixture
def joystick() -> JoystickPolicy:
    return policy()


def test_a_sound_reading_is_a_hand_with_the_tick_of_its_frame() -> None:
    tilt, command = after(tilt_frame(7.0, 0.0, 6.87, robot_ns=5))
    assert (tilt.x, tilt.y, tilt.z, tilt.status) == (7.0, 0.0, 6.87, "running")
    assert (command.source, str(command.reason)) == ("hand", "")
    assert command.linear_x == pytest.approx(0.3)
    assert command.tick == tilt.tick == RobotTime(epoch=EPOCH, robot_ns=5)


def test_a_flat_hand_is_neutral_and_no_fault() -> None:
    _, command = after(tilt_frame())
    assert command.neutral
    assert command.source == "hand"


@pytest.mark.parametrize(
    ("status", "name", "words"),
    [
        (TiltStatus.STARTING, "starting", ("starting", "wait")),
        (TiltStatus.BUS_FAULT, "bus_fault", ("no reading", "shield")),
        (TiltStatus.WRONG_CHIP, "wrong_chip", ("BNO055", "shield")),
        (TiltStatus.SELF_TEST_FAILED, "self_test_failed", ("self-test", "replace")),
        (TiltStatus.SYSTEM_ERROR, "system_error", ("SYS_ERR 9", "unplug")),
        (200, "system_error", ("SYS_ERR 9", "unplug")),
    ],
)
def test_a_sensor_that_is_not_running_is_a_fault_with_cause_and_way_out(
    status: int, name: str, words: tuple[str, ...]
) -> None:
    tilt, command = after(tilt_frame(9.5, status=status, sys_error=9))
    assert tilt.status == name
    assert_fault(command, *words)
    assert command.tick == tilt.tick


def test_the_sensor_is_the_services_own_fault_and_the_robot_or_the_hand_is_not(joystick: JoystickPolicy) -> None:
    joystick.on_frame(tilt_frame(9.5, status=TiltStatus.BUS_FAULT), 10.0)
    assert str(joystick.sensor_fault) == str(said(joystick, 10.0).reason)
    joystick.on_frame(tilt_frame(7.0, 0.0, 6.87), 10.1)
    assert joystick.sensor_fault == NO_TROUBLE
    joystick.on_frame(tilt_frame(epoch=0), 10.2)
    assert_fault(said(joystick, 10.2), "robot")
    assert joystick.sensor_fault == NO_TROUBLE


def test_every_status_of_the_wire_has_its_name() -> None:
    assert [after(tilt_frame(status=status))[0].status for status in TiltStatus] == [
        status.name.lower() for status in TiltStatus
    ]


def test_an_all_zero_vector_is_a_bus_fault_though_the_board_calls_it_running() -> None:
    tilt, command = after(tilt_frame(0.0, 0.0, 0.0))
    assert tilt.status == "bus_fault"
    assert_fault(command, "without gravity", "shield")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_value_that_is_no_number_is_a_bus_fault(axis: str, value: float) -> None:
    frame = msgspec.structs.replace(tilt_frame(9.5), **{axis: value})
    tilt, command = after(frame)
    assert (tilt.x, tilt.y, tilt.z, tilt.status) == (0.0, 0.0, 0.0, "bus_fault")
    assert_fault(command, "shield")


def test_what_is_too_weak_for_gravity_has_no_direction() -> None:
    joystick = JoystickPolicy(Live(ANGLE), ROBOT, "me")
    joystick.on_frame(tilt_frame(0.5, 0.0, 0.1), 0.0)
    assert_fault(said(joystick, 0.0), "falling", "hold")


def test_a_board_that_has_not_heard_the_robot_is_a_fault_without_a_tick() -> None:
    tilt, command = after(tilt_frame(9.5, epoch=0))
    assert tilt.status == "running"
    assert tilt.tick is None
    assert command.tick is None
    assert_fault(command, "not heard the robot", "check")


def test_a_board_whose_ticks_have_ended_has_lost_the_robot(joystick: JoystickPolicy) -> None:
    sources = []
    for step in range(27):
        now = step * 0.02
        joystick.on_frame(tilt_frame(9.5 + step % 2 / 10, robot_ns=7), now)
        sources.append(said(joystick, now).source)
    assert sources == ["hand"] * 26 + ["fault"]  # 0.5 s after the first frame with that tick
    assert_fault(said(joystick, 0.52), "no tick", "base", "network", "cable")
    joystick.on_frame(tilt_frame(9.5, robot_ns=8), 0.54)
    assert said(joystick, 0.54).source == "hand"


def test_before_the_first_frame_there_is_no_board_and_no_tick(joystick: JoystickPolicy) -> None:
    assert_fault(said(joystick, 0.0), SOURCE.port, "cable")
    assert said(joystick, 0.0).tick is None
    assert joystick.lost(0.0) == Tilt(x=0.0, y=0.0, z=0.0, status="no_board", tick=None)


def test_a_silent_board_is_a_fault_with_its_last_tick(joystick: JoystickPolicy) -> None:
    tilt = joystick.on_frame(tilt_frame(9.5), 10.0)
    assert said(joystick, 10.0 + BOARD_SILENCE - 0.001).source == "hand"
    assert joystick.lost(10.0 + BOARD_SILENCE - 0.001) is None
    for late in (0.001, 1.0, 100.0):
        command, lost = said(joystick, 10.0 + BOARD_SILENCE + late), joystick.lost(10.0 + BOARD_SILENCE + late)
        assert_fault(command, "no frame", SOURCE.port, "cable")
        assert lost is not None
        assert lost.status == "no_board"
        assert command.tick == lost.tick == tilt.tick
    joystick.on_frame(tilt_frame(9.5, robot_ns=2_000), 200.0)
    assert said(joystick, 200.0).source == "hand"


def test_a_repeated_command_keeps_the_tick_of_its_frame(joystick: JoystickPolicy) -> None:
    joystick.on_frame(tilt_frame(9.5, robot_ns=1), 0.0)
    joystick.on_tick(Tick(epoch=EPOCH, robot_ns=99), 0.0)
    assert said(joystick, 0.0) == said(joystick, 0.1)
    assert said(joystick, 0.1).tick == RobotTime(epoch=EPOCH, robot_ns=1)


NOISY = [(500 + n % 3, n % 2, 840 - n % 2) for n in range(60)]
BEFORE = {
    "repeated": [(500, 0, 840)] * 9,
    "frozen": [(500, 0, 840)] * 20,
    "knocked": [*NOISY, (3000, 0, 980), (500, 0, 840)],
    "shaken": [*NOISY, *[(2000 * (-1) ** n, 0, 980) for n in range(6)]],
    "fallen": [*NOISY, (0, 5, 0)],
    "lying": NOISY[:40],
    "laid down": NOISY,
}
"""Counts of the sensor, the last of them before readings were missing."""
AFTER = {
    "the same": [(500, 0, 840)] * 4 + NOISY,
    "a knock": [(3000, 0, 980), (500, 0, 840), *NOISY[:20]],
    "the other way": [(-500, 0, 840), (-501, 0, 840), (-500, 1, 840)],
}


@pytest.mark.parametrize("gap", ["silence", "a sensor's fault"])
@pytest.mark.parametrize("after", AFTER)
@pytest.mark.parametrize("before", BEFORE)
def test_after_missing_readings_only_what_comes_now_tells_a_hand(before: str, after: str, gap: str) -> None:
    joystick, fresh = (JoystickPolicy(Live(ANGLE), ROBOT, "me") for _ in range(2))
    now = 0.0

    def read(counts: tuple[int, int, int], *by: JoystickPolicy) -> list[DriveCommand]:
        nonlocal now
        now += 0.02
        x, y, z = (value / 100 for value in counts)
        for each in by:
            each.on_frame(tilt_frame(x, y, z, robot_ns=round(now * 1e9)), now)
        return [said(each, now) for each in by]

    for counts in BEFORE[before]:
        read(counts, joystick)
    if gap == "silence":
        now += BOARD_SILENCE
    else:
        joystick.on_frame(tilt_frame(status=TiltStatus.BUS_FAULT), now)
    for counts in AFTER[after]:
        told, expected = read(counts, joystick, fresh)
        assert told == expected


@pytest.mark.parametrize("gap", ["silence", "a sensor's fault"])
def test_after_missing_readings_no_attitude_of_before_becomes_the_zero(gap: str) -> None:
    """The clutch was pressed and held still; it is let go at once when the sensor is read again."""
    joystick, now = JoystickPolicy(Live(ANGLE), ROBOT, "me"), 0.0
    for step in range(30):
        now += 0.02
        joystick.on_frame(tilt_frame(5.0 + step % 2 / 100, 0.0, 8.4, button=1, robot_ns=step), now)
    if gap == "silence":
        now += BOARD_SILENCE + 0.02
    else:
        joystick.on_frame(tilt_frame(status=TiltStatus.BUS_FAULT, button=1), now)
    for step in range(round(BOUNCE / 0.02) + 1):
        now += 0.02
        joystick.on_frame(tilt_frame(5.0 + step % 2 / 100, 0.0, 8.4, robot_ns=100 + step), now)
    assert_fault(said(joystick, now), "before the sensor had been read for 0.2 s", "old zero stays")


def test_a_board_reset_passes_through_its_faults_and_drives_again(joystick: JoystickPolicy) -> None:
    sources = []
    for frame in (
        tilt_frame(7.0, seq=900, boot_id=1),
        tilt_frame(7.0, seq=0, boot_id=2, epoch=0, status=TiltStatus.STARTING),
        tilt_frame(7.0, seq=1, boot_id=2, epoch=0),
        tilt_frame(7.0, seq=2, boot_id=2),
    ):
        joystick.on_frame(frame, 0.0)
        sources.append(said(joystick, 0.0).source)
    assert sources == ["hand", "fault", "fault", "hand"]


def test_frames_across_the_wrap_of_their_sequence_all_count(joystick: JoystickPolicy) -> None:
    for step, seq in enumerate((65534, 65535, 0, 1)):
        joystick.on_frame(tilt_frame(4.5 + step, seq=seq), 0.02 * step)
        assert said(joystick, 0.02 * step).linear_x == pytest.approx(0.6 * step / 5)


def test_ticks_go_down_as_they_are_and_their_sequence_wraps(joystick: JoystickPolicy) -> None:
    ticks = (joystick.on_tick(Tick(epoch=EPOCH, robot_ns=ns), 0.0) for ns in range(0x10001))
    frames = [frame for frame in ticks if frame is not None]
    assert [frame.seq for frame in (frames[0], frames[-3], frames[-2], frames[-1])] == [1, 65535, 0, 1]
    assert Decoder().feed(encode(frames[5].pack())) == [TickFrame(seq=6, epoch=EPOCH, robot_ns=5)]


bodies = st.binary(min_size=TiltFrame.layout.size - 1, max_size=TiltFrame.layout.size - 1)


@given(st.lists(bodies, min_size=1, max_size=5))
def test_whatever_the_board_sends_the_command_is_sane(payloads: list[bytes]) -> None:
    """Each payload is a frame with a right checksum and any contents at all."""
    joystick = policy()
    decoder = Decoder()
    for payload in payloads:
        (frame,) = decoder.feed(encode(bytes((FrameType.TILT,)) + payload))
        tilt = joystick.on_frame(cast(TiltFrame, frame), 0.0)
        command = said(joystick, 0.0)
        fastest_wheel = abs(command.linear_x) + abs(command.angular_z) * ROBOT.track_width / 2
        assert fastest_wheel <= ROBOT.max_wheel_speed + 1e-9
        assert (command.source == "fault") == bool(command.reason)
        assert command.neutral or (tilt.status == "running" and command.tick is not None)
        assert command.tick == tilt.tick
