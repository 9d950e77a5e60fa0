"""What is done to a drawn robot that balances, and what it then may do: rows of tests."""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np

from giraff_base.drives.balancer.config import BalancerConfig
from giraff_schemas.wires.balancer import BalanceFlag, BalanceSide
from giraff_sim.bodies.balancer.people import Spring, Threshold
from giraff_sim.bodies.balancer.sensors import VOLTS_PER_COUNT
from tests.support.balancer import HANDLE, PROTOTYPE, Balancer
from tests.support.balancer_file import DRIVE

Figures = dict[str, float]
SETTLE_S: Final = 8.0
DECELERATION: Final = 0.35
"""m/s². `[guard] deceleration` of the robot's file."""


class Row(NamedTuple):
    """One situation."""

    play: Callable[[int], Figures]
    at_most: Mapping[str, float]
    """The largest value of each figure."""
    mostly: Mapping[str, tuple[float, int]] = {}
    """The same, and how many of twenty robots may have a larger one."""
    at_least: Mapping[str, float] = {}


def side_of(seed: int) -> float:
    """Return the side to which a robot is pushed, or sits down: forward for every other one."""
    return 1.0 if seed % 2 else -1.0


def known_zero(seed: int) -> dict[str, Any]:
    """Return the zero of an accelerometer that was found to 0.3 degrees."""
    return {"accelerometer_zero": math.radians(0.3) * side_of(seed)}


def stands(
    seed: int,
    seconds: float,
    settle: float = SETTLE_S,
    act: Callable[[Balancer], None] = lambda _: None,
    drive: BalancerConfig = DRIVE,
    **fixed: Any,
) -> Figures:
    """Let it stand by itself, do something to it, and return figures of what follows."""
    robot = Balancer(seed, drive, **fixed)
    try:
        robot.stand(settle)
        return then(robot, seconds, act, side_of(seed))
    finally:
        robot.close()


def then(robot: Balancer, seconds: float, act: Callable[[Balancer], None], side: float) -> Figures:
    """Do something to a robot and return figures of what follows."""
    was_active = robot.body.activity
    act(robot)
    figures = robot.run(seconds).figures(side)
    figures["up"] = float(robot.stands)
    figures["held"] = float(bool(robot.flags & BalanceFlag.HELD))
    figures["active_before"], figures["active"] = float(was_active), float(robot.body.activity)
    figures["late"] = float(robot.late)
    figures["right_side"] = float(math.copysign(1.0, robot.plant.lean) == side)
    figures["top"] = abs(robot.plant.landed)
    return figures


def pushed(robot: Balancer, impulse: float, seconds: float, side: float) -> Figures:
    return then(robot, seconds, lambda each: each.body.push(impulse * side, HANDLE), side)


def pushes(impulse: float, seconds: float = 6.0, **stands_how: Any) -> Callable[[int], Figures]:
    return lambda seed: stands(
        seed, seconds, act=lambda robot: robot.body.push(impulse * side_of(seed), HANDLE), **stands_how
    )


def leaned_on(seed: int) -> Figures:
    robot = Balancer(seed)
    robot.stand(SETTLE_S)
    robot.plant.loads.force, robot.plant.loads.height = 6.0 * side_of(seed), HANDLE
    robot.run(5.0)
    robot.plant.loads.force = 0.0
    figures = then(robot, 5.0, lambda _: None, side_of(seed))
    robot.close()
    return figures


def held(speed: float) -> Callable[[int], Figures]:
    """Take hold of the handle of one that stands, and ask it for a speed. `touch` is the N that the person feels."""

    def play(seed: int) -> Figures:
        robot = Balancer(seed)
        robot.stand(SETTLE_S)
        plant = robot.plant
        plant.loads.spring = Spring(plant.way + HANDLE * math.sin(plant.lean), HANDLE, stiffness=500.0, damping=30.0)
        felt = [0.0]
        robot.before_each_ms = lambda: felt.append(abs(plant.touch))
        robot.linear = speed * side_of(seed)
        figures = then(robot, 6.0, lambda _: None, side_of(seed)) | {"touch": max(felt)}
        robot.close()
        return figures

    return play


