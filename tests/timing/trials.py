"""One scenario on a robot of processes, judged by the simulator's black box in the board's own time."""

import math
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext
from pathlib import Path

import msgspec

from tests.support.process_robot import ARENA, ProcessRobot, process_robot
from tests.timing.faults import Scenario
from tests.timing.stalled import by_the_wall

AFTER = 2.0
"""s after the end of a fault in which nothing may be driven; a restarted service needs one of them to be heard."""
_AGAIN = 2.0  # s after the end within which what only dips drives again
_REARMS = 10.0  # s, of the wall's time
_CREEP = 12
"""PWM counts: 0.10 m/s of 0.6 m/s, at level 70, rounded."""
_SLOW = 18
"""The same of 0.16 m/s, rounded down."""
_MIDDLE = 0.5  # m
_WAY_BACK = 8.0  # s
_FORGETS = 10.5
"""s after which the guard has forgotten what echoed about the former place; a deaf sensor does not contradict it."""
_LOOKS = 20


class Figures(msgspec.Struct, frozen=True, kw_only=True):
    """Of one trial. Seconds of simulated time from the fault's begin, unless named otherwise."""

    scenario: str
    driven_until: float
    """End of the last PWM before the hand was level again."""
    driven_share: float
    """Of the time from begin to end."""
    again_after: float | None
    """From the fault's end to the first PWM after it; None: none before the hand was level."""
    unasked: float
    """Longest time with PWM after the last accepted drive frame."""
    longest_gap: float
    """Between accepted drive frames in the second before."""
    peak_counts: int
    """From the row's bound to the end, of 255."""
    rearmed_after: float
    """Wall seconds that a level hand needed to arm it afterwards."""


