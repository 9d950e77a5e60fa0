"""The body that balances on two wheels, between the pins of `firmware/balancer` and the floor."""

import math
from collections import deque
from typing import Any, Final

from giraff_base.drives.balancer.config import BalancerConfig
from giraff_core.encoder_disk import Pattern
from giraff_core.robot import WIRING, RobotConfig
from giraff_schemas.wires.balancer import BalanceFrame
from giraff_sim.board import Board
from giraff_sim.bodies.balancer.drawn import Drawn
from giraff_sim.bodies.balancer.people import PUSH_S, half_sine
from giraff_sim.bodies.balancer.plant import STEP, Plant
from giraff_sim.bodies.balancer.sensors import VOLTS_PER_COUNT, Sensors
from giraff_sim.world.body import Balance, BoardReport
from giraff_sim.world.room import Room

KNOWN: Final = {f"GIRAFF_BASE_DRIVE__{name.upper()}": "false" for name in WIRING}
"""Variables for the services: values that are found out on a real robot before it may drive, and known of this one."""

_FULL_DUTY: Final = 255.0
_LOOK_MS: Final = 20
"""Between two looks at the way."""
_LOOKS: Final = 100
_SWAY: Final = 0.10  # m within 2 s: a robot that only stands stays within it, one that drives at 0.05 m/s does not
_LET_GO_SWAY: Final = 0.30  # m, in its first seconds: it learns at which lean it stands
_LET_GO_MS: Final = 12_000
_SWAY_TURN: Final = 0.20  # rad within 2 s: it may dither its turn to feel its wheels
_UNDER: Final = 0.1  # V
_IDLE_MS: Final = 50  # a robot that stands has a command of 0 for less; for so long a person waits to let go


class BalancerBody:
    """Implements `giraff_sim.world.body.Body`. A person holds it upright until its motors have power.

    It is in its safe state while its motors have no power, and while it stands: within the last 2 s it has gone no
    farther than a robot sways that stands. Its pins cannot tell, because a robot that stands needs power, too.
    """

    report: type[BoardReport] = BalanceFrame
    acts: str = "travel"
    settles_us: int = 3_000_000
    """It stops within 1.1 s and must not have gone far for 2 s."""

    def __init__(self, robot: RobotConfig, drive: BalancerConfig, room: Room, seed: int, drawn: Drawn) -> None:
        drive.require_countable(robot)
        self.drive = drive
        self.drawn = drawn
        self.board = drive.board_type
        self.plant = Plant(drawn, room, robot.footprint_radius)
        self.disks: tuple[Pattern, ...] = ()
        self.activity = 0
        """mm, or mrad of turning, that it went farther than one that stands."""
        self.cord_pulled = False
        self.encoder_cut = [False, False]
        self.line_cut = False
        """Whether the serial line to the motor driver is off."""
        self.raises_it = True
        """Whether a person holds it upright while its motors have no power."""
        self.powered_ms = 0
        """For so long its motors have had power."""
        self.duties = 0.0, 0.0
        """Share of the battery's volts that each bridge gives, -1..1."""
        self._idle_ms = _IDLE_MS
        self.sensors = Sensors(self.plant, seed)
        self._late: deque[tuple[float, float]] = deque([(0.0, 0.0)] * drawn.delay, maxlen=drawn.delay)
        self._states_per_rad = drive.counts_per_turn / math.tau
        self._looked_ms = 0
        self._track: deque[tuple[float, float]] = deque(maxlen=_LOOKS)
        self._pushes: list[tuple[float, float]] = []  # N s, s when each began
        self._stood, self._lean_sum, self._lean_squares = 0, 0.0, 0.0

    def step(self, board: Board | None, duration: float) -> None:
        model: Any = None if board is None else board.model
        is_open = model is None or model.driver_open != 0
        duties = (0.0, 0.0) if model is None else (model.motor[0].drive / _FULL_DUTY, model.motor[1].drive / _FULL_DUTY)
        plant, volts = self.plant, [0.0] * 4
        for _ in range(round(duration / STEP)):
            self._late.append(duties)  # the slice that has passed is the first ms of the delay
            left, right = self.duties = (0.0, 0.0) if is_open else self._late[0]
            self._feel_power(is_powered=(left or right) != 0.0)
            if self._pushes:
                self._push_on()
            plant.step(left, right, is_open=is_open)
            volts = self.sensors.volts()
        if model is None:
            return
        for number, wheel in enumerate((plant.left, plant.right)):
            motor = model.motor[number]
            motor.position = wheel.rotor_angle * self._states_per_rad
            motor.encoder_cut = self.encoder_cut[number]
        model.sensor_volts = volts
        model.battery_volts = plant.volts / self.drive.battery_volts_per_count * VOLTS_PER_COUNT
        model.driver_volts = plant.volts
        model.driver_line_cut = self.line_cut
        model.cord_pulled = self.cord_pulled

    def update(self, board: Board) -> None:  # noqa: ARG002  # the pins cannot tell
        now_ms = round(self.plant.seconds * 1000)
        if now_ms - self._looked_ms < _LOOK_MS:
            return
        self._looked_ms = now_ms
        self._track.append((self.plant.way, self.plant.turned))
        if not self.powered_ms:
            self.activity = 0
            self._track.clear()
            return
        ways, turns = zip(*self._track, strict=True)
        sway = _SWAY if self.powered_ms > _LET_GO_MS else _LET_GO_SWAY
        farther = max(max(ways) - min(ways) - sway, max(turns) - min(turns) - _SWAY_TURN)
        self.activity = max(0, math.ceil(farther * 1000.0))

    @property
    def is_powered(self) -> bool:
        """Whether the bridges have given something lately."""
        return self.powered_ms > 0

    @property
    def balance(self) -> Balance:
        count = max(1, self._stood)
        return Balance(
            lean_sd=math.sqrt(max(0.0, self._lean_squares / count - (self._lean_sum / count) ** 2)),
            falls=self.plant.falls,
            stands=self.is_powered,
            is_settled=self.activity == 0,
            sits_down_at=self.drive.battery_minimum - _UNDER,
        )

    def push(self, impulse: float, height: float) -> None:
        self._pushes.append((impulse, self.plant.seconds))
        self.plant.loads.height = height

    def _push_on(self) -> None:
        now = self.plant.seconds
        self.plant.loads.force = sum(half_sine(impulse, now - began) for impulse, began in self._pushes)
        self._pushes = [each for each in self._pushes if now - each[1] <= PUSH_S]

    def _feel_power(self, *, is_powered: bool) -> None:
        """Notice each ms whether the motors have power. A person takes hold of it, or lets go."""
        self._idle_ms = 0 if is_powered else self._idle_ms + 1
        self.powered_ms = self.powered_ms + 1 if self._idle_ms < _IDLE_MS else 0
        loads = self.plant.loads
        if self.powered_ms > _IDLE_MS:
            loads.grip, self.raises_it = None, False
            lean = self.plant.lean
            self._stood += 1
            self._lean_sum += lean
            self._lean_squares += lean * lean
        elif self.raises_it and loads.grip is None:
            loads.grip = 0.0