def starts(speed: float) -> Callable[[int], Figures]:
    """Ask one that stands for a speed. `over`: m/s by which it is too fast, `back`: m that it first rolls back."""

    def play(seed: int) -> Figures:
        robot, side = Balancer(seed), side_of(seed)
        robot.stand(SETTLE_S)
        robot.linear = speed * side
        track = robot.run(6.0)
        ways, speeds = ([side * value for value in values] for values in list(zip(*track.rows, strict=True))[:2])
        robot.close()
        return {"up": float(robot.stands), "over": max(speeds) - speed, "back": -min(ways)}

    return play


def stopped(
    speed: float,
    *,
    by_silence: bool = False,
    by_zero: bool = False,
    settle: float = SETTLE_S,
    after: float | None = None,
) -> Callable[[int], Figures]:
    """Drive at a steady speed, or for `after` s, stop it by its latch, and go on asking it to drive.

    `by_zero`: it is asked for nothing, as by each stop of the guard. A silent host counts from its time-out.
    `run_on`: m that it goes beyond those of braking at 0.35 m/s².
    """

    def play(seed: int) -> Figures:
        robot, side = Balancer(seed), side_of(seed)
        robot.stand(settle)
        robot.linear = speed * side
        robot.run(after or 5.0 + speed / 0.25)
        robot.is_silent = by_silence
        if by_silence:
            robot.run(0.3)
        elif by_zero:
            robot.linear = 0.0
        else:
            robot.engage()
        figures = then(robot, 6.0 if settle >= SETTLE_S else 3.0, lambda _: None, side)
        robot.close()
        return figures | {"run_on": figures["away"] - speed**2 / (2.0 * DECELERATION)}

    return play


def sits(seed: int, speed: float = 0.0) -> Figures:
    robot, side = Balancer(seed), side_of(seed)
    robot.stand(SETTLE_S)
    robot.linear = speed * side
    robot.run(5.0 if speed else 0.0)
    figures = then(robot, 5.0, lambda each: each.sit(side), side)
    robot.close()
    return figures


def onto_slope(seed: int) -> Figures:
    def act(robot: Balancer) -> None:
        began = robot.plant.seconds

        def rise() -> None:
            robot.plant.loads.slope = math.radians(3.0) * min(1.0, 2.0 * (robot.plant.seconds - began))

        robot.before_each_ms = rise

    return stands(seed, 10.0, act=act)


def with_bag(seed: int) -> Figures:
    def act(robot: Balancer) -> None:
        robot.plant.loads.bag = 6.0 * side_of(seed)

    return stands(seed, 10.0, act=act)


def over_threshold(seed: int) -> Figures:
    robot = Balancer(seed)
    robot.stand(SETTLE_S)
    robot.linear = 0.4
    robot.run(5.0)
    robot.plant.loads.threshold = Threshold(robot.plant.way + 0.15, 0.005)
    figures = then(robot, 6.0, lambda _: None, 1.0)
    robot.close()
    return figures


def prototype_stands(seed: int) -> Figures:
    """Return figures of 30 s in which the robot without encoders stands."""
    return stands(seed, 30.0, settle=0.0, drive=PROTOTYPE, **known_zero(seed))


def prototype_pushed(seed: int, settle: float = 2.0) -> Figures:
    """Return figures of a push of 4 N s, soon after the robot without encoders stands: later it may be on its way."""
    return pushes(4.0, 4.0, settle=settle, drive=PROTOTYPE, **known_zero(seed))(seed)


