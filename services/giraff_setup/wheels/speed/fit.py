"""Motor constants of two wheels from a drive ahead and back, and the gains that follow from them."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from giraff_base.drives.wheels.config import SpeedControl
from giraff_core.bounds import bounds_of
from giraff_core.counters import elapsed_us, restart, signed32
from giraff_schemas.messages import Wheels
from giraff_setup.condition import is_determined

Vector = NDArray[np.float64]

DISTANCE: Final = 0.5
"""m that the robot drives ahead, and back."""
SPEED: Final = 0.25  # m/s
SIDES: Final = ("left", "right")
CLOSES_AT: Final = 0.1
"""s. Time constant of the closed loop, as the defaults of `SpeedControl` have it."""

_PLATEAU: Final = (0.2, 0.36)  # m of the leg between which the asked speed is constant: no start and no end
_LONGEST_GAP: Final = 0.1  # s between two samples
_DISAGREEMENT: Final = 0.1  # share by which speeds and counts may tell different ways
_TIMES: Final = (0.02, 1.0)  # s between which a motor's time constant is credible
_ROUGHEST: Final = 0.004  # m, rms, by which a wheel may differ from the model
_LEAST_CHANGE: Final = 0.15  # share of a gain: less is neither felt nor measured
_MOST_SPREAD: Final = 0.5  # share by which the measurements may differ and still tell a gain
_WEAK: Final = 0.25  # of the plateau's PWM: a motor that gets less while it brakes only hums, and follows no model
_FELT: Final = 0.01  # share of the asked speed: less is no better drive
_FEWEST: Final = 50  # samples of a leg
_DEFAULTS: Final = SpeedControl()
RULE: Final[dict[str, Callable[["Motor"], float]]] = {
    "motor_time": lambda motor: motor.time,
    "speed_p": lambda motor: motor.time / (motor.per_count * CLOSES_AT),
    "speed_i": lambda motor: 1.0 / (motor.per_count * CLOSES_AT),
    "turn_p": lambda motor: _DEFAULTS.turn_p / _DEFAULTS.speed_p * RULE["speed_p"](motor),
    "turn_i": lambda motor: _DEFAULTS.turn_i / _DEFAULTS.speed_i * RULE["speed_i"](motor),
}
"""Each setting that a drive tells, by the rule of the defaults."""


class CannotTellError(Exception):
    """The drive does not determine the motors. The message says why, and the remedy."""


class Leg(NamedTuple):
    """One wheel on the way ahead or back. Its way counts as positive."""

    side: str
    way: str
    seconds: Vector
    travel: Vector
    """m, by the encoder's counts."""
    speed: Vector
    """m/s, as the board measures it."""
    pwm: Vector
    """PWM counts."""


class Response(NamedTuple):
    """The response of one wheel."""

    rise: float
    """s from 10 to 90 % of the plateau."""
    overshoot: float
    """Share of the asked speed."""
    error: float
    """Share of the asked speed by which the plateau is faster."""


class Follow(NamedTuple):
    """The worst response of both wheels, ahead and back, as shares of the asked speed."""

    overshoot: float
    error: float
    """Largest difference from the asked speed in the second half of the way, before the wheel brakes."""

    @property
    def is_good(self) -> bool:
        """Return True if no drive can be shown to be better."""
        return max(self) <= _FELT

    def beats(self, other: "Follow") -> bool:
        """Return True if this drive is better.

        Overshoot or error is smaller by more than `_FELT`. Error is not larger, and overshoot not by more than that.
        """
        overshoot, error = other.overshoot - self.overshoot, other.error - self.error
        return error >= 0.0 and overshoot >= -_FELT and max(overshoot, error) > _FELT


class Motor(NamedTuple):
    """First-order model of a wheel's motor with its share of the robot."""

    per_count: float
    """m/s for each PWM count."""
    time: float
    """s. Time constant."""
    dead: float
    """PWM counts that friction takes."""


