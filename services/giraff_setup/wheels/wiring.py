"""From what one saw and counted when each motor was driven alone: how motors and encoders are wired. Pure."""

from typing import Final, Literal, NamedTuple, Self

from giraff_core.robot import WIRING
from giraff_schemas.wire import Latch

Side = Literal["left", "right"]
Turned = Literal["left", "right", "both", "none"]

SIDES: Final[tuple[Side, Side]] = ("left", "right")

_TURNED: Final = 0.005  # m of its rim, at least, of a wheel that turned
_FEWEST: Final = 10  # ticks: one that trembles on an edge counts one or two


_ONE_WAY: Final = (
    "check the wires of its driver's direction inputs for a break or a short, and whether a half of the driver is dead"
)


class DoubtError(Exception):
    """What was seen makes no sense. The message names the likely cause, and the way out."""


class Counted(NamedTuple):
    """Ticks that came in while one motor was driven."""

    left: int
    right: int
    fewest: int = _FEWEST
    """Of a wheel that turned."""

    @classmethod
    def at(cls, left: int, right: int, ticks_per_metre: float) -> Self:
        """With the fewest that so fine encoders give."""
        return cls(left, right, max(_FEWEST, round(_TURNED * ticks_per_metre)))


class MotorResponse(NamedTuple):
    """What one motor did when it alone was driven forward, with nothing swapped or inverted."""

    counted: Counted
    wheel: Turned
    """That a human saw turn."""
    forward: bool
    """Which way."""


def encoder_that_counted(counted: Counted) -> Side | None:
    """The one encoder that counted, or None when none did; DoubtError when both did."""
    left, right = abs(counted.left), abs(counted.right)
    if max(left, right) < counted.fewest:
        return None
    if min(left, right) > max(2, max(left, right) // 10):
        raise DoubtError(
            f"both encoders counted ({counted.left} left, {counted.right} right) while one motor was driven; "
            "lift both wheels clear of the ground, and keep hands off them"
        )
    return "left" if left > right else "right"


def wiring_of(first: MotorResponse, second: MotorResponse) -> dict[str, bool]:
    """The six fields of the robot file. `first`: of the motor that is left unless swapped; `second`: of the other."""
    encoders = [encoder_of(seen) for seen in (first, second)]
    if first.wheel == second.wheel:
        raise DoubtError(
            f"both motors are said to turn the {first.wheel} wheel; go through it again and look at one wheel at a time"
        )
    if encoders[0] == encoders[1]:
        raise DoubtError(
            f"the {encoders[0]} encoder counted for both motors; the other one's plug is off, or both wheels turned"
        )
    fields = {"swap_motors": first.wheel == "right", "swap_encoders": encoders[0] != first.wheel}
    for seen, encoder in zip((first, second), encoders, strict=True):
        counted = seen.counted.left if encoder == "left" else seen.counted.right
        fields[f"invert_{seen.wheel}_motor"] = not seen.forward
        fields[f"invert_{seen.wheel}_encoder"] = (counted > 0) != seen.forward
    return {name: fields[name] for name in WIRING}


def require_right(side: Side, counted: Counted) -> None:
    """DoubtError unless `side` alone counted forward, as it must once the wiring is known and `side` drives forward."""
    encoder = encoder_that_counted(counted)
    ticks = counted.left if side == "left" else counted.right
    if encoder != side or ticks < 0:
        raise DoubtError(
            f"with the wiring that was found, driving the {side} wheel forward counted {counted.left} left and "
            f"{counted.right} right; an answer was wrong, or a plug is loose: go through it again"
        )


def require_asked_power(motor: str, counted: Counted, most: int) -> None:
    """DoubtError where a wheel counted more than `most` ticks: its motor has full power, whatever it is asked."""
    fastest = max(abs(counted.left), abs(counted.right))
    if fastest > most:
        raise DoubtError(
            f"{motor} ran far too fast: {fastest} ticks, where {most} are too many; take the jumpers off ENA and ENB "
            "of an L298N, and see that no input of the driver is shorted; else correct ticks_per_metre, max_level "
            "and max_wheel_speed"
        )


def require_both_ways(side: Side, forward: Counted, backward: Counted, latch: Latch) -> None:
    """DoubtError unless the wheel, driven backward, turned alone, and half as far as forward at least."""
    ahead, back = (each.left if side == "left" else each.right for each in (forward, backward))
    if latch != Latch.NONE or encoder_that_counted(backward) != side or back > -ahead / 2:
        raise DoubtError(
            f"the {side} wheel turns forward and not backward as well: {ahead} and {back} ticks; {_ONE_WAY}"
        )


def require_no_motion(motor: str, backward: Counted) -> None:
    """DoubtError where a motor that did not turn forward turns backward."""
    if encoder_that_counted(backward) is not None:
        raise DoubtError(f"{motor} turns backward and not forward; {_ONE_WAY}")


def encoder_of(seen: MotorResponse) -> Side:
    """The encoder of the one wheel that turned; DoubtError unless there is one of each."""
    encoder = encoder_that_counted(seen.counted)
    if seen.wheel == "both":
        raise DoubtError("one motor turned both wheels; lift them clear of the ground, and of each other")
    if seen.wheel == "none" and encoder is None:
        raise DoubtError(
            "the motor was driven and nothing turned; check battery, battery switch, motor plug and driver, "
            "and raise stall_level in the robot file if the wheel only hums"
        )
    if seen.wheel == "none":
        raise DoubtError(f"the {encoder} encoder counted, and no wheel is said to have turned; go through it again")
    if encoder is None:
        raise DoubtError(
            f"the {seen.wheel} wheel turned and no encoder counted; check the encoder's plug and its supply"
        )
    return encoder
