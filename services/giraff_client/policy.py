"""What a script asks of the robot, and what stands against it. No I/O and no clock: time is an argument."""

import math
from typing import Final

import msgspec

from giraff_client.errors import (
    EmergencyStopError,
    LostRobotError,
    NotArmedError,
    RefusedError,
    RobotError,
    TakenError,
)
from giraff_core.operator import ASKING, LEVEL, Operator, Wish
from giraff_schemas.actions import SCRIPT
from giraff_schemas.messages import BaseState, DriveCommand, EStop, Lease, Sample, Tick
from giraff_schemas.services import MOTION
from giraff_schemas.trouble import Trouble

_ANSWERS_WITHIN: Final = 0.5
"""s in which the guard answers who asks for the lease: it tells who drives ten times a second."""
_NO_BASE: Final = Trouble("base is not heard", "check that giraff_base runs")
_LET_GO: Final = Trouble("this script does not hold the robot")


class OperatorPolicy:
    """A script as an operator: it asks, arms and drives. Times are seconds of any one monotonic clock."""

    def __init__(self, operator: str, instance: str) -> None:
        self._operator = Operator(operator, instance)
        self._base: tuple[BaseState | None, float] = None, -math.inf
        self._estop: EStop | None = None
        self._asked_at: float | None = None
        self._neutral_since: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the robot is this script's."""
        return self._operator.holds

    def on_sample(self, sample: Sample, now: float) -> None:
        """Take what the robot says, as it arrives."""
        match sample:
            case Tick():
                self._operator.on_tick(sample, now)
            case Lease():
                self._operator.on_lease(sample)
            case BaseState():
                self._base = sample, now
            case EStop():
                self._estop = sample

    def begin(self, now: float) -> None:
        """From here on the robot is asked for, and then armed."""
        self._asked_at = now
        self._neutral_since = None

    def step(self, now: float) -> DriveCommand | None:
        """The next command on the way to an armed robot, fifty times a second; None once it is armed.

        Raises RobotError where it will not come to that.
        """
        self._raise_if_stopped(now)
        if not self._operator.holds:
            self._neutral_since = None
            # The lease of a motion, perhaps of this very script, ends a second after the motion: it is waited for.
            taken = self._operator.holder not in ("", MOTION.name)
            if taken and self._asked_at is not None and now - self._asked_at > _ANSWERS_WITHIN:
                raise self._refused()
            return self._made(ASKING, takes=True)
        if self._neutral_since is None:
            self._neutral_since = now
        state, heard = self._base
        if state is not None and state.armed and heard - self._neutral_since >= LEVEL:
            return None
        return self._made((0.0, 0.0))

    def gave_up(self) -> RobotError:
        """Why the robot is not armed although there was time enough."""
        state, _ = self._base
        if not self._operator.holds:
            return self._refused()
        return _not_armed(state)

    def drive(self, linear_x: float, angular_z: float, now: float) -> DriveCommand:
        """A wish of this moment: m/s and rad/s. Raises RobotError where it can no longer be obeyed."""
        self._raise_if_stopped(now)
        if not self._operator.holds:
            raise self._refused()
        state, _ = self._base
        if state is None or not state.armed:
            raise _not_armed(state)
        return self._made((linear_x, angular_z))

    def final_command(self) -> DriveCommand:
        """The last command of a script: base disarms at once, and a second of silence frees the lease."""
        return self._operator.last_words(self._operator.tick)

    def lost(self, now: float) -> LostRobotError | None:
        """Why nothing of the robot is to be heard; None: its clock is."""
        fault = self._operator.link_fault(now)
        return LostRobotError(str(fault)) if fault else None

    def _refused(self) -> RefusedError:
        holder = self._operator.holder
        return (TakenError if holder else RefusedError)(holder, _then_arm(self._operator.refusal))

    def _raise_if_stopped(self, now: float) -> None:
        if lost := self.lost(now):
            raise lost
        if self._estop is not None and self._estop.engaged:
            raise EmergencyStopError(self._estop)

    def _made(self, twist: tuple[float, float], *, takes: bool = False) -> DriveCommand:
        return self._operator.say(Wish(*twist, self._operator.tick, takes))


def _not_armed(state: BaseState | None) -> NotArmedError:
    return NotArmedError(_then_arm(state.reason if state is not None else _NO_BASE))


def _then_arm(trouble: Trouble) -> str:
    """Return it in the words of a script, which arms the robot last."""
    trouble = trouble or _LET_GO
    return (trouble if trouble.action else msgspec.structs.replace(trouble, action="hold_level")).line(SCRIPT)
