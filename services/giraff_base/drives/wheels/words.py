"""What the base board says of itself, in words."""

from typing import Final

from giraff_base.drives.dialogue import KEPT_STOP
from giraff_base.drives.wheel_wiring import CHECK_THEM
from giraff_schemas.boards import BoardType
from giraff_schemas.requests import EStopEngage
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import DriveState, Latch, SpeedFlag, WheelsFrame

_FREE_IT: Final = "free it, check its motor and its encoder's cable"
_LATCHED_BY: Final[dict[int, Trouble]] = {
    Latch.ESTOP: KEPT_STOP,
    Latch.LEFT_STUCK: Trouble("left wheel stuck", _FREE_IT),
    Latch.RIGHT_STUCK: Trouble("right wheel stuck", _FREE_IT),
    Latch.LEFT_OPPOSITE: Trouble("left wheel turned against its motor", *CHECK_THEM),
    Latch.RIGHT_OPPOSITE: Trouble("right wheel turned against its motor", *CHECK_THEM),
}
_AT_LIMIT_FLAG: Final = int(SpeedFlag.AT_LIMIT)  # of a flag, `&` would make another one in each frame
_AT_LIMIT: Final = "at its limit: the wheels cannot do what is asked; the battery may be low"
BLIND: Final = Trouble(
    "the wheels turn at two thirds of max_wheel_speed at most, because battery_volts_per_count is not known",
    "measure it as docs/commissioning.md says, and set it in [base.drive]",
)
_OR_LOWERED: Final = ", or the potentiometer turned down"


def silent(speed: float, seconds: float) -> Trouble:
    """Return why the wheels turn at this many m/s at most: their controller stops by itself after so many s."""
    return Trouble(
        f"the wheels turn at {speed:.3g} m/s at most, because their controller drives on for {seconds:g} s when it "
        "hears nobody",
        "a controller whose time-out can be set may be faster: docs/adapter.md",
    )


def engaged_by(latch: int) -> EStopEngage:
    """What a latch of the board that base did not order means to base."""
    unknown = Trouble(f"latched for an unknown cause, {latch}", "reflash the board")
    return EStopEngage(by="the base board", reason=_LATCHED_BY.get(latch, unknown))


def held(report: WheelsFrame) -> Trouble:
    """Return which wheel something held. NO_TROUBLE: the board says that none was."""
    if report.drive_state != DriveState.HELD:
        return NO_TROUBLE
    sides = ((SpeedFlag.LEFT_HELD, "left"), (SpeedFlag.RIGHT_HELD, "right"))
    names = [side for flag, side in sides if report.speed_flags & flag]
    which = f"the {names[0]} wheel was" if len(names) == 1 else "both wheels were" if names else "a wheel was"
    return Trouble(f"{which} held", "clear the way, or check its encoder, motor and battery")


def limit(report: WheelsFrame, board: BoardType) -> Trouble:
    """Why the wheels do less than they are asked for."""
    if not report.speed_flags & _AT_LIMIT_FLAG:
        return NO_TROUBLE
    return Trouble(_AT_LIMIT + (_OR_LOWERED if board.has_potentiometer else ""))
