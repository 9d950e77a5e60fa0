"""The time series: which there are, their colours, and which sample feeds which."""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

from giraff_core.operator import ASKS_NOTHING
from giraff_schemas.messages import (
    Attitude,
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

BALANCE_PLOTS: Final[dict[str, tuple[str, dict[str, Colour]]]] = {
    "lean": ("lean, degrees", {"accelerometer": VIOLET, "fused": GREEN, "trim": WHITE}),
    "rate": ("lean rate, degrees/s", {"rate": AMBER}),
    "wheels": ("wheels, m/s", {"left": CYAN, "right": PINK}),
    "torque": ("torque of both motors, N m", {"torque": BLUE}),
}
"""The plots of a robot that balances, before the others."""
BALANCE_PWM: Final = "motor command, 255 is full"
"""Title of the plot `pwm` of such a robot, whose motor driver takes no PWM."""

_RANGE_COLOURS: Final = (CYAN, PINK, AMBER, GREEN, BLUE, VIOLET)


def series(sensors: tuple[str, ...]) -> list[Series]:
    """All lines of a robot with these sensors."""
    lines = _lines(PLOTS)
    colours = (_RANGE_COLOURS[number % len(_RANGE_COLOURS)] for number in range(len(sensors)))
    return lines + [Series(_range_path(name), name, colour) for name, colour in zip(sensors, colours, strict=True)]


def balance_series() -> list[Series]:
    """Return the lines that a robot has beside them when it balances."""
    return _lines(BALANCE_PLOTS)


def _lines(plots: dict[str, tuple[str, dict[str, Colour]]]) -> list[Series]:
    return [Series(f"plots/{plot}/{name}", name, c) for plot, (_, names) in plots.items() for name, c in names.items()]


class Values:
    """Makes values of samples. An age is by the robot's own clock, whatever the hosts' clocks say."""

    def __init__(self) -> None:
        self._now: RobotTime | None = None
        self.balances = False
        """The robot has told its attitude."""

    def of(self, sample: Sample) -> Iterator[Value]:
        """What a sample adds to the plots."""
        match sample:
            case Tick():
                self._now = sample.time
            case DriveCommand() | GuardedCommand() | Odometry():
                yield from self._motion(sample)
            case Wheels():
                yield from self._wheels(sample)
            case Attitude():
                self.balances = True
                yield "plots/lean/accelerometer", math.degrees(sample.accelerometer_lean)
                yield "plots/lean/fused", math.degrees(sample.lean)
                yield "plots/lean/trim", math.degrees(sample.trim)
                yield "plots/rate/rate", math.degrees(sample.rate)
                yield "plots/torque/torque", sample.torque
            case Range():
                yield _range_path(sample.sensor), math.nan if sample.range is None else sample.range
                yield from self._age("ranges", sample.tick)
            case Battery():
                yield "plots/battery/voltage", sample.voltage
            case BaseState():
                for name, value in (("round_trip", sample.round_trip), ("budget_left", sample.budget_left)):
                    # A budget that is used up stays at -disarm_time, which would press all ages to the upper edge.
                    yield f"plots/ages/{name}", math.nan if value is None or value < 0.0 else value
            case Tilt():
                yield from self._age("tilt", sample.tick)

    def _motion(self, sample: DriveCommand | GuardedCommand | Odometry) -> Iterator[Value]:
        if isinstance(sample, DriveCommand) and sample.lease_counter == ASKS_NOTHING:
            return  # of an operator that watches: its zeros are not what the robot is asked for
        who = {DriveCommand: "commanded", GuardedCommand: "guarded", Odometry: "measured"}[type(sample)]
        yield f"plots/speed/{who}", sample.linear_x
        yield f"plots/turn/{who}", sample.angular_z
        if isinstance(sample, Odometry):
            yield from self._age("odom", sample.tick)

    def _wheels(self, sample: Wheels) -> Iterator[Value]:
        yield "plots/pwm/left", float(sample.left_pwm_counts)
        yield "plots/pwm/right", float(sample.right_pwm_counts)
        if self.balances:
            yield "plots/wheels/left", sample.left_velocity
            yield "plots/wheels/right", sample.right_velocity

    def _age(self, of: str, tick: RobotTime | None) -> Iterator[Value]:
        if self._now is not None and tick is not None and tick.epoch == self._now.epoch:
            yield f"plots/ages/{of}", max(0.0, (self._now.robot_ns - tick.robot_ns) * 1e-9)


def _range_path(sensor: str) -> str:
    return f"plots/ranges/{sensor}"