class Stand:
    """A robot for many trials: one that has failed is not trusted with the next."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._running = ExitStack()
        self._robot: ProcessRobot | None = None
        self._started = 0
        self._parts: Mapping[str, str] = {}

    def robot(self, parts: Mapping[str, str]) -> ProcessRobot:
        """The running robot, if it has these parts, or a new one."""
        if self._parts != parts:
            self.discard()
        if self._robot is None:
            self._parts = parts
            self._started += 1
            directory = self._directory / str(self._started)
            directory.mkdir()
            self._robot = self._running.enter_context(process_robot(directory, ARENA, apart=True, parts=parts))
            self._robot.start("motion")
        return self._robot

    def discard(self) -> None:
        self._robot = None
        self._running.close()

    def tried(self, scenario: Scenario, phase: float = 0.0, take: Callable[[Figures], object] = print) -> None:
        """A trial of `scenario`, judged. `phase`: s that shift its begin; `take` is given the figures before."""
        try:
            robot, begin_ns = self.robot(scenario.parts), time.monotonic_ns()
            figures = run_trial(robot, scenario, phase)
            take(figures)
            judge_levels(scenario, figures)
            with nullcontext() if scenario.loads else by_the_wall(begin_ns):
                judge_times(scenario, figures)
            back_to_the_middle(robot, scenario)
        except BaseException:
            self.discard()
            raise


@contextmanager
def stand(directory: Path) -> Iterator[Stand]:
    made = Stand(directory)
    try:
        yield made
    finally:
        made.discard()


def run_trial(robot: ProcessRobot, scenario: Scenario, phase: float) -> Figures:
    """Drive, break, mend, arm."""
    simulator = robot.simulator
    with by_the_wall():
        if scenario.by == "motion":
            robot.move_forward(1.2 + phase)
        else:
            robot.drive(*scenario.tilt, seconds=1.2 + phase)
        assert robot.drives(), f"a free way is refused before the fault: {robot.why()}"
    begun_us = simulator.now()
    before = simulator.record(begun_us - 1_000_000, begun_us)
    with _mended_at_the_end(robot, scenario) as mend:
        for fault in scenario.faults:
            begun_us = fault.begin(robot) or begun_us
        robot.run(max(0.0, scenario.lasts - (simulator.now() - begun_us) * 1e-6))
        ended_us = simulator.now()
        mend()
    mended_us = simulator.now()
    robot.run(AFTER)
    now_us = simulator.now()
    if scenario.by == "motion":
        robot.end_motion()
    during, after = simulator.record(begun_us, ended_us), simulator.record(ended_us, now_us)
    whole = simulator.record(begun_us, now_us)
    last_us = (whole if scenario.rearms else during).last_driven_us or begun_us
    again_us = after.first_driven_us
    return Figures(
        scenario=scenario.name,
        driven_until=(last_us - begun_us) * 1e-6,
        driven_share=during.driven_ms * 1e3 / (ended_us - begun_us),
        again_after=None if again_us is None else (again_us - mended_us) * 1e-6,
        unasked=whole.longest_driven_unasked_us * 1e-6,
        longest_gap=before.longest_accept_gap_us * 1e-6,
        peak_counts=simulator.record(min(ended_us, begun_us + round(scenario.bound * 1e6)), ended_us).peak_counts,
        rearmed_after=robot.arm(_REARMS),
    )


@contextmanager
def _mended_at_the_end(robot: ProcessRobot, scenario: Scenario) -> Iterator[Callable[[], None]]:
    """What was broken is mended also when a check fails meanwhile, so that the processes can be ended."""
    with ExitStack() as broken:
        if any(fault.latches for fault in scenario.faults):
            broken.callback(_reset_estop, robot)
        for fault in scenario.faults:
            broken.callback(fault.end, robot)
        yield broken.close


def _reset_estop(robot: ProcessRobot) -> None:
    assert robot.giraff("estop", "reset") == 0, "the emergency stop is not reset; see giraff.log"


def back_to_the_middle(robot: ProcessRobot, scenario: Scenario) -> None:
    """Of an armed robot: that it drives again is a check, too."""
    x, y = scenario.tilt
    robot.hold(-x, -y)
    robot.wait(f"driving again after {scenario.name}", robot.drives, 5.0)
    until_us = robot.simulator.now() + round(_WAY_BACK * 1e6)
    nearest = math.inf
    while x != 0.0 and robot.simulator.now() < until_us:
        state = robot.simulator.state()
        distance = math.hypot(state.x, state.y)
        if distance > nearest + 0.02 or distance < 0.1:
            break
        nearest = min(nearest, distance)
        robot.run(0.05)
    robot.hold(0.0, 0.0)
    robot.wait("standing", lambda: not robot.drives(), 5.0)
    robot.run(0.4)
    state = robot.simulator.state()
    if math.hypot(state.x, state.y) > _MIDDLE:
        robot.simulator.place(0.0, 0.0, state.yaw)
        robot.run(_FORGETS if scenario.does == "slows" else 1.0)


def wall_clock_offset_us(robot: ProcessRobot) -> float:
    """Simulated us less those of the wall's clock, from the look that was answered soonest after its millisecond.

    Requests wait for the end of a simulated millisecond, answers for nothing.
    """
    looks = ((robot.simulator.now(), time.time_ns()) for _ in range(_LOOKS))
    return max(now_us - after_ns / 1e3 for now_us, after_ns in looks)


def judge_levels(scenario: Scenario, figures: Figures) -> None:
    """Whether the trial holds what its row promises, of what a stall of this machine cannot bring about."""
    assert figures.unasked <= 0.31, f"driven {figures.unasked:.3f} s after the last accepted frame: {figures}"
    if scenario.does == "creeps":
        assert figures.peak_counts <= _CREEP, figures
    if scenario.does == "slows":
        assert figures.peak_counts <= _SLOW, figures


def judge_times(scenario: Scenario, figures: Figures) -> None:
    """The rest of it."""
    match scenario.does:
        case "stops":
            assert figures.driven_until <= scenario.bound, figures
        case "dips":
            assert figures.again_after is not None, figures
            assert figures.again_after <= _AGAIN, figures
        case "drives on":
            assert figures.driven_share > 0.99, figures