class Proposal(NamedTuple):
    """Settings by the rule of the defaults, and how well they are known."""

    control: SpeedControl
    bound: dict[str, float]
    """Share by which each setting may be off: how far the four measurements differ from their mean, and how much the
    mean moves if the PWM was in force from the sample before on, or only from the next one on."""

    def changes(self, present: SpeedControl) -> dict[str, tuple[float, float]]:
        """Return each setting before and after; nothing where none of `present` is off by more than can be told."""
        pairs = {name: (float(getattr(present, name)), float(getattr(self.control, name))) for name in self.bound}
        is_off = any(
            abs(before - after) > max(_LEAST_CHANGE, self.bound[name]) * after
            for name, (before, after) in pairs.items()
        )
        return pairs if is_off else {}


def legs_of(heard: Sequence[Wheels], ticks_per_metre: tuple[float, float]) -> list[Leg]:
    """Return both wheels' way ahead and way back. Raises CannotTellError."""
    seconds, ticks = _unwrapped(heard)
    legs: list[Leg] = []
    for side, name in enumerate(SIDES):
        speed = np.array([getattr(wheels, f"{name}_velocity") for wheels in heard], dtype=np.float64)
        pwm = np.array([getattr(wheels, f"{name}_pwm_counts") for wheels in heard], dtype=np.float64)
        travel = ticks[:, side] / ticks_per_metre[side]
        for way, sign in (("ahead", 1.0), ("back", -1.0)):
            at = _longest(pwm * sign > 0)
            if at.start == at.stop:
                raise CannotTellError(f"the {name} motor got nothing on the way {way}; check that the robot drove")
            legs.append(
                Leg(
                    name,
                    way,
                    seconds[at] - seconds[at.start],
                    sign * (travel[at] - travel[at.start]),
                    sign * speed[at],
                    sign * pwm[at],
                )
            )
    return legs


def respond(leg: Leg, asked: float = SPEED) -> Response:
    """Return how a wheel followed. Raises CannotTellError."""
    on_plateau = (leg.travel >= _PLATEAU[0]) & (leg.travel <= _PLATEAU[1])
    if not on_plateau.any():
        raise CannotTellError(f"the {leg.side} wheel came {leg.travel.max():.2f} m {leg.way}; check its encoder")
    plateau = float(np.mean(leg.speed[on_plateau]))
    first, last = (leg.seconds[np.argmax(leg.speed >= share * plateau)] for share in (0.1, 0.9))
    return Response(float(last - first), max(0.0, float(leg.speed.max()) / asked - 1.0), plateau / asked - 1.0)


def follow(legs: Sequence[Leg]) -> Follow:
    """Return how the wheels followed. Raises CannotTellError."""
    late = [leg.speed[(leg.travel >= DISTANCE / 2.0) & (leg.travel <= _PLATEAU[1])] for leg in legs]
    overshoots = [respond(leg).overshoot for leg in legs]
    return Follow(max(overshoots), max(float(np.max(np.abs(speeds / SPEED - 1.0))) for speeds in late))


def identify(leg: Leg, late: float = 0.0) -> Motor:
    """Fit v' = (K (u - dead) - v) / time to the way by counts, integrated twice: nothing is differentiated.

    It begins with the first count, after stiction, and ends where braking leaves the motor hardly any power. `late`:
    when a sample's PWM was in force, from -1 (up to the next sample) to 1 (since the one before).
    Raises CannotTellError.
    """
    begin = int(np.argmax(leg.travel > 0.0))
    driven = leg.pwm > _WEAK * np.median(leg.pwm)
    weak = np.flatnonzero(~driven & (leg.travel > _PLATEAU[1]))
    at = slice(begin, int(weak[0]) if weak.size else len(leg.pwm))
    seconds, way, pwm = leg.seconds[at] - leg.seconds[begin], leg.travel[at] - leg.travel[begin], leg.pwm[at]
    by_speed = float(_integral(leg.speed[at], seconds)[-1])
    if abs(by_speed - way[-1]) > _DISAGREEMENT * way[-1]:
        raise CannotTellError(
            f"the {leg.side} wheel came {by_speed:.2f} m by its speed and {way[-1]:.2f} m by its counts; "
            "check that ticks_per_metre is the same in this robot file and in the robot's"
        )
    unclear = CannotTellError(
        f"the {leg.side} wheel's way {leg.way} does not tell its motor; let it drive on a hard, level, free floor"
    )
    if len(seconds) < _FEWEST or way[-1] < _PLATEAU[1]:
        raise unclear
    shift = late / 2.0 * float(np.mean(np.diff(seconds)))
    pushed = _integral(_integral(pwm, seconds) + shift * (pwm - pwm[0]), seconds)
    regressors = np.column_stack([seconds, pushed, seconds**2 / 2.0, _integral(way, seconds)])
    if not is_determined(regressors.T @ regressors):
        raise unclear
    fitted = np.linalg.lstsq(regressors, way)[0]
    _, push, drag, back = fitted
    rough = float(np.sqrt(np.mean((regressors @ fitted - way) ** 2)))
    if not (push > 0.0 and back < 0.0 and _TIMES[0] <= -1.0 / back <= _TIMES[1] and rough <= _ROUGHEST):
        raise unclear
    return Motor(per_count=float(-push / back), time=float(-1.0 / back), dead=float(-drag / push))


