"""A drive and what it tells of the motors, as a person reads it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from giraff_setup.wheels.speed.fit import SPEED, Follow, Leg, Motor, respond
from giraff_tools.terminal.dots import draw_curves

_POINTS: Final = 288  # two for each column of dots
_ASKED_POINTS: Final = 36  # the asked speed is dotted
_SURPRISE: Final = 0.1  # share by which max_wheel_speed may differ unsaid


def tell_drive(legs: Sequence[Leg], *, dots: bool) -> Iterator[str]:
    """Return the picture of the way ahead, and a row for each wheel and way. Raises CannotTellError."""
    ahead = [leg for leg in legs if leg.way == "ahead"]
    seconds = min(float(leg.seconds[-1]) for leg in ahead)
    at = np.linspace(0.0, seconds, _POINTS)
    curves = [[float(speed) * 100.0 for speed in np.interp(at, leg.seconds, leg.speed)] for leg in ahead]
    yield "speed of both wheels on the way ahead, and what was asked (dotted), in cm/s:"
    top = max(SPEED * 100.0, *(max(curve) for curve in curves))
    yield from draw_curves([*curves, [SPEED * 100.0] * _ASKED_POINTS], 0.0, top, round(seconds, 1), dots=dots)
    yield ""
    yield f"{'wheel':7}{'way':7}{'rise (10 to 90 %)':>18}{'overshoot':>11}{'error':>10}"
    for leg in legs:
        rise, overshoot, error = respond(leg)
        yield f"{leg.side:7}{leg.way:7}{f'{rise:.2f} s':>18}{f'{overshoot:.1%}':>11}{f'{error:+.1%}':>10}"


def tell_motors(legs: Sequence[Leg], motors: Sequence[Motor]) -> Iterator[str]:
    """Return a row for each measurement."""
    yield f"{'wheel':7}{'way':7}{'m/s per PWM count':>18}{'time constant':>15}"
    for leg, motor in zip(legs, motors, strict=True):
        yield f"{leg.side:7}{leg.way:7}{motor.per_count:>18.5f}{f'{motor.time:.3f} s':>15}"


def tell_changes(changes: Mapping[str, tuple[float, float]], bound: Mapping[str, float]) -> Iterator[str]:
    """Return a row for each setting."""
    yield f"{'':12}{'now':>8}{'found':>8}{'known within':>15}"
    for name, (before, after) in changes.items():
        yield f"{name:12}{before:>8g}{after:>8g}{f'{bound[name]:.0%}':>15}"


def tell_follow(before: Follow, after: Follow) -> Iterator[str]:
    """Return a row for each drive."""
    yield f"{'drive':20}{'overshoot':>11}{'error':>10}"
    for name, drive in (("as the file was", before), ("with these gains", after)):
        yield f"{name:20}{f'{drive.overshoot:.1%}':>11}{f'{drive.error:.1%}':>10}"


def tell_fastest(found: float, filed: float, max_level: int, *, battery_known: bool) -> str:
    """Return what `max_wheel_speed` should be; nothing where the robot file is about right."""
    if abs(found - filed) <= _SURPRISE * filed:
        return ""
    battery = "battery_nominal" if battery_known else "the battery as it is now"
    return (
        f"max_wheel_speed is {filed:g} m/s in the robot file; by this drive a wheel does {found:.2f} m/s at max_level "
        f"{max_level} and {battery}. Measure it with the wheels lifted: docs/commissioning.md, Speeds that are held."
    )
