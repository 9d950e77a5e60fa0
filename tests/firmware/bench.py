"""A board on the bench: its serial line and its pins, millisecond by millisecond of simulated time."""

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from giraff_base.drives.wheels.config import by_levels
from giraff_core.robot import RobotConfig
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import (
    ECHO_MAX_AGE_MS,
    ConfigureFrame,
    DriveFrame,
    EstopFrame,
    Frame,
    Refusal,
    SpeedFrame,
    WheelsFrame,
    Wiring,
)
from giraff_schemas.wires.balancer import BalanceDriveFrame
from giraff_sim.board import Board
from tests.support.robots import BY_SPEED, ROBOT

FrameT = TypeVar("FrameT", bound=Frame)
CommandT = TypeVar("CommandT", DriveFrame, SpeedFrame, BalanceDriveFrame)


class Bench:
    """Runs a board and collects its frames."""

    def __init__(self, board: Board) -> None:
        self.board = board
        self.now_ms = 0
        self.frames: list[Frame] = []
        self.arrived_ms: list[int] = []
        """When each frame had arrived, whole."""
        self.before_each_ms: Callable[[], None] = lambda: None
        self._decoder = Decoder(board.type.frames)

    @property
    def model(self) -> Any:
        """The board's struct board_model."""
        return self.board.model

    @property
    def damaged(self) -> int:
        """Frames of the board that came damaged: there is no noise, so there are none."""
        return self._decoder.crc_errors + self._decoder.shape_errors

    def run(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            self.before_each_ms()
            self.now_ms += 1
            self.board.run(self.now_ms * 1000)
            if frames := self._decoder.feed(self.board.read()):
                self.frames += frames
                self.arrived_ms += [self.now_ms] * len(frames)

    def send(self, frame: Frame) -> None:
        self.send_bytes(encode(frame.pack()))

    def send_bytes(self, data: bytes) -> None:
        assert self.board.write(data) == len(data)

    def all(self, kind: type[FrameT]) -> list[FrameT]:
        return [frame for frame in self.frames if isinstance(frame, kind)]

    def arrivals(self, kind: type[Frame]) -> list[int]:
        """When, in ms, each frame of a kind had arrived."""
        return [at for at, frame in zip(self.arrived_ms, self.frames, strict=True) if isinstance(frame, kind)]

    def last(self, kind: type[FrameT]) -> FrameT:
        return next(frame for frame in reversed(self.frames) if isinstance(frame, kind))

    def forget(self) -> None:
        """Begin to collect anew."""
        self.frames.clear()
        self.arrived_ms.clear()


class BaseBench(Bench):
    """The base board, and a host that knows how to drive it."""

    def __init__(self, board: Board, starts_ms: int = 15) -> None:
        """`starts_ms`: until it has reported."""
        super().__init__(board)
        self.seq = 0
        self.run(starts_ms)

    def wheels(self) -> WheelsFrame:
        return self.last(WheelsFrame)

    def duties(self) -> tuple[float, ...]:
        """What the motors got in the last millisecond, PWM counts on average."""
        return self.model.motor[0].drive, self.model.motor[1].drive

    def configure_frame(self, **changes: int) -> ConfigureFrame:
        wheels = self.wheels()
        # No test's level is the stall level: wheels here only turn when a test turns them.
        good = msgspec.structs.replace(
            by_levels(Wiring(0), 70, 255), boot_id=wheels.boot_id, board_ms=wheels.board_ms, session=7
        )
        return msgspec.structs.replace(good, **changes)

    def drive_frame(self, left: int, right: int, **changes: int) -> DriveFrame:
        """The next frame of a healthy host, made from the newest telemetry, but for `changes`."""
        self.seq = (self.seq + 1) & 0xFFFF
        wheels = self.wheels()
        good = DriveFrame(
            seq=self.seq,
            boot_id=wheels.boot_id,
            board_ms=wheels.board_ms,
            left_level=left,
            right_level=right,
        )
        return msgspec.structs.replace(good, **changes)

    def estop_frame(self, **changes: int) -> EstopFrame:
        """A healthy host's that engages, made from the newest telemetry, but for `changes`."""
        wheels = self.wheels()
        good = EstopFrame(seq=0, boot_id=wheels.boot_id, board_ms=wheels.board_ms, session=wheels.session, engage=1)
        return msgspec.structs.replace(good, **changes)

    def configure(self, **changes: int) -> None:
        """Open a session and wait until telemetry tells of it."""
        self.send(self.configure_frame(**changes))
        self.run(22)  # a frame of 6 ms, up to 10 ms until the next telemetry, and 6 ms of that

    def drive(self, left: int, right: int, milliseconds: int = 20) -> None:
        """Ask for levels every 20 ms."""
        for _ in range(milliseconds // 20):
            self.send(self.drive_frame(left, right))
            self.run(20)

    def stopped_after_ms(self, each_ms: Callable[[], None] = lambda: None) -> int:
        """How long from now the motors still get something, while the host does `each_ms`."""
        began = self.now_ms
        while self.duties() != (0, 0):
            assert self.now_ms - began < 2000, "the motors are still driven"
            each_ms()
            self.run(1)
        return self.now_ms - began

    def start(self, left: int = 0, right: int = 0) -> None:
        """From power-on to driving."""
        self.configure()
        self.drive(0, 0)
        self.drive(left, right, 60)
        assert self.duties() == (left, right)


ACCELERATION = 1.2
"""m/s², at which its wheels may speed up."""
_MOTOR_MS = 150.0


class SpeedBench(BaseBench):
    """The base board, wheels that turn by what their motors get, and a host that asks for their speeds."""

    def __init__(self, board: Board, robot: RobotConfig = ROBOT, starts_ms: int = 15) -> None:
        self.robot = robot
        self.strength = [1.0, 1.0]
        """Of the speed that the robot's file expects of each motor."""
        self.speed = [0.0, 0.0]
        """m/s of each wheel."""
        self.pull = [0.0, 0.0]
        """m/s at which something pulls each wheel beside its motor."""
        self.hands: list[Callable[[int], float] | None] = [None, None]
        """What turns each wheel in the place of its motor: m/s, at a time in ms."""
        self.volts(BY_SPEED.battery_nominal, board)
        super().__init__(board, starts_ms)
        self.before_each_ms = self._turn

    def volts(self, volts: float, board: Board | None = None) -> None:
        """Give the battery so many."""
        self._voltage_ratio = volts / BY_SPEED.battery_nominal
        count = BY_SPEED.battery_volts_per_count
        (board or self.board).model.battery_volts = (volts / count + 0.5) * 5 / 1024
        (board or self.board).model.driver_volts = volts

    def _turn(self) -> None:
        most = self.robot.max_wheel_speed / BY_SPEED.max_level
        moved = self.robot.ticks_per_metre * self.board.type.states_per_tick / 1000
        for number, motor in enumerate(self.model.motor):
            if (hand := self.hands[number]) is not None:
                speed = hand(self.now_ms)
            else:
                aim = motor.drive * most * self.strength[number] * self._voltage_ratio + self.pull[number]
                speed = self.speed[number] + (aim - self.speed[number]) / _MOTOR_MS
            self.speed[number] = speed
            motor.position += speed * moved

    def configure_frame(self, **changes: int) -> ConfigureFrame:
        wheels = self.wheels()
        good = msgspec.structs.replace(
            BY_SPEED.board_settings(self.robot, ACCELERATION),
            boot_id=wheels.boot_id,
            board_ms=wheels.board_ms,
            session=7,
        )
        return msgspec.structs.replace(good, **changes)

    def speed_frame(self, left: float, right: float, **changes: int) -> SpeedFrame:
        """The next frame of a healthy host, made from the newest telemetry, but for `changes`; m/s."""
        self.seq = (self.seq + 1) & 0xFFFF
        wheels = self.wheels()
        good = SpeedFrame(
            seq=self.seq,
            boot_id=wheels.boot_id,
            board_ms=wheels.board_ms,
            left_um_s=round(left * 1e6),
            right_um_s=round(right * 1e6),
        )
        return msgspec.structs.replace(good, **changes)

    def go(self, left: float, right: float, milliseconds: int = 20, each_ms: Callable[[], None] = lambda: None) -> None:
        """Ask for speeds, m/s, every 20 ms; `each_ms` looks at what comes of it."""
        for millisecond in range(milliseconds):
            if millisecond % 20 == 0:
                self.send(self.speed_frame(left, right))
            self.run(1)
            each_ms()

    def begin(self, left: float = 0.0, right: float = 0.0, milliseconds: int = 1500, **settings: int) -> None:
        """From power-on to going at these speeds."""
        self.configure(**settings)
        self.go(0.0, 0.0)
        if left or right:
            self.go(left, right, milliseconds)


def out_of_place(good: CommandT, arrival: int) -> list[tuple[str, CommandT, Refusal]]:
    """Ways in which a frame that drives can be of another boot, time or place in the row. `arrival`: of `good`, ms."""
    return [
        ("another boot", msgspec.structs.replace(good, boot_id=good.boot_id + 1), Refusal.BOOT_ID),
        ("no boot", msgspec.structs.replace(good, boot_id=0), Refusal.BOOT_ID),
        ("too old", msgspec.structs.replace(good, board_ms=arrival - ECHO_MAX_AGE_MS - 1), Refusal.STALE),
        ("far too old", msgspec.structs.replace(good, board_ms=(arrival - (1 << 31)) & 0xFFFFFFFF), Refusal.STALE),
        ("from the future", msgspec.structs.replace(good, board_ms=arrival + 1), Refusal.STALE),
        ("the last one again", msgspec.structs.replace(good, seq=good.seq - 1), Refusal.SEQUENCE),
        ("an earlier one", msgspec.structs.replace(good, seq=good.seq - 2), Refusal.SEQUENCE),
        ("half the numbers ahead", msgspec.structs.replace(good, seq=good.seq - 1 + 0x8000), Refusal.SEQUENCE),
    ]