class Errand:
    """Asks it to drive, to turn and to stand. People push it up to so many N s, half as hard while it drives."""

    def __init__(self, robot: Balancer, seed: int, hardest: float) -> None:
        self._robot, self._hardest = robot, hardest
        self._chance = np.random.default_rng(seed + 900)
        self._began = robot.plant.seconds
        self._next_wish, self._next_push = 0.0, self._chance.uniform(5.0, 20.0)

    def go_on(self) -> None:
        robot, chance, now = self._robot, self._chance, self._robot.plant.seconds - self._began
        if now >= self._next_wish:
            self._next_wish = now + chance.uniform(2.0, 6.0)
            robot.linear = chance.uniform(-0.4, 0.4) * (chance.random() < 0.7)
            robot.angular = chance.uniform(-0.8, 0.8) * (chance.random() < 0.5)
        if self._hardest and now >= self._next_push:
            self._next_push = now + chance.uniform(10.0, 25.0)
            impulse = chance.choice([-1.0, 1.0]) * chance.uniform(1.0, self._hardest)
            robot.body.push(impulse * (0.5 if abs(robot.plant.speed) > 0.15 else 1.0), chance.uniform(0.0, HANDLE))


def among_people(seed: int) -> Figures:
    """Return figures of ten minutes with a push of up to 8 N s every 10 to 25 s."""
    robot = Balancer(seed)
    robot.stand(SETTLE_S)
    robot.before_each_ms = Errand(robot, seed, 8.0).go_on
    figures = then(robot, 600.0, lambda _: None, 1.0)
    robot.close()
    return figures


def broken(
    fault: Callable[[Balancer], None], *, moves: bool, seconds: float = 5.0, speed: float = 0.0
) -> Callable[[int], Figures]:
    """Break something while it stands or drives, at a steady speed or to and fro, and go on asking for the same."""

    def play(seed: int) -> Figures:
        robot = Balancer(seed)
        robot.stand(SETTLE_S)
        side = side_of(seed)
        robot.free_side = BalanceSide.FORWARD if side > 0.0 else BalanceSide.BACKWARD
        if moves:
            robot.linear = speed * side
            if not speed:
                robot.before_each_ms = Errand(robot, seed, 0.0).go_on
            robot.run(8.0)
            robot.before_each_ms = lambda: None
        figures = then(robot, seconds, fault, side)
        robot.close()
        return figures

    return play


def sensor_at(volts: float, *channels: int) -> Callable[[Balancer], None]:
    return lambda robot: robot.body.sensors.broken.update(dict.fromkeys(channels, partial(_hold, volts)))


def sensor_frozen(*channels: int) -> Callable[[Balancer], None]:
    def fault(robot: Balancer) -> None:
        for channel in channels:
            volts = robot.board.model.sensor_volts[channel]
            robot.body.sensors.broken[channel] = partial(_hold, volts)

    return fault


def _hold(volts: float, _: float) -> float:
    return volts


def gyro_stuck_at_middle(robot: Balancer) -> None:
    """One axis shows no rate any more, but noise."""
    chance = np.random.default_rng(1)
    robot.body.sensors.broken[0] = lambda _: (471.5 + chance.normal(0.0, 0.37)) * VOLTS_PER_COUNT


def encoders_cut(*wheels: int) -> Callable[[Balancer], None]:
    def fault(robot: Balancer) -> None:
        for wheel in wheels:
            robot.body.encoder_cut[wheel] = True

    return fault


def wheel_stuck(robot: Balancer) -> None:
    robot.plant.left.is_blocked = True


def line_cut(robot: Balancer) -> None:
    robot.body.line_cut = True


def cord_pulled(robot: Balancer) -> None:
    robot.body.cord_pulled = True


def lifted(robot: Balancer) -> None:
    robot.plant.loads.lift = 1.0


def carried(robot: Balancer) -> None:
    """It is carried for 2 s and put down."""
    began = robot.plant.seconds

    def carry() -> None:
        robot.plant.loads.lift = float(robot.plant.seconds - began < 2.0)

    robot.before_each_ms = carry


def battery_falls(robot: Balancer) -> None:
    """Its battery falls by 0.4 V/s and is at the limit after 0.1 s. The motor driver cuts off a second later."""
    plant, limit = robot.plant, robot.drive_config.battery_minimum
    plant.open_volts += limit - plant.volts + 0.04

    def fall() -> None:
        plant.open_volts -= 0.0004

    robot.before_each_ms = fall
