"""How soon the wheels do what the hand does: the way of a tilt through boards, wires and services, stage by stage.

Moments of the hand and of the motors are the simulator's own. Samples have the wall's clock, which all processes here
share, and which `wall_clock_offset_us` takes to simulated time.
"""

import random
import time
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Final, Literal

import msgspec
import psutil

from giraff_schemas.messages import DriveCommand, GuardedCommand, Tilt
from giraff_schemas.topics import CMD_VEL, OPERATOR_CMD_VEL, TILT, SampleT
from giraff_sim.world.world import HAND_US
from tests.loop.reaction import quantile
from tests.support.process_robot import FULL_TILT, SERVICES, ProcessRobot
from tests.timing.faults import BACKWARD, FORWARD, LEVEL
from tests.timing.sleepers import Stalls
from tests.timing.stalled import by_the_wall
from tests.timing.trials import wall_clock_offset_us

Does = Literal["stop", "start"]

ROBOT_SIDE: Final = ("base", "ranger", "odometry", "guard")
assert {*ROBOT_SIDE, "joystick"} == {*SERVICES}

STAGES: Final = {
    "tilt": ("hand to tilt frame at the joystick", 0.030),
    "command": ("tilt to `cmd_vel/joystick`", 0.002),
    "guarded": ("`cmd_vel/joystick` to `cmd_vel`", 0.002),
    "wheel": ("`cmd_vel` to PWM", 0.006),
    "whole": ("hand to wheel", 0.040),
}
"""By the trial's field: what it is, and the s that 95 of 100 may take at the most.

The sensor samples each 8 ms, its board asks for that each 20 ms and has it 2 ms later: the rest is for wires, processes
and network.
"""

_SETTLED: Final = (0.4, 0.6)  # s of driving or of standing before the next turn of the hand: any phase of any period
_SOON: Final = 5.0  # s
_STOPPED: Final = 0.1  # s without PWM, after which it is no dip


class Trial(msgspec.Struct, frozen=True, kw_only=True):
    """One turn of the hand; s. Each stage begins where the one before it ends."""

    does: Does
    tilt: float
    """From the hand to the stamp of the first `tilt` that shows it."""
    command: float
    """From there to the first `cmd_vel/joystick` that asks for it."""
    guarded: float
    """From there to the first `cmd_vel` that lets it through."""
    wheel: float
    """From there to the end of the first millisecond with PWM, or of the last one."""
    whole: float
    """From the hand to that millisecond."""
    longest_stall: float
    """Of this machine meanwhile, and so what it may have added."""


class Heard:
    """What was said since the hand was turned."""

    def __init__(self, robot: ProcessRobot) -> None:
        self.tilts: list[Tilt] = []
        self.commands: list[DriveCommand] = []
        self.guarded: list[GuardedCommand] = []
        robot.observer.listen(TILT, self.tilts.append)
        robot.observer.listen(OPERATOR_CMD_VEL.at("joystick"), self.commands.append)
        robot.observer.listen(CMD_VEL, self.guarded.append)

    def forget(self) -> None:
        for each in (self.tilts, self.commands, self.guarded):
            each.clear()

    def new_tilt(self, x: float) -> Tilt | None:
        """The first that shows the hand at `x` m/s² and not where it was."""
        return _first(self.tilts, lambda tilt: abs(tilt.x - x) < FULL_TILT / 2.0)

    def new_command(self, does: Does) -> DriveCommand | None:
        return _first(self.commands, lambda command: command.neutral == (does == "stop"))

    def new_guarded(self, does: Does) -> GuardedCommand | None:
        return _first(self.guarded, lambda command: command.neutral == (does == "stop"))


def measured(robot: ProcessRobot, pairs: int, choose: random.Random, stalls: Stalls) -> list[Trial]:
    """So many starts and as many stops, to and fro, each at a random moment."""
    heard = Heard(robot)
    trials = []
    for number in range(pairs):
        robot.arm()
        robot.run(choose.uniform(*_SETTLED))
        trials.append(_trial(robot, heard, "start", (FORWARD, BACKWARD)[number % 2], stalls))
        robot.run(choose.uniform(*_SETTLED))
        trials.append(_trial(robot, heard, "stop", LEVEL, stalls))
    return trials


