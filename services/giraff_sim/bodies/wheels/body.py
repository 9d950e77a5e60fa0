"""The body on two wheels, between the pins of `firmware/base` and the floor."""

from typing import Final

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.encoder_disk import Pattern
from giraff_core.robot import WIRING, RobotConfig
from giraff_schemas.wire import WheelsFrame, Wiring
from giraff_sim.board import Board
from giraff_sim.bodies.wheels.plant import Plant, Wheel
from giraff_sim.config import SimConfig
from giraff_sim.truth import Truth
from giraff_sim.world.body import BoardReport
from giraff_sim.world.room import Room

LEFT: Final = 0
RIGHT: Final = 1
Pair = tuple[float, float]

KNOWN: Final = {
    **{f"GIRAFF_BASE_DRIVE__{name.upper()}": "false" for name in WIRING},
    "GIRAFF_BASE_DRIVE__WHEEL_CONTROL": "speed",
    "GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT": "0.03",
    "GIRAFF_GUARD_DECELERATION": "1.5",
}
"""Variables for the services: values that are measured on a real robot before it may drive, and known of this one.
Its plant brakes at about 2.9 m/s²."""

_INVERT_MOTOR: Final = (Wiring.INVERT_LEFT_MOTOR, Wiring.INVERT_RIGHT_MOTOR)
_INVERT_ENCODER: Final = (Wiring.INVERT_LEFT_ENCODER, Wiring.INVERT_RIGHT_ENCODER)
_ADC_FULL_SCALE: Final = 1023
_ADC_VOLTS: Final = 5.0
_UNCALIBRATED_VOLTS_PER_COUNT: Final = 30.0 / _ADC_FULL_SCALE  # a divider that a 24 V battery fits into


class MotorWiring:
    """How motors and encoders are soldered to the base board, whatever its `configure` frame says.

    It stands between the plant's wheels, by side, and the motors and encoders of board_model.h, by number.
    """

    def __init__(self) -> None:
        self.wiring = Wiring(0)
        """What `configure` must say for levels and ticks to be right."""
        self._is_crossed = False  # flags are slow to look at, and this is asked at each step
        self._starts: Pair = (0.0, 0.0)  # position of each encoder where its wheel's is 0

    def encoder_of(self, wheel: int) -> int:
        """The number of a wheel's encoder."""
        return wheel ^ int(Wiring.SWAP_ENCODERS in self.wiring)

    def motor_of(self, wheel: int) -> int:
        """Return the number of a wheel's motor."""
        return wheel ^ int(Wiring.SWAP_MOTORS in self.wiring)

    def duties(self, drives: Pair) -> Pair:
        """What each wheel gets of the motors' signed duties."""
        if not self._is_crossed:
            return drives
        swap = int(Wiring.SWAP_MOTORS in self.wiring)
        return self._signed(_INVERT_MOTOR, LEFT, drives[swap]), self._signed(_INVERT_MOTOR, RIGHT, drives[1 - swap])

    def positions(self, states: Pair) -> Pair:
        """Where each encoder is when the wheels are there, quadrature states."""
        if not self._is_crossed:
            return self._starts[0] + states[0], self._starts[1] + states[1]
        turned = [0.0, 0.0]
        for wheel in (LEFT, RIGHT):
            turned[self.encoder_of(wheel)] = self._signed(_INVERT_ENCODER, wheel, states[wheel])
        return self._starts[0] + turned[0], self._starts[1] + turned[1]

    def rewire(self, wiring: Wiring, states: Pair) -> None:
        """Rewire all, with the wheels where they are: no encoder moves."""
        before = self.positions(states)
        self.wiring, self._starts = wiring, (0.0, 0.0)
        self._is_crossed = bool(wiring)
        after = self.positions(states)
        self._starts = before[0] - after[0], before[1] - after[1]

    def _signed(self, inverted: tuple[Wiring, Wiring], wheel: int, value: float) -> float:
        return -value if inverted[wheel] in self.wiring else value


