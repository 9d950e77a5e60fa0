"""What the operator's tilt asks of the robot. Axes of the sensor: x grows when tilted forward, y to the left."""

from __future__ import annotations

import math
from typing import Final

from giraff_joystick.config import JoystickConfig
from giraff_node.robot import RobotConfig
from giraff_schemas.messages import DriveCommand, RobotTime, Tick, Tilt, TiltStatus
from giraff_schemas.wire import TILT_LSB_PER_M_S2, TickFrame, TiltFrame
from giraff_schemas.wire import TiltStatus as WireStatus

BOARD_SILENCE: Final = 0.2
"""s without a frame after which the board counts as lost; ten of its frames."""

# The published curve in PWM counts is 14a - 63, 0 at the first of these accelerations and 70 at the second.
SOURCE_START: Final = 4.5  # m/s²
SOURCE_FULL: Final = 9.5  # m/s²

FREE_FALL: Final = 2.0
"""m/s², a fifth of gravity. Whatever is shorter is no gravity, and its direction no tilt."""

_STATUSES: Final[dict[int, TiltStatus]] = {
    WireStatus.RUNNING: "running",
    WireStatus.STARTING: "starting",
    WireStatus.BUS_FAULT: "bus_fault",
    WireStatus.WRONG_CHIP: "wrong_chip",
    WireStatus.SELF_TEST_FAILED: "self_test_failed",
    WireStatus.SYSTEM_ERROR: "system_error",
}

_REASONS: Final[dict[TiltStatus, str]] = {
    "starting": "the tilt sensor is starting; wait a second",
    "bus_fault": (
        "the tilt sensor gives no reading, or one without gravity; press its shield firmly onto the joystick board "
        "and reset the board"
    ),
    "wrong_chip": "the chip that answers is not a BNO055; put the 9-axes shield on the joystick board",
    "self_test_failed": (
        "the tilt sensor fails its self-test; hold it still and unplug the joystick board for a second, "
        "or replace the shield"
    ),
    "system_error": (
        "the tilt sensor reports an error (SYS_STATUS {frame.sys_status}, SYS_ERR {frame.sys_error}); "
        "unplug the joystick board for a second"
    ),
}


class JoystickPolicy:
    """Turns the board's frames into samples. Times are seconds of any one monotonic clock."""

    def __init__(self, config: JoystickConfig, robot: RobotConfig) -> None:
        self._config = config
        self._robot = robot
        self._heard = -math.inf
        self._tick: RobotTime | None = None
        self._silence = (
            f"no frame from the joystick board on {config.port} for {BOARD_SILENCE:g} s; check its cable and power"
        )
        self._command = neutral(self._silence, None)
        self._tick_seq = 0

    def on_tick(self, tick: Tick) -> TickFrame:
        """The robot's clock as it goes down to the board, which puts the newest one into each frame."""
        self._tick_seq = (self._tick_seq + 1) & 0xFFFF
        return TickFrame(seq=self._tick_seq, epoch=tick.epoch, robot_ns=tick.robot_ns)

    def on_frame(self, frame: TiltFrame, now: float) -> Tilt:
        """The reading in `frame`. It is what `command` stands on until the next one."""
        tilt = reading(frame)
        self._heard = now
        self._tick = tilt.tick
        reason = _fault(tilt, frame)
        self._command = neutral(reason, tilt.tick) if reason else wish(tilt, self._config, self._robot)
        return tilt

    def lost(self, now: float) -> Tilt | None:
        """What stands for a reading while the board is silent; None while it is not."""
        return Tilt(x=0.0, y=0.0, z=0.0, status="no_board", tick=self._tick) if self._silent(now) else None

    def command(self, now: float) -> DriveCommand:
        """What the newest frame asks, with that frame's tick however often it is repeated."""
        return neutral(self._silence, self._tick) if self._silent(now) else self._command

    def farewell(self) -> DriveCommand:
        """The last command of a service that ends: the robot need not wait for silence to stop."""
        return neutral("the joystick service has ended; start it again", self._tick)

    def _silent(self, now: float) -> bool:
        return now - self._heard > BOARD_SILENCE


def neutral(reason: str, tick: RobotTime | None) -> DriveCommand:
    """Stop, because the operator's side has lost the hand."""
    return DriveCommand(linear_x=0.0, angular_z=0.0, source="fault", reason=reason, tick=tick)


def reading(frame: TiltFrame) -> Tilt:
    """A frame in SI units. A vector without any gravity is the bus's fault, whatever the board calls it."""
    status = _STATUSES.get(frame.status, "system_error")
    raw = (frame.x, frame.y, frame.z)
    finite = all(math.isfinite(value) for value in raw)
    if status == "running" and not (finite and any(raw)):
        status = "bus_fault"
    x, y, z = (value / TILT_LSB_PER_M_S2 if finite else 0.0 for value in raw)
    tick = RobotTime(epoch=frame.tick_epoch, robot_ns=frame.tick_robot_ns) if frame.tick_epoch else None
    return Tilt(x=x, y=y, z=z, status=status, tick=tick)


def _fault(tilt: Tilt, frame: TiltFrame) -> str:
    """Why this reading cannot drive, with the way out; empty when it can."""
    if tilt.status != "running":
        return _REASONS[tilt.status].format(frame=frame)
    if math.hypot(tilt.x, tilt.y, tilt.z) < FREE_FALL:
        return "the joystick is falling; hold it in the hand"
    if tilt.tick is None:
        return "the joystick has not heard the robot yet; check that base runs and that both share a network"
    return ""


def wish(tilt: Tilt, config: JoystickConfig, robot: RobotConfig) -> DriveCommand:
    """What a sound reading asks for."""
    forward, left = _deflection(tilt, config)
    fastest_turn = 2.0 * robot.max_wheel_speed / robot.track_width  # wheels at full speed against each other
    if config.curve == "angle":
        fastest_turn = min(fastest_turn, robot.max_angular_speed)
    linear, angular = _within_wheels(forward * robot.max_wheel_speed, left * fastest_turn, robot)
    return DriveCommand(linear_x=linear, angular_z=angular, source="hand", reason="", tick=tilt.tick)


def _deflection(tilt: Tilt, config: JoystickConfig) -> tuple[float, float]:
    """Forward and left, each as a share of full speed, -1..1."""
    if config.curve == "source":
        return _ramp(tilt.x, SOURCE_START, SOURCE_FULL), _ramp(tilt.y, SOURCE_START, SOURCE_FULL)
    # Each axis against the horizontal: gravity's direction alone counts, not how hard the hand shakes.
    forward = math.degrees(math.atan2(tilt.x, math.hypot(tilt.y, tilt.z)))
    left = math.degrees(math.atan2(tilt.y, math.hypot(tilt.x, tilt.z)))
    start, full = config.dead_zone_deg, config.full_tilt_deg
    return _ramp(forward, start, full), _ramp(left, start, full)


def _ramp(value: float, start: float, full: float) -> float:
    """0 within ±`start`, then in proportion up to ±1 at ±`full`, and ±1 beyond."""
    share = min(1.0, max(0.0, (abs(value) - start) / (full - start)))
    return share if value >= 0.0 else 0.0 - share  # and not -share: a negative zero would show in every log


def _within_wheels(linear: float, angular: float, robot: RobotConfig) -> tuple[float, float]:
    """The same curve, slowed until its faster wheel keeps to `max_wheel_speed`."""
    faster_wheel = abs(linear) + abs(angular) * robot.track_width / 2.0
    if faster_wheel <= robot.max_wheel_speed:
        return linear, angular
    scale = robot.max_wheel_speed / faster_wheel
    return linear * scale, angular * scale
