"""What base asks of a drive: the dialogue with one firmware, whatever moves the robot.

A kind of drive is a folder below `drives/`. It tells what its board has proved, and asks the board only for what base
permits. `giraff_base.policy` decides whether the robot may move at all, once for every kind.
"""

import math
from typing import Any, NamedTuple, Protocol

import msgspec

from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import BoardState, RobotTime, Sample, Side
from giraff_schemas.requests import EStopEngage
from giraff_schemas.topics import Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import Frame


class Report(NamedTuple):
    """News from the board."""

    disarms: tuple[Trouble, ...]
    """Why the robot must be armed again, the first cause first: something held it, or the board was reset or taken
    over since its last report."""
    latched: EStopEngage | None
    """The emergency stop that the board has latched by itself; None: none, or base has asked for its release."""
    samples: tuple[Sample, ...]
    """Samples of its topics, to publish; none before the board works with the settings of this session."""


class Answer(NamedTuple):
    """The reply to the board's newest report."""

    frame: Frame | None
    """None: no frame is due yet."""
    reason: Trouble | None = None
    """Why the robot does less than it may; None: the reason stays as it is."""
    moves: bool = False
    """Whether the frame asks for motion."""


class SpeedLimit(NamedTuple):
    """The fastest that a wheel may turn now."""

    speed: float = math.inf
    """m/s."""
    reason: Trouble = NO_TROUBLE
    """Why it is less than the robot file allows."""


class Drive(Protocol):
    """The dialogue with one board. Pure: no I/O and no clock.

    Each frame that asks for motion proves to the board that it answers the newest report.
    """

    @property
    def topics(self) -> tuple[Topic[Any], ...]:
        """The topics of its samples. Base publishes them."""
        ...

    @property
    def can_power_off(self) -> bool:
        """Whether the drive holds a stopped robot up, so that off is another state than stopped."""
        ...

    @property
    def at_rest(self) -> bool:
        """Whether the robot stands, in its safe state. True before any report."""
        ...

    @property
    def voltage(self) -> float | None:
        """V of the battery; None: not known."""
        ...

    @property
    def arming_block(self) -> Trouble:
        """Return why nobody can arm the robot until a person puts something right. NO_TROUBLE: it can be armed."""
        ...

    @property
    def limit(self) -> SpeedLimit:
        """The fastest that a wheel may turn now."""
        ...

    @property
    def not_ready(self) -> Trouble:
        """Why the board would not move now, whatever base asks for."""
        ...

    @property
    def warning(self) -> Trouble:
        """Return a warning about the wheels, which stops nothing. NO_TROUBLE: there is none."""
        ...

    def state(self) -> BoardState:
        """Return the board's state as its newest report tells it."""
        ...

    def reconfigure(self, config: msgspec.Struct) -> None:
        """Go by another table `[base.drive]` of the same kind. A drive whose table is fixed has nothing to do."""
        ...

    def on_camera(self, told: VisualOdometry, now: RobotTime) -> None:
        """Take what a camera sees of the motion: at most it lowers the limit, until the port is opened anew."""
        ...

    def open(self, session: int) -> None:
        """Begin anew: the port was opened, perhaps again. `session`: random, not 0."""
        ...

    def lose(self) -> None:
        """Forget the board: there is none now."""
        ...

    def on_frame(self, frame: Frame, now: RobotTime) -> Report | None:
        """Return what a frame of the board tells; None: it is nothing for base."""
        ...

    def release(self) -> None:
        """Release the board's latch from now on: base's emergency stop was reset."""
        ...

    def hold(self, *, off: bool) -> None:
        """Release no latch any more: base's emergency stop was engaged. Base tells each engaging.

        `off`: the stop is off, also after the port was opened anew. False where the drive does not know off.
        """
        ...

    def settle(self, now: RobotTime, *, engaged: bool) -> Answer | None:
        """Return what must be settled before anything moves: latch, session, release; None: nothing.

        Base asks once a report, and for each new command. `engaged`: base's emergency stop is.
        """
        ...

    def ask(self, linear: float, angular: float, *, armed: bool, free_side: Side) -> Answer:
        """Ask for a twist, m/s and rad/s. Zero asks for the safe state.

        `armed`: a robot that has to get up for its safe state may do so. `free_side`: where it may sit down.
        """
        ...
