"""What the operator's hand asks of the robot, and when it is no hand that asks. No I/O and no clock."""

import math
from typing import Final

from giraff_core.live import Live
from giraff_core.operator import LINK_SILENCE, Fault, Hand, Operator, Wish
from giraff_core.robot import RobotConfig
from giraff_core.tick_relay import TickRelay, tick_of
from giraff_core.tilt.clutch import Clutch, Words
from giraff_core.tilt.curves import asked
from giraff_core.tilt.mount import Mount
from giraff_joystick.config import JoystickConfig
from giraff_joystick.hand_detector import HandDetector
from giraff_schemas.messages import RobotTime, Tick, Tilt, TiltStatus
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import TILT_LSB_PER_M_S2, TILT_PERIOD_MS, TickFrame, TiltFrame
from giraff_schemas.wire import TiltStatus as WireStatus

BOARD_SILENCE: Final = 0.2
"""s without a frame after which the board counts as lost; ten of its frames."""

_NOT_TURNED: Final = Mount(0.0, 0.0, 0.0)

_STATUSES: Final[dict[int, TiltStatus]] = {
    WireStatus.RUNNING: "running",
    WireStatus.STARTING: "starting",
    WireStatus.BUS_FAULT: "bus_fault",
    WireStatus.WRONG_CHIP: "wrong_chip",
    WireStatus.SELF_TEST_FAILED: "self_test_failed",
    WireStatus.SYSTEM_ERROR: "system_error",
}

_TROUBLES: Final[dict[TiltStatus, Trouble]] = {
    "starting": Trouble("the tilt sensor is starting", "wait a second"),
    "bus_fault": Trouble(
        "the tilt sensor gives no reading, or one without gravity",
        "press its shield firmly onto the joystick board and reset the board",
    ),
    "wrong_chip": Trouble("the chip that answers is not a BNO055", "put the 9-axes shield on the joystick board"),
    "self_test_failed": Trouble(
        "the tilt sensor fails its self-test",
        "hold it still and unplug the joystick board for a second, or replace the shield",
    ),
    "system_error": Trouble(
        "the tilt sensor reports an error (SYS_STATUS {frame.sys_status}, SYS_ERR {frame.sys_error})",
        "unplug the joystick board for a second",
    ),
}


_CLUTCH: Final = Words(
    "the clutch was let go",
    "joystick",
    "the old zero stays; hold the joystick level, or press the button, hold still and let it go",
)
_NO_TICK: Final = Trouble(
    "the joystick has not heard the robot yet", "check that base runs and that both share a network"
)
_OLD_TICK: Final = Trouble(
    f"no tick of the robot has reached the joystick board for {LINK_SILENCE:g} s",
    "check that base runs, the network, and the board's cable",
)


class JoystickPolicy(Hand):
    """Turns the board's frames into samples. Times are seconds of any one monotonic clock."""

    def __init__(self, live: Live[JoystickConfig], robot: RobotConfig, instance: str) -> None:
        self._live = live
        self._robot = robot
        super().__init__(Operator(live.config.operator, instance, asks_from_start=live.config.asks_from_start))
        self._hand = HandDetector(live)
        self._clutch = Clutch(_CLUTCH)
        self._mount = mount_of(live.config)
        self._readings = 0
        self.sensor_fault = NO_TROUBLE
        """What is wrong with the tilt sensor, by the newest frame."""
        self._heard = -math.inf
        self._tick: RobotTime | None = None
        self._tick_came = -math.inf
        self._silence = Trouble(
            f"no frame from the joystick board on {live.config.port} for {BOARD_SILENCE:g} s",
            "check its cable and power",
        )
        self._asks: Wish | Fault = Fault(self._silence, None)
        self._tick_down = TickRelay()

    def on_tick(self, tick: Tick, now: float) -> TickFrame | None:
        """The robot's clock as it goes down to the board, which puts the last one into each frame."""
        return self._tick_down.frame(tick, now)

    def on_frame(self, frame: TiltFrame, now: float) -> Tilt:
        """The reading in `frame`. It is what `poll` stands on until the next one."""
        tilt = reading(frame, self._mount)
        if self._silent(now) or tilt.status != "running":
            self._hand.forget()
            self._clutch.forget()
        if tilt.tick != self._tick:
            self._tick_came = now
        self._heard, self._tick = now, tilt.tick
        self.sensor_fault = NO_TROUBLE if tilt.status == "running" else trouble_of(tilt.status, frame)
        if self.sensor_fault:
            self._asks = Fault(self.sensor_fault, self._tick, is_told=True)
        else:
            self._asks = self._wish(tilt, frame, now)
        return tilt

    def poll(self, now: float) -> Wish | Fault:
        """What the newest frame asks, with that frame's tick however often it is repeated."""
        return Fault(self._silence, self._tick, is_told=bool(self.sensor_fault)) if self._silent(now) else self._asks

    def lost(self, now: float) -> Tilt | None:
        """What stands for a reading while the board is silent; None while it is not."""
        return Tilt(x=0.0, y=0.0, z=0.0, status="no_board", tick=self._tick) if self._silent(now) else None

    def _wish(self, tilt: Tilt, frame: TiltFrame, now: float) -> Wish | Fault:
        """What a reading of a running sensor asks for, if a hand is behind it."""
        vector = (tilt.x, tilt.y, tilt.z)
        counts = frame.x, frame.y, frame.z
        alarm = self._hand.alarm(counts)
        if self._hand.may_be_frozen:
            self._clutch.forget()  # the hand may have another attitude by now
        self._readings += 1
        self._clutch.on_reading(vector, self._readings * TILT_PERIOD_MS / 1000, pressed=bool(frame.button))
        linear, angular = asked(self._clutch.relative(vector), self._live.config, self._robot)
        if self._clutch.engaged:
            linear = angular = 0.0
        deflected = linear != 0.0 or angular != 0.0
        if not deflected:
            self._clutch.dismiss_refusal()
        trouble = (
            alarm or self._hand.laid_down(counts, deflected=deflected) or self._link_fault(now) or self._clutch.refusal
        )
        if trouble:
            return Fault(trouble, self._tick)
        return Wish(linear, angular, self._tick, takes=self._clutch.engaged or deflected)

    def _link_fault(self, now: float) -> Trouble:
        if self._tick is None:
            return _NO_TICK
        return _OLD_TICK if now - self._tick_came > LINK_SILENCE else NO_TROUBLE

    def _silent(self, now: float) -> bool:
        return now - self._heard > BOARD_SILENCE


def mount_of(config: JoystickConfig) -> Mount:
    """Return how the sensor sits in the joystick."""
    return Mount(config.mount_roll, config.mount_pitch, config.mount_yaw)


def trouble_of(status: TiltStatus, frame: TiltFrame) -> Trouble:
    """Return what a status other than running means, and what to do."""
    told = _TROUBLES[status]
    return Trouble(told.what.format(frame=frame), told.remedy)


def reading(frame: TiltFrame, mount: Mount = _NOT_TURNED) -> Tilt:
    """Return a frame in SI units, in the joystick's axes.

    A vector without any gravity is the bus's fault, whatever the board calls it.
    """
    status = _STATUSES.get(frame.status, "system_error")
    raw = (frame.x, frame.y, frame.z)
    finite = all(math.isfinite(value) for value in raw)
    if status == "running" and not (finite and any(raw)):
        status = "bus_fault"
    x, y, z = (value / TILT_LSB_PER_M_S2 if finite else 0.0 for value in raw)
    x, y, z = mount.in_joystick((x, y, z))
    return Tilt(x=x, y=y, z=z, status=status, tick=tick_of(frame))
