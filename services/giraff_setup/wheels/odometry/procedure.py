"""Leads one person through the runs of the plan: what to mark, what to drive, what to measure."""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Final, NamedTuple, Protocol

import numpy as np

from giraff_schemas.messages import Wheels
from giraff_setup.wheels.odometry.fit import UndeterminedError, fit
from giraff_setup.wheels.odometry.listening import WheelListener
from giraff_setup.wheels.odometry.plan import PLAN, Leg
from giraff_setup.wheels.odometry.plausible import driven_fault, end, length, measured_fault
from giraff_setup.wheels.odometry.runs import Geometry, MeasuredPose, Run
from giraff_setup.wheels.odometry.variance import SLIP
from giraff_setup.wheels.odometry.windows import WHOLE, residuals, uncertainty, windows_of
from giraff_tools.terminal.human import Human
from giraff_tools.typed import heading, number

_ODD: Final = 16.3
"""Chi squared of three values, which one run of a thousand exceeds that is measured as well as it should be."""


def review(runs: Sequence[Run], geometry: Geometry) -> list[str]:
    """Return where the runs of a person disagree, one line each: a wrong sign can still be measured anew."""
    try:
        scales = fit(runs, geometry).scales
    except UndeterminedError as error:
        return [str(error)]
    windows = windows_of(runs, geometry, WHOLE)
    told = []
    for window, off in zip(windows, residuals(windows, runs, geometry, scales), strict=True):
        run = runs[window.run]
        covariance = uncertainty((window,), run, geometry, scales).covariance(SLIP, 0.0)
        if off @ np.linalg.solve(covariance, off) > _ODD:
            x, y, yaw = off
            told.append(
                f"{run.name} does not agree with the others: by them it ended {x:+.3f} m ahead of what was measured, "
                f"{y:+.3f} m aside, turned {math.degrees(yaw):+.1f} degrees; is a sign wrong, or did it slip?"
            )
    return told


_SILENT: Final = 1.0  # s
_AGAIN, _SKIP = "again", "skip"

INTRODUCTION: Final = f"""\
This command only listens; drive as ever, with `giraff drive` in another terminal or the joystick.
Before each run mark on the floor where both wheels touch it. The middle between these two marks is the origin, and
ahead is the way the robot looks. After the run measure from there to the middle between the wheels: metres ahead,
metres aside and the heading, all positive to the left. docs/calibration.md shows how.
At any question: "{_AGAIN}" does the run again, "{_SKIP}" leaves it out, Ctrl-C ends it all and writes nothing."""

_FALLS_SILENT: Final = "no wheels are heard; check that giraff_base runs, and the network to it"


class WheelSource(Protocol):
    """Where the wheels of the robot are heard."""

    def poll(self) -> Iterable[Wheels]:
        """What came since the last call."""
        ...

    @property
    def silence(self) -> float:
        """s since the last one came; infinite where none has."""
        ...


class Measured(NamedTuple):
    """What the runs gave."""

    fitted: tuple[Run, ...]
    checks: tuple[Run, ...]


class _AgainError(Exception):
    """The run is to be done again."""


class _SkipError(Exception):
    """The run is to be left out."""


