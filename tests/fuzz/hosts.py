"""Fuzzes the host's side of each serial link: through a pseudo terminal into BoardLink, decoder and policy."""

import math
import os
import random
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

import msgspec

from giraff_base.estop import RELEASED
from giraff_base.policy import BasePolicy
from giraff_core.live import Live
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_node.boards.board_link import BoardLink
from giraff_ranger.policy import RangerPolicy
from giraff_schemas.boards import BOARDS
from giraff_schemas.framing import encode
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.wire import (
    FRAME_CLASSES,
    PROTOCOL_HASH,
    BoardKind,
    DriveFrame,
    Frame,
    HelloFrame,
    RangeFrame,
    ResetCause,
    TiltFrame,
    WheelsFrame,
)
from tests.fuzz.growth import Growth
from tests.support.operators import said
from tests.support.robots import BASE, ROBOT

_BAUD: Final = 115200
_FRAMES: Final[dict[BoardKind, type[Frame]]] = {
    BoardKind.BASE: WheelsFrame,
    BoardKind.JOYSTICK: TiltFrame,
    BoardKind.RANGER: RangeFrame,
}
_AT_ONCE: Final = 2000  # bytes: what a terminal holds without a reader
_TURN: Final = 0.01  # s

Turn = Callable[[list[Frame], float], list[Frame]]
"""What a service does with its board's frames at a time (s), and sends down."""


class HostCounted(msgspec.Struct, kw_only=True):
    """What came through to a service."""

    board: str
    bytes: int = 0
    frames: int = 0
    line_errors: int = 0
    opened: int = 0
    growth_bytes: int = 0


def fuzz_host_side(board: str, wanted: int, seed: int, growth: Growth | None = None) -> HostCounted:
    """Throw `wanted` bytes at a service from its board; AssertionError when it asks for motion."""
    chance = random.Random(f"{seed}/{board}/host")
    kind = BoardKind[board.upper()]
    turn = {BoardKind.BASE: _base, BoardKind.JOYSTICK: _joystick, BoardKind.RANGER: _ranger}[kind]()
    counted = HostCounted(board=board)
    with _terminal() as (ours, path):
        link, now = BoardLink(path, BOARDS[kind]), 0.0
        while counted.bytes < wanted:
            now += _TURN
            data = b""
            while len(data) < _AT_ONCE:
                data += _thrown(kind, chance)
            counted.bytes += os.write(ours, data[:_AT_ONCE])
            frames = link.poll(now)
            counted.frames += len(frames)
            for frame in turn(frames, now):
                assert not isinstance(frame, DriveFrame) or (frame.left_level, frame.right_level) == (0, 0), frame
                link.send(frame)
            while _drained(ours):
                pass
            if growth is not None:
                growth.look(counted.bytes / wanted)
                counted.growth_bytes = growth.bytes
        counted.line_errors, counted.opened = link.line_errors, link.opened
        link.close()
    assert counted.line_errors > 0, counted
    return counted


@contextmanager
def _terminal() -> Iterator[tuple[int, str]]:
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    os.set_blocking(ours, False)
    try:
        yield ours, os.ttyname(theirs)
    finally:
        os.close(ours)
        os.close(theirs)


def _drained(ours: int) -> bytes:
    try:
        return os.read(ours, 65536)
    except BlockingIOError:
        return b""


def _thrown(kind: BoardKind, chance: random.Random) -> bytes:
    """Noise, a frame of any kind with any content, a damaged one, or the hello that makes the rest count."""
    share = chance.random()
    if share < 0.3:
        return chance.randbytes(chance.randrange(1, 80))
    if share < 0.35:
        hello = HelloFrame(
            seq=chance.randrange(1 << 16),
            board_us=chance.randrange(1 << 32),
            board=kind,
            protocol_hash=PROTOCOL_HASH,
            boot_id=chance.randrange(1 << 32),
            reset_cause=ResetCause.EXTERNAL,
        )
        return b"\0" + encode(hello.pack())
    frame_class: type[Frame] = _FRAMES[kind] if share < 0.85 else chance.choice(list(FRAME_CLASSES.values()))
    if frame_class is HelloFrame:
        return b""  # a random one is another board's: the link would be down for most of the time
    frame = bytearray(encode(bytes((frame_class.type,)) + chance.randbytes(frame_class.layout.size - 1)))
    if share > 0.75:
        frame[chance.randrange(len(frame))] = chance.randrange(256)
    return b"\0" + bytes(frame)


def _base() -> Turn:
    policy = BasePolicy(Live(BASE), ROBOT, RELEASED)
    policy.on_link_opened(session=7)

    def turn(frames: list[Frame], now: float) -> list[Frame]:
        robot_time = RobotTime(epoch=7, robot_ns=round((now + 1000.0) * 1e9))
        for sample in policy.on_frames(frames, robot_time):
            assert isinstance(sample, Wheels)
            assert math.isfinite(sample.left_velocity + sample.right_velocity), sample
        frame = policy.next_frame(robot_time)
        assert not policy.state().driving
        policy.battery()
        return [frame] if frame is not None else []

    return turn


def _joystick() -> Turn:
    policy = JoystickPolicy(Live(JoystickConfig(port="unused")), ROBOT, "joystick-1")

    def turn(frames: list[Frame], now: float) -> list[Frame]:
        for frame in frames:
            if isinstance(frame, TiltFrame):
                policy.on_frame(frame, now)
        command = said(policy, now)
        # Without a lease nobody obeys it, and what it asks is never more than the robot can.
        assert abs(command.linear_x) <= ROBOT.max_wheel_speed, command
        assert abs(command.angular_z) <= ROBOT.max_angular_speed, command
        assert command.source == "hand" or command.neutral, command
        return []

    return turn


def _ranger() -> Turn:
    policy = RangerPolicy(ROBOT)

    def turn(frames: list[Frame], _now: float) -> list[Frame]:
        for frame in frames:
            if isinstance(frame, RangeFrame):
                reading = policy.on_frame(frame)
                assert reading is None or reading.range is None or 0.0 < reading.range < 10.0, reading
        assert len(policy.faults) <= 1 << 8, "one for each number that fits a frame"
        return []

    return turn