def measure(legs: Sequence[Leg], present: SpeedControl) -> tuple[list[Motor], Proposal]:
    """Return the motors by each leg, and the settings for them. Raises CannotTellError."""
    motors, early, late = ([identify(leg, at) for leg in legs] for at in (0.0, -1.0, 1.0))
    return motors, propose(motors, present, early, late)


def propose(motors: Sequence[Motor], present: SpeedControl, *otherwise: Sequence[Motor]) -> Proposal:
    """Return the settings for these measurements, which must agree. Raises CannotTellError.

    `otherwise`: other readings of the same legs.
    """
    found, bound = {}, {}
    for name, setting in RULE.items():
        values = [setting(motor) for motor in motors]
        mean = sum(values) / len(values)
        spread = max(abs(value - mean) for value in values) / mean
        if spread > _MOST_SPREAD:
            raise CannotTellError(
                f"{name} is {min(values):.3g} by one measurement and {max(values):.3g} by another; "
                "check that no wheel drags or slips, and that the floor is level"
            )
        means = [sum(map(setting, other)) / len(other) for other in otherwise]
        bound[name] = spread + max((abs(other / mean - 1.0) for other in means), default=0.0)
        low, high, *_ = bounds_of(SpeedControl)[name]
        found[name] = min(high, max(low, float(f"{mean:.3g}")))
    return Proposal(msgspec.structs.replace(present, **found), bound)


def fastest(motors: Sequence[Motor], max_level: int, voltage_ratio: float) -> float:
    """Return m/s of a wheel at `max_level` and the nominal battery, which is 1 / `voltage_ratio` of that of now."""
    return sum(motor.per_count * (max_level / voltage_ratio - motor.dead) for motor in motors) / len(motors)


def _longest(driven: NDArray[np.bool_]) -> slice:
    """Return the longest stretch without a pause; an empty one where there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], driven, [False]]).astype(int)))
    begins, ends = edges[::2], edges[1::2]
    if not begins.size:
        return slice(0, 0)
    which = int(np.argmax(ends - begins))
    return slice(int(begins[which]), int(ends[which]))


def _integral(values: Vector, seconds: Vector) -> Vector:
    steps = np.diff(seconds) * (values[1:] + values[:-1]) / 2.0
    return np.concatenate([[0.0], np.cumsum(steps)])


def _unwrapped(heard: Sequence[Wheels]) -> tuple[Vector, Vector]:
    """Return s and both counters from the first sample. Raises CannotTellError."""
    seconds, ticks = [0.0], [(0, 0)]
    for before, now in pairwise(heard):
        elapsed = elapsed_us(before, now) / 1e6
        if restart(before, now) or elapsed > _LONGEST_GAP:
            raise CannotTellError("wheels were not heard all the way; check base, and the network to it")
        left, right = ticks[-1]
        seconds.append(seconds[-1] + elapsed)
        ticks.append(
            (
                left + signed32(now.left_ticks - before.left_ticks),
                right + signed32(now.right_ticks - before.right_ticks),
            )
        )
    return np.array(seconds), np.array(ticks, dtype=np.float64)