class Procedure:
    """One session."""

    def __init__(self, human: Human, source: WheelSource, geometry: Geometry) -> None:
        """`geometry`: what odometry goes by until now."""
        self._human = human
        self._source = source
        self._geometry = geometry
        self._wheels = WheelListener(geometry.ticks_per_metre)

    def measure(self, plan: Sequence[Leg] = PLAN) -> Measured:
        """Have all runs driven and measured. Raises NobodyError."""
        self._human.show(INTRODUCTION)
        done: dict[Leg, Run] = {}
        for leg in plan:
            self._do(leg, plan, done)
        while True:
            measured = Measured(
                tuple(done[leg] for leg in plan if leg in done and not leg.is_check),
                tuple(done[leg] for leg in plan if leg in done and leg.is_check),
            )
            for words in review(measured.fitted, self._geometry):
                self._human.show(words)
            if (leg_again := self._ask_for_one(plan)) is None:
                return measured
            self._do(leg_again, plan, done)

    def _do(self, leg: Leg, plan: Sequence[Leg], done: dict[Leg, Run]) -> None:
        self._human.show(f"\nRun {plan.index(leg) + 1} of {len(plan)}: {leg.name}{_FOR[leg.is_check]}")
        if (run := self._run(leg)) is not None:
            done[leg] = run
        elif leg in done:
            self._human.show("What was measured before stays.")

    def _ask_for_one(self, plan: Sequence[Leg]) -> Leg | None:
        """The run that is to be done again after all."""
        by_number = {str(index): leg for index, leg in enumerate(plan, 1)}
        while True:
            answer = self._human.ask(
                "\nENTER takes the runs as they are; the number of a run does it again:", self._listen
            )
            if not answer or answer in by_number:
                return by_number.get(answer)
            self._human.show(f"{answer}: no number of a run; they are 1 to {len(plan)}.")

    def _run(self, leg: Leg) -> Run | None:
        while True:
            try:
                return self._once(leg)
            except _SkipError:
                return None
            except _AgainError as error:
                self._human.show(f"{error}. {leg.name.capitalize()} is done again." if str(error) else "Once more.")

    def _once(self, leg: Leg) -> Run:
        self._ask_at_rest("Mark where both wheels touch the floor, then press ENTER:")
        self._wheels.begin()
        self._ask_at_rest(f"Drive {leg.task}. Press ENTER when it stands:", is_driven=True)
        run = self._wheels.driven(leg.name)
        if fault := self._wheels.fault or driven_fault(leg, run, self._geometry):
            raise _AgainError(fault)
        self._human.show("Mark where both wheels touch the floor now; then the robot may be moved. Measure:")
        while True:
            x = self._number("  metres ahead:", number)
            y = self._number("  metres aside, left positive:", number)
            turned = self._number("  heading with its unit, like -1.5deg, left positive:", heading)
            told = end(run, self._geometry)
            yaw = told.yaw + math.remainder(turned - told.yaw, math.tau)
            if not (fault := measured_fault(run, self._geometry, x, y, yaw)):
                break
            self._human.show(f'{fault}. Type all three once more, or "{_AGAIN}" to do the run again.')
        self._human.show(
            f"Kept: {x:.3f} m ahead, {y:.3f} m aside, {math.degrees(turned):.1f} degrees; by odometry until now "
            f"{told.x:.3f}, {told.y:.3f}, {math.degrees(math.remainder(told.yaw, math.tau)):.1f}."
        )
        return run._replace(measured=(MeasuredPose(run.left.size, x, y, yaw),))

    def _ask_at_rest(self, question: str, *, is_driven: bool = False) -> None:
        """Until ENTER is pressed and the robot stands."""
        while True:
            if self._answer(question, is_driven=is_driven):
                self._human.show(f"Press ENTER, or type {_AGAIN} or {_SKIP}.")
            elif self._source.silence > _SILENT:
                self._human.show(f"Not yet: {_FALLS_SILENT}.")
            elif not self._wheels.is_at_rest:
                self._human.show("Not yet: its wheels still turn, or did within the last half second.")
            else:
                return

    def _number(self, question: str, read: Callable[[str], float]) -> float:
        while True:
            try:
                return read(self._answer(question))
            except ValueError as error:
                self._human.show(f"{error}.")

    def _answer(self, question: str, *, is_driven: bool = False) -> str:
        answer = self._human.ask(question, self._progress if is_driven else self._listen)
        self._poll()
        if answer == _AGAIN:
            raise _AgainError
        if answer == _SKIP:
            raise _SkipError
        return answer

    def _listen(self) -> str:
        """What goes on while a person marks and measures is of no interest, but what silence there is."""
        self._poll()
        return _FALLS_SILENT if self._source.silence > _SILENT else ""

    def _progress(self) -> str:
        if silent := self._listen():
            return silent
        if self._wheels.fault:
            return f"{self._wheels.fault}: this run must be done again"
        return _as_text(self._wheels.driven(""), self._geometry)

    def _poll(self) -> None:
        for wheels in self._source.poll():
            self._wheels.on_wheels(wheels)


_FOR: Final = {False: "", True: " (it checks what was found, and is not fitted)"}


def _as_text(run: Run, geometry: Geometry) -> str:
    return f"{length(run, geometry):.1f} m, turned {round(math.degrees(end(run, geometry).yaw))} degrees"
