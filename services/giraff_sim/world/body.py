"""A robot's body, as the world and its judges see it, whatever moves it."""

from typing import Any, Literal, NamedTuple, Protocol

from giraff_core.encoder_disk import Pattern
from giraff_schemas.boards import BoardType
from giraff_schemas.wire import Frame
from giraff_sim.board import Board
from giraff_sim.world.room import Pose

BoundedMotion = Literal["any", "travel", "forward", "backward"]
"""Motion that a fault must stop. Turning in place is no travel."""


class RollingWheel(Protocol):
    """One of two wheels."""

    speed: float
    """m/s of its true rim, forward positive."""


class Plant(Protocol):
    """The true motion of a body that stands on two wheels, and its battery."""

    pose: Pose
    speed: float
    """m/s at which the wheels carry the centre, forward positive."""
    turn: float
    """rad/s at which they turn the body, counter-clockwise positive."""
    path_length: float
    """m the centre has moved."""
    lean: float
    """rad that the body leans forward about its axle; 0 of one on wheels."""
    pivot: float
    """m of that axle above the floor."""
    contacts: int
    """How often the body came to touch something."""
    open_volts: float
    """V of the battery with nothing connected."""
    volts: float
    """V of the battery now."""

    @property
    def left(self) -> RollingWheel: ...

    @property
    def right(self) -> RollingWheel: ...

    @property
    def clearance(self) -> float:
        """m between the body and what is nearest to it."""
        ...

    @property
    def closest(self) -> float:
        """The smallest clearance so far, m."""
        ...

    def place(self, pose: Pose) -> None:
        """Lift the robot and set it down at rest."""
        ...


class BoardReport(Protocol):
    """What each base board's report has."""

    @property
    def boot_id(self) -> int: ...

    @property
    def accepted(self) -> int: ...

    @property
    def refused(self) -> int: ...


class Balance(NamedTuple):
    """True stability of a body that can fall over."""

    lean_sd: float
    """rad. Standard deviation of its lean while it stood by itself."""
    falls: int
    stands: bool
    """Whether its motors have power."""
    is_settled: bool
    """Whether for 2 s it has not gone farther than it sways, or its motors have no power."""
    sits_down_at: float
    """V of the battery at which its board has it sit down."""


class Body(Protocol):
    """One kind of robot, between its base board's pins and the floor."""

    board: BoardType
    """Its base board."""
    report: type[BoardReport]
    """The frame in which its board reports."""
    acts: str
    """A word for what it does outside its safe state, in texts."""
    settles_us: int
    """us. Time that it needs to reach its safe state, once nothing else is asked of it. It is added to each bound."""
    disks: tuple[Pattern, ...]
    """The disk of each encoder by its number on the board; empty: ideal ones."""
    activity: int
    """0 when it was in its safe state throughout the last step; else a positive number of its own unit."""

    drawn: Any
    """Difference between body and file, where `Truth` does not say it. None: `Truth` does."""

    @property
    def plant(self) -> Plant: ...

    @property
    def balance(self) -> Balance | None:
        """Return how it has stood. None: it cannot fall over."""
        ...

    def push(self, impulse: float, height: float) -> None:
        """Push it now with so many N s, forward positive, so high above its axle. ValueError: nothing moves it."""
        ...

    def step(self, board: Board | None, duration: float) -> None:
        """Move for `duration` s by what the board's pins gave since the last step, and set its sensors' pins."""
        ...

    def update(self, board: Board) -> None:
        """Find `activity`. The board has just run."""
        ...


class Demand(NamedTuple):
    """The motion that base asks for in one frame."""

    text: str
    boot_id: int
    """Boot of the board that the frame is for."""
    is_nothing: bool
    """Whether it is the safe state."""
    linear: float
    """m/s."""
    angular: float
    """rad/s."""
    linear_off: float
    """m/s. Largest error by the frame's rounding."""
    angular_off: float
    """rad/s."""

    @property
    def goes(self) -> bool:
        """Whether it is more than a turn in place."""
        return abs(self.linear) > self.linear_off

    def is_within(self, linear: float, angular: float) -> bool:
        """Whether a wish for that twist covers this one: the same way, and no faster."""
        return _within(self.linear, linear, self.linear_off) and _within(self.angular, angular, self.angular_off)


def _within(value: float, wish: float, off: float) -> bool:
    return -off <= value <= wish + off if wish >= 0.0 else wish - off <= value <= off


class BodyJudge(Protocol):
    """Judges one kind of body by its pins and its motion, never by what it reports."""

    def asked(self, frame: Frame, now_us: int) -> Demand | None:
        """Remember and return what a sent frame asks for. None: neither for motion nor for the safe state."""
        ...

    def note(self, now_us: int) -> None:
        """Look at the body after each step, before `wrong`."""
        ...

    def wrong(self, now_us: int) -> str:
        """Say what is wrong with this step, in which the body is not in its safe state; empty when nothing is."""
        ...

    def goes(self, way: BoundedMotion) -> bool:
        """Return whether the body is driven that way in this step, in which it is not in its safe state."""
        ...