class WheelsBody:
    """Implements `giraff_sim.world.body.Body`."""

    report: type[BoardReport] = WheelsFrame
    acts: str = "power"
    balance: None = None
    drawn: None = None

    def __init__(self, robot: RobotConfig, drive: WheelsConfig, sim: SimConfig, room: Room, truth: Truth) -> None:
        drive.require_countable(robot)
        self.drive = drive
        self.board = drive.board_type
        self.settles_us = self.board.output_delay_us
        self.plant = Plant(robot, drive, sim, room, truth)
        self.disks: tuple[Pattern, ...] = ()
        self.activity = 0
        """Largest duty of either motor in the last step, of 255."""
        self.resets = 0
        """How often the board was reset."""
        self.drives = 0.0, 0.0
        """Mean signed duty of each motor in the last step, by its number on the board."""
        self._motor_wiring = MotorWiring()
        self.rewire(drive.wiring)
        self._cut = [0, 0]  # 1: the wires of the encoder of that number are cut
        self._signal_cut = [0, 0]  # 1: the wire from the servo output of the motor of that number is off
        self._volts_per_count = drive.battery_volts_per_count or _UNCALIBRATED_VOLTS_PER_COUNT

    def step(self, board: Board | None, duration: float) -> None:
        if board is None:
            self.plant.step(duration, 0.0, 0.0)
            return
        motors = board.model.motor
        self.plant.step(duration, *self._motor_wiring.duties((motors[0].drive, motors[1].drive)))
        motors[0].position, motors[1].position = self._motor_wiring.positions(self._wheel_states)
        motors[0].encoder_cut, motors[1].encoder_cut = self._cut
        motors[0].signal_cut, motors[1].signal_cut = self._signal_cut
        board.model.battery_volts = self._battery_pin_volts
        board.model.driver_volts = self.plant.volts

    def update(self, board: Board) -> None:
        motors = board.model.motor
        self.activity = max(motors[0].drive_peak, motors[1].drive_peak)
        motors[0].drive_peak = motors[1].drive_peak = 0
        self.drives = float(motors[0].drive), float(motors[1].drive)
        self.resets = board.model.resets

    def push(self, impulse: float, height: float) -> None:  # noqa: ARG002  it stands on its casters
        raise ValueError("this robot does not balance")

    def cut_encoder(self, wheel: int, *, is_cut: bool) -> None:
        """Cut (or mend) the wires of a wheel's encoder: `LEFT` or `RIGHT`."""
        self._cut[self._motor_wiring.encoder_of(wheel)] = int(is_cut)

    def slip_encoder(self, wheel: int, lost_share: float) -> None:
        """Let a wheel's encoder lose this share of its counts; 0 mends it. ValueError for what is no share."""
        if not 0.0 <= lost_share < 1.0:
            raise ValueError(f"lost_share is {lost_share}: it must be 0 at least, and below 1")
        self._wheel(wheel).lost_share = lost_share

    def flicker_encoder(self, wheel: int, *, flickers: bool) -> None:
        """Let a wheel's encoder stand on the edge of a count whenever the wheel rests, or not."""
        self._wheel(wheel).flickers = flickers

    def cut_signal(self, wheel: int, *, is_cut: bool) -> None:
        """Pull off (or put back) the wire from a wheel's servo output to the motor driver. ValueError without one."""
        if self.board.is_process or not self.board.output_delay_us:
            raise ValueError(f"the board {self.board.name} has no servo output whose wire could be cut")
        self._signal_cut[self._motor_wiring.motor_of(wheel)] = int(is_cut)

    @property
    def has_cut_signal(self) -> bool:
        """Whether the wire from a servo output to the motor driver is off."""
        return any(self._signal_cut)

    def block_wheel(self, wheel: int, *, is_blocked: bool) -> None:
        """Hold a wheel so that it does not turn whatever its motor gets, or let it go."""
        self._wheel(wheel).is_blocked = is_blocked

    def brake_wheel(self, wheel: int, brake: float) -> None:
        """Hold a wheel back by so many m/s² at its rim, as a hand does; 0 lets it go."""
        self._wheel(wheel).brake = brake

    def rewire(self, wiring: Wiring) -> None:
        """Rewire motors and encoders, so that `configure.wiring` must be this for the robot to drive well."""
        self._motor_wiring.rewire(wiring, self._wheel_states)

    def _wheel(self, wheel: int) -> Wheel:
        return self.plant.right if wheel == RIGHT else self.plant.left

    @property
    def _wheel_states(self) -> tuple[float, float]:
        return self.plant.left.states, self.plant.right.states

    @property
    def _battery_pin_volts(self) -> float:
        """V at the base board's ADC, behind its divider."""
        return min(_ADC_VOLTS, self.plant.volts / self._volts_per_count * _ADC_VOLTS / _ADC_FULL_SCALE)
