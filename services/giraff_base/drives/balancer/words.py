"""What the balancing board says of itself, in words."""

from typing import Final

from giraff_base.drives.dialogue import KEPT_STOP, word
from giraff_schemas.requests import EStopEngage
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wires.balancer import BalanceCause, BalanceFlag, BalanceFrame, BalanceLatch, BalancePosture

_CAUSES: Final[dict[int, Trouble]] = {
    BalanceCause.ASKED: Trouble("it was asked to sit down"),
    BalanceCause.ESTOP_OFF: Trouble("the emergency stop switched it off"),
    BalanceCause.CORD: Trouble("its cord was pulled", "put it back"),
    BalanceCause.FALLEN: Trouble("it leaned too far to recover", "clear its way"),
    BalanceCause.LIFTED: Trouble("its wheels turned freely", "put it on the floor"),
    BalanceCause.GYROSCOPE: Trouble("the gyroscope failed", "check its cables"),
    BalanceCause.ACCELEROMETER: Trouble("the accelerometer failed", "check its cables"),
    BalanceCause.LEFT_ENCODER: Trouble("the left encoder was silent", "check its cable"),
    BalanceCause.RIGHT_ENCODER: Trouble("the right encoder was silent", "check its cable"),
    BalanceCause.NO_WHEEL_TURNS: Trouble("no wheel turned", "check the motor driver's cable and both encoders"),
    BalanceCause.BATTERY: Trouble("the battery was low", "charge it"),
    BalanceCause.LEAN_DISPUTED: Trouble("gyroscope and accelerometer disagreed", "check how they are fixed"),
}
_POSTURES: Final[dict[int, str]] = {BalancePosture.STANDS: "stands", BalancePosture.SITS_DOWN: "sits down"}
_CORD: Final = EStopEngage(by="the cord", reason=Trouble("it is pulled", "put it back"), off=True)
HELD: Final = Trouble("something held it", "clear the way")
NEW_GAINS: Final = Trouble("it stops before it takes other gains")
ONLY_STANDS: Final = Trouble(
    "it stands and does not drive: with these gains it would stop too late",
    "lower max_wheel_speed, or take the gains that `giraff tune balance` computes",
)
AT_LIMIT: Final = Trouble("at its limit: it needs its whole torque to stay up")
GETS_UP: Final = Trouble("the robot gets up")


def posture(report: BalanceFrame) -> str:
    """Return the posture. An unknown one counts as off."""
    return _POSTURES.get(report.posture, "off")


def cause(report: BalanceFrame) -> Trouble:
    """Return why it is off or sits down. NO_TROUBLE: it has not stood since its board began."""
    if report.cause == BalanceCause.NONE:
        return NO_TROUBLE
    return _CAUSES.get(report.cause) or Trouble(f"cause {word(BalanceCause, report.cause)}", "reflash the board")


def left_standing(report: BalanceFrame) -> Trouble:
    """Say that a robot that stood does so no more, and why."""
    return cause(report).of(f"it {'sat down' if report.posture == BalancePosture.SITS_DOWN else 'went off'}")


def lies(report: BalanceFrame) -> Trouble:
    """Say why a robot that is off is to be held upright, and what must be put right before."""
    why = cause(report)
    what = f"the robot is off: {why.what}" if why else "the robot is off and not upright"
    return Trouble(what, " and ".join([*([why.remedy] if why.remedy else []), "hold it upright and still"]))


def untouched(report: BalanceFrame) -> Trouble:
    """Say that a robot that went off may still stand on its friction, with nobody's hand on it."""
    why = lies(report)
    return Trouble(why.what, f"take hold of it and lean it once by 6 degrees; {why.remedy}")


def stopped_by(report: BalanceFrame) -> EStopEngage | None:
    """Return the emergency stop that a pulled cord is."""
    return _CORD if report.flags & BalanceFlag.CORD else None


def latched_by(latch: int) -> EStopEngage:
    """Return the emergency stop that a latch of the board means, where base did not order it."""
    return EStopEngage(by="the base board", reason=KEPT_STOP, off=latch != BalanceLatch.STANDS)