def processor(robot: ProcessRobot, seconds: float) -> dict[str, float]:
    """Each service's share of a core, from now on."""
    processes = {service: psutil.Process(robot.pid(service)) for service in SERVICES}
    before, began = {service: _worked(process) for service, process in processes.items()}, time.monotonic()
    robot.run(seconds)
    took = time.monotonic() - began
    return {service: (_worked(process) - before[service]) / took for service, process in processes.items()}


def figures(trials: Sequence[Trial]) -> dict[str, dict[str, float]]:
    """By stage, ms: p50, p95 and the longest."""
    return {stage: _spread([getattr(trial, stage) for trial in trials]) for stage in STAGES}


def table(trials: Sequence[Trial]) -> str:
    """The same in Markdown: each stage of the stops, then the starts."""
    stops, starts = ([trial for trial in trials if trial.does == does] for does in ("stop", "start"))
    of_stops, of_starts = figures(stops), figures(starts)
    rows = [(what, of_stops[stage], f"{limit * 1e3:g}") for stage, (what, limit) in STAGES.items()]
    rows.append(("hand to wheel, of a start", of_starts["whole"], ""))
    lines = [f"| {what} | {of['p50']} | {of['p95']} | {of['max']} | {limit} |" for what, of, limit in rows]
    told = f"ms, of {len(stops)} stops and {len(starts)} starts"
    return "\n".join((f"| {told} | p50 | p95 | max | limit of p95 |", "|---|---|---|---|---|", *lines))


def processor_table(shares: Mapping[str, float]) -> str:
    """In Markdown, % of a core."""
    rows = [(service, shares[service]) for service in ROBOT_SIDE]
    rows += [("the robot's side", robot_side(shares)), ("joystick", shares["joystick"])]
    return "\n".join(("| service | % of a core |", "|---|---|", *(f"| {who} | {of:.1%} |" for who, of in rows)))


def robot_side(shares: Mapping[str, float]) -> float:
    return sum(shares[service] for service in ROBOT_SIDE)


def _trial(robot: ProcessRobot, heard: Heard, does: Does, hand: tuple[float, float], stalls: Stalls) -> Trial:
    begin_ns = time.monotonic_ns()
    heard.forget()
    hand_us = -(-robot.hold(*hand) // HAND_US) * HAND_US
    with by_the_wall(begin_ns):
        wheel_us = _wheel_us(robot, does, hand_us)
        tilt = _said(robot, "tilt", lambda: heard.new_tilt(hand[0]))
        command = _said(robot, "command", lambda: heard.new_command(does))
        guarded = _said(robot, "guarded command", lambda: heard.new_guarded(does))
    offset_us = wall_clock_offset_us(robot)
    moments_us = [hand_us, *(sample.stamp_ns / 1e3 + offset_us for sample in (tilt, command, guarded)), wheel_us]
    stages = [(end - begin) * 1e-6 for begin, end in pairwise(moments_us)]
    return Trial(
        does=does,
        tilt=stages[0],
        command=stages[1],
        guarded=stages[2],
        wheel=stages[3],
        whole=(wheel_us - hand_us) * 1e-6,
        longest_stall=stalls.longest(begin_ns, time.monotonic_ns()),
    )


def _wheel_us(robot: ProcessRobot, does: Does, since_us: int) -> int:
    """The end of the first millisecond with PWM, or of the last one, once it is known."""
    if does == "start":
        robot.wait("driving", robot.drives, _SOON)
        at_us = robot.simulator.record(since_us).first_driven_us
    else:
        robot.wait("standing", lambda: not robot.drives(), _SOON)
        robot.run(_STOPPED)
        at_us = robot.simulator.record(since_us).last_driven_us
    assert at_us is not None, f"it drove already, or not yet: {robot.why()}"
    return at_us


def _said(robot: ProcessRobot, what: str, find: Callable[[], SampleT | None]) -> SampleT:
    robot.wait(f"a new {what}", find, _SOON)
    found = find()
    assert found is not None
    return found


def _first(samples: Sequence[SampleT], holds: Callable[[SampleT], bool]) -> SampleT | None:
    return next((sample for sample in [*samples] if holds(sample)), None)


def _worked(process: psutil.Process) -> float:
    """s."""
    times = process.cpu_times()
    return float(times.user + times.system)


def _spread(values: Sequence[float]) -> dict[str, float]:
    found = {"p50": quantile(values, 0.5), "p95": quantile(values, 0.95), "max": max(values)}
    return {name: round(value * 1e3, 1) for name, value in found.items()}
