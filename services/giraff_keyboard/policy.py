"""What the keys ask of the robot. No I/O and no clock: time is an argument."""

import math
from enum import Enum, auto
from typing import Final

from giraff_core.freshness import age
from giraff_core.operator import Fault, Hand, Operator, Wish
from giraff_core.robot import RobotConfig
from giraff_keyboard.config import KeyboardConfig
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import Trouble


class Key(Enum):
    """What a press means."""

    FORWARD = auto()
    BACKWARD = auto()
    LEFT = auto()
    RIGHT = auto()
    CLUTCH = auto()
    STOP = auto()
    FASTER = auto()
    SLOWER = auto()
    RESET = auto()
    """Asks whether to release the emergency stop."""
    YES = auto()
    NOTHING = auto()
    """These were no presses, nor was the one just before them."""


KEY_LASTS: Final = 0.4
"""s that one press asks for. A held key repeats, and each repeat is a press of its own."""

_DIRECTIONS: Final = {Key.FORWARD: (1.0, 0.0), Key.BACKWARD: (-1.0, 0.0), Key.LEFT: (0.0, 1.0), Key.RIGHT: (0.0, -1.0)}

_STOPPING: Final = Trouble("the space bar was pressed, and base has not yet confirmed the emergency stop")


class KeyboardPolicy(Hand):
    """Turns presses into commands. Times are seconds of any one monotonic clock."""

    def __init__(self, config: KeyboardConfig, robot: RobotConfig, instance: str) -> None:
        # Nobody takes the robot by starting a program: without the lease it is asked for by a press alone.
        super().__init__(Operator(config.operator, instance, asks_from_start=False))
        self.step = config.first_step
        """Of `config.steps`."""
        self._config = config
        self._robot = robot
        self._stopping = False
        # The press in force: what it asks, since when, and the robot's time at that moment, never renewed.
        self._asks = (0.0, 0.0)
        self._pressed = -math.inf
        self._pressed_tick: RobotTime | None = None

    @property
    def steps(self) -> int:
        """How many speeds there are to choose from."""
        return self._config.steps

    @property
    def speed(self) -> tuple[float, float]:
        """m/s and rad/s that a key asks for now."""
        share = self.step / self._config.steps
        robot = self._robot
        fastest_turn = min(robot.max_angular_speed, robot.kinematics.fastest_spin)
        return share * robot.max_wheel_speed, share * fastest_turn

    def on_key(self, key: Key, now: float) -> None:
        """Take a press at its moment. Whatever it is, the one before it no longer counts."""
        self._asks = (0.0, 0.0)
        self._pressed = -math.inf
        if key is Key.STOP:
            self._stopping = True
        elif key is Key.FASTER:
            self.step = min(self._config.steps, self.step + 1)
        elif key is Key.SLOWER:
            self.step = max(1, self.step - 1)
        elif key in _DIRECTIONS or key is Key.CLUTCH:
            forward, left = _DIRECTIONS.get(key, (0.0, 0.0))
            linear, angular = self.speed
            self._asks = (0.0 + forward * linear, 0.0 + left * angular)  # 0.0 + makes a plain zero of a negative one
            self._pressed, self._pressed_tick = now, self.operator.tick

    def moment(self, now: float) -> RobotTime | None:
        """The robot's time, of what a person asks for now; None while the robot is lost."""
        return None if self.operator.link_fault(now) else self.operator.tick

    def on_stopped(self) -> None:
        """Base has confirmed the emergency stop: from here on its latch holds."""
        self._stopping = False

    def poll(self, now: float) -> Wish | Fault:
        """What the keys ask now: after KEY_LASTS without a press nothing, which is a hand's neutral."""
        newest = self.operator.tick
        if fault := _STOPPING if self._stopping else self.operator.fault(now):
            return Fault(fault, newest)
        if not self._wishes(now):
            return Wish(0.0, 0.0, newest)
        return Wish(*self._asks, newest if self._asks == (0.0, 0.0) else self._pressed_tick, takes=True)

    def _wishes(self, now: float) -> bool:
        """A press is in force, by this machine's clock and by the robot's."""
        newest = self.operator.tick
        if now - self._pressed > KEY_LASTS or newest is None:
            return False
        return age(self._pressed_tick, newest) <= KEY_LASTS
