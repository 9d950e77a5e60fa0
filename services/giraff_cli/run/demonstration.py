"""The demonstration among the operators: its hand gives way to everybody, and takes the joystick up again later.

No I/O and no clock. Times are seconds of any one monotonic clock.
"""

from collections.abc import Mapping
from enum import Enum, auto
from typing import Final, NamedTuple

from giraff_core.lease import ASK
from giraff_schemas.messages import DriveCommand, EStop, Lease, Sample
from giraff_schemas.services import DEMONSTRATION

QUIET: Final = 30.0
"""s without a command of anybody else, and without a reset of the emergency stop, after which the hand drives again."""
WARNING: Final = 3.0
"""s before that in which the run says so."""
SETTLES: Final = 0.5
"""s for which the hand stays flat once it has let go of the button: the joystick takes its new zero from that."""


class JoystickHold(NamedTuple):
    """How the joystick is held."""

    drives: bool
    """By the hand of the demonstration; else flat."""
    presses: bool = False
    """The button, which asks for the lease and moves nothing."""


FLAT: Final = JoystickHold(drives=False)
DRIVES: Final = JoystickHold(drives=True)
ASKS: Final = JoystickHold(drives=False, presses=True)


class _Phase(Enum):
    DRIVING = auto()
    WAITING = auto()
    """Somebody else drives, has driven just now, or has stopped the robot."""
    WARNING = auto()
    ASKING = auto()
    """The button is pressed until the guard has given the lease."""
    SETTLING = auto()
    """The button is let go, and the hand still flat."""
    ENDED = auto()


class Demonstration:
    """Hears who else commands the robot, and says how the joystick is held.

    A joystick asks for a lost lease by any tilt. So its hand is flat before the lease of another can end, and has the
    lease again before it tilts.
    """

    def __init__(self) -> None:
        """The hand drives from the start."""
        self._phase = _Phase.DRIVING
        self._why = ""
        self._holder = ""
        self._engaged = False
        self._last = 0.0  # when anybody else gave a command, or the emergency stop was not yet reset
        self._until = 0.0

    @property
    def note(self) -> str:
        """What a person is told of it; empty while the demonstration drives."""
        match self._phase:
            case _Phase.DRIVING | _Phase.ENDED:
                return ""
            case _Phase.WARNING:
                return f"the demonstration drives on in {WARNING:g} s; a drive key in `giraff drive` stops that"
            case _Phase.ASKING | _Phase.SETTLING:
                return "the demonstration takes the joystick up again"
        if self._engaged:
            return "emergency stop: the demonstration waits; `giraff estop reset`"
        return f"{self._why}; the demonstration waits for {QUIET:g} s of quiet"

    def on_sample(self, sample: Sample, now: float) -> None:
        """Take anything that is heard of the robot."""
        match sample:
            case DriveCommand() if sample.operator != DEMONSTRATION and _is_wish(sample):
                self._give_way(f"{sample.operator} drives", now)
            case Lease():
                self._holder = sample.operator
                if sample.operator not in ("", DEMONSTRATION) and self._phase in (_Phase.DRIVING, _Phase.SETTLING):
                    self._give_way(f"{sample.operator} drives", now)  # what it said was lost on the way
            case EStop() if sample.engaged or self._engaged:
                self._engaged = sample.engaged
                self._give_way("the emergency stop was reset", now)
            case _:
                pass

    def grip(self, now: float) -> JoystickHold:
        """How the joystick is to be held from now on."""
        self._advance(now)
        match self._phase:
            case _Phase.DRIVING:
                return DRIVES
            case _Phase.ASKING:
                return ASKS
        return FLAT

    def end(self) -> None:
        """Lay the hand flat for good."""
        self._phase = _Phase.ENDED

    def _advance(self, now: float) -> None:
        holds = self._holder == DEMONSTRATION
        match self._phase:
            case _Phase.WAITING if not self._engaged and now - self._last >= QUIET - WARNING:
                self._enter(_Phase.WARNING, now + WARNING)
            case _Phase.WARNING if now >= self._until:
                self._enter(_Phase.ASKING)
            case _Phase.ASKING if holds:
                self._enter(_Phase.SETTLING, now + SETTLES)
            case _Phase.SETTLING if not holds:  # it was an old lease, and has ended
                self._enter(_Phase.ASKING)
            case _Phase.SETTLING if now >= self._until:
                self._enter(_Phase.DRIVING)

    def _give_way(self, why: str, now: float) -> None:
        if self._phase is not _Phase.ENDED:
            self._enter(_Phase.WAITING)
        self._why, self._last = why, now

    def _enter(self, phase: _Phase, until: float = 0.0) -> None:
        self._phase, self._until = phase, until


def _is_wish(command: DriveCommand) -> bool:
    """A hand asks for the robot, or to move it. A program that merely runs does neither."""
    return command.source == "hand" and (command.lease_counter == ASK or not command.neutral)


def with_demonstration(priorities: Mapping[str, int]) -> dict[str, int]:
    """The guard's priorities with the demonstration's, which is below everybody's."""
    others = {name: priority for name, priority in priorities.items() if name != DEMONSTRATION}
    return others | {DEMONSTRATION: min([-1, *others.values()]) - 1}  # -1: of a name that no table has
