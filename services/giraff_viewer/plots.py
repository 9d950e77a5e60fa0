"""The time series: which there are, their colours, and which sample feeds which."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

from giraff_schemas.messages import (
    BaseState,
    Battery,
    DriveCommand,
    GuardedCommand,
    Odometry,
    Range,
    RobotTime,
    Sample,
    Tick,
    Tilt,
    Wheels,
)
from giraff_viewer.colours import AMBER, BLUE, CYAN, GREEN, PINK, RED, VIOLET, WHITE, Colour

Value = tuple[str, float]
"""Path of a series, and its newest value."""


class Series(NamedTuple):
    """One line of a plot."""

    path: str
    name: str
    colour: Colour


PLOTS: Final[dict[str, tuple[str, dict[str, Colour]]]] = {
    "speed": ("speed, m/s", {"commanded": AMBER, "guarded": BLUE, "measured": GREEN}),
    "turn": ("turning, rad/s", {"commanded": AMBER, "guarded": BLUE, "measured": GREEN}),
    "pwm": ("PWM, counts of 255", {"left": CYAN, "right": PINK}),
    "ranges": ("ranges, m", {}),
    "battery": ("battery, V", {"voltage": AMBER}),
    "ages": ("ages, s", {"round_trip": WHITE, "budget_left": RED, "tilt": AMBER, "ranges": VIOLET, "odom": GREEN}),
}
"""By plot: its title and its lines; those of the ranges are the sensors."""

_RANGE_COLOURS: Final = (CYAN, PINK, AMBER, GREEN, BLUE, VIOLET)


def series(sensors: tuple[str, ...]) -> list[Series]:
    """All lines of a robot with these sensors."""
    lines = [Series(f"plots/{plot}/{name}", name, c) for plot, (_, names) in PLOTS.items() for name, c in names.items()]
    colours = (_RANGE_COLOURS[number % len(_RANGE_COLOURS)] for number in range(len(sensors)))
    return lines + [Series(_range_path(name), name, colour) for name, colour in zip(sensors, colours, strict=True)]


class Values:
    """Makes values of samples. An age is by the robot's own clock, whatever the hosts' clocks say."""

    def __init__(self) -> None:
        self._now: RobotTime | None = None

    def of(self, sample: Sample) -> Iterator[Value]:
        """What a sample adds to the plots."""
        match sample:
            case Tick():
                self._now = sample.time
            case DriveCommand() | GuardedCommand() | Odometry():
                yield from self._motion(sample)
            case Wheels():
                yield "plots/pwm/left", float(sample.left_pwm_counts)
                yield "plots/pwm/right", float(sample.right_pwm_counts)
            case Range():
                yield _range_path(sample.sensor), math.nan if sample.range is None else sample.range
                yield from self._age("ranges", sample.tick)
            case Battery():
                yield "plots/battery/voltage", sample.voltage
            case BaseState():
                for name, value in (("round_trip", sample.round_trip), ("budget_left", sample.budget_left)):
                    yield f"plots/ages/{name}", math.nan if value is None else value
            case Tilt():
                yield from self._age("tilt", sample.tick)

    def _motion(self, sample: DriveCommand | GuardedCommand | Odometry) -> Iterator[Value]:
        who = {DriveCommand: "commanded", GuardedCommand: "guarded", Odometry: "measured"}[type(sample)]
        yield f"plots/speed/{who}", sample.linear_x
        yield f"plots/turn/{who}", sample.angular_z
        if isinstance(sample, Odometry):
            yield from self._age("odom", sample.tick)

    def _age(self, of: str, tick: RobotTime | None) -> Iterator[Value]:
        if self._now is not None and tick is not None and tick.epoch == self._now.epoch:
            yield f"plots/ages/{of}", max(0.0, (self._now.robot_ns - tick.robot_ns) * 1e-9)


def _range_path(sensor: str) -> str:
    return f"plots/ranges/{sensor}"
