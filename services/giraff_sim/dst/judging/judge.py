"""The invariants, judged by hands and keys, the boards' pins, the world and the ledger: never by a service's words.

(a) after a fault that stops the robot, its motors are without power within the fault's bound;
(b) no drive frame stands on a command or a measurement that is too old, and no motor outlives its frames;
(c) none stands on a command of somebody else than the holder of the lease, or of before a hand was truly neutral;
    none goes against the way that the hand truly asks for;
(d) none is sent, and no motor has power, under an engaged emergency stop, or while the disk does not say released;
(e) none goes towards something that a sound sensor must have heard, and that is nearer than the stopping distance;
(f) a robot that may move, and is asked to where it is free, moves;
(g) no motor gets more than the most that the robot file allows, or what base has not asked for, and no wheel more
    speed than the ramp allows;
(h) what a sensor that is deaf now has heard twice within the last 10 s is touched at 0.16 m/s at most.
"""

from typing import Any, Final, NamedTuple

from giraff_core.senses import Ultrasonic
from giraff_schemas.messages import BaseState, GuardedCommand, Lease
from giraff_schemas.params import ParamAnswer, ParamSave
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.wire import COMMAND_TIMEOUT_MS, ECHO_MAX_AGE_MS, BoardKind, Frame
from giraff_sim.bodies.registry import judge_of
from giraff_sim.dst.judging.clearance import ClearanceCheck
from giraff_sim.dst.judging.explain import Explainer
from giraff_sim.dst.judging.latch import LatchWatch
from giraff_sim.dst.judging.ledger import BASE, Ledger, Passed
from giraff_sim.dst.judging.obstacles import Obstacles
from giraff_sim.dst.judging.sensors import looks_along
from giraff_sim.dst.judging.stops import ROBOT_US, Stops
from giraff_sim.dst.judging.true_input import TrueInput, WrongDirection
from giraff_sim.hosts.disk import Disk
from giraff_sim.hosts.event_queue import EventLog, EventQueue, kind_of
from giraff_sim.hosts.process import Process
from giraff_sim.settings import Settings
from giraff_sim.simulation import Simulation
from giraff_sim.world.body import Demand

_WIRE_US: Final = 10_000  # a frame's way to the board, and the simulation's steps
_OUTLIVES_US: Final = (ECHO_MAX_AGE_MS + COMMAND_TIMEOUT_MS) * 1000 + _WIRE_US
_NEAR: Final = 0.5  # m
_WAY_US: Final = 40_000
_TICKS_US: Final = 40_000  # a held neutral is measured by ticks: two of them are its error


class Violation(NamedTuple):
    at_us: int
    rule: str
    """Its letter."""
    what: str


class Judge(Ledger):
    """Hears all, and is asked after each step."""

    def __init__(self, agenda: EventQueue, simulation: Simulation, settings: Settings, event_log: EventLog) -> None:
        self._world = simulation.world
        self._simulation = simulation
        self._body = body = self._world.body
        super().__init__(agenda, TrueInput(settings.joystick, self._world.truth.accelerometer_offset), body.report)
        self.violations: list[Violation] = []
        self._of_body = judge_of(body, settings.robot, settings.base, _OUTLIVES_US)
        self.stops = Stops(body, self._of_body.goes)
        """The faults that must stop the robot now."""
        self._contacts = 0
        self._way = 0.0  # m when it was looked at last
        self.near = 0.0
        """m driven with something less than half a metre from the body."""
        self._settings = settings
        self._sensors = settings.robot.of(Ultrasonic)
        self._event_log = event_log
        self._explainer = Explainer(self, settings.robot, settings.base)
        self._obstacles = Obstacles(self._world, settings)
        self._wrong_direction = WrongDirection(body)
        self._driver = ""  # instance of the operator whom the newest frame that asks for motion explains
        self.clearance_check = ClearanceCheck(self._world, settings)
        self._asked_us = 0  # when base last asked the board as it is now for motion
        # What disarmed last, and whose held neutral has been found since.
        self._disarmed_us, self._disarmed_by = 0, "base has just started"
        self._armed_for = ""
        self._missed_us, self._missed = 0, ""  # when a sensor that the operator's wish relies on was missed last
        self._excused_until_us = -1
        self._guard = ""
        self._newest: Passed | None = None
        self._operator_born_us = 0
        self._engaged_us: int | None = None  # since when base must stand still
        self._engaged_at: Process | None = None  # the base that was asked, while it runs
        self._latch = LatchWatch(body)
        self._resets: dict[EStopReset, int] = {}
        self._state: BaseState | None = None

    @property
    def holder(self) -> str:
        """Instance of the operator that the guard base obeys has given the lease to; empty: nobody."""
        grants = self.leases.get(self._guard)
        return grants[-1].holder if grants else ""

    def has_found(self, rules: str) -> bool:
        """Return True if each of these rules is violated, named by its letter. Without a rule, return False."""
        return bool(rules) and {found.rule for found in self.violations}.issuperset(rules)

    def answered(self, process: Process, request: Any, answer: Any) -> None:
        if isinstance(answer, ParamAnswer):
            what = "saved" if isinstance(request, ParamSave) else "set"
            refused = "not saved" if isinstance(request, ParamSave) else "refused"
            self._event_log.count(f"parameter: {what if answer.done else refused}")
        if isinstance(answer, EStopAnswer):
            self._event_log.count(
                f"answer: {kind_of(answer.reason.what) or ('stopped' if answer.engaged else 'released')}"
            )
            if process.name == BASE and (wrong := self._latch.answered(process, answer, self._agenda.now_us)):
                self._violated("d", wrong)

    def after_step(self, disk: Disk) -> None:
        """Look at the motors and the robot's disk."""
        now_us = self._agenda.now_us
        self._look_at_resets()
        self._measure_way(now_us)
        self._look_at_latch(disk, now_us)
        self._obstacles.note(now_us)
        self.clearance_check.note(now_us)
        self._of_body.note(now_us)
        self._look_at_contacts(now_us)
        against = self._wrong_direction.judge(self._driver, self.true_input.way(self._driver, now_us), now_us)
        if self._body.activity == 0:
            if refusal := self.clearance_check.refused(self._newest, self._state, now_us):
                self._violated("f", refusal)
            return
        self.clearance_check.moved(now_us)
        if now_us <= self._excused_until_us:
            return
        if wrong := self._of_body.wrong(now_us):
            self._violated("g", wrong)
        if against:
            self._violated("c", against)
        if overdue := self.stops.overdue(now_us):
            self._violated("a", overdue)
        acts, settles_us = self._body.acts, self._body.settles_us
        if now_us - self._asked_us > _OUTLIVES_US + settles_us:
            unasked = f"{acts} {(now_us - self._asked_us) / 1e6:.3f} s after the last frame that asked for any"
            self._violated("b", unasked)
        if wrong := self._latch.power(now_us):
            self._violated("d", wrong)
        if self._engaged_us is not None and now_us - self._engaged_us > ROBOT_US + settles_us:
            self._violated("d", f"{acts} {(now_us - self._engaged_us) / 1e6:.3f} s after the emergency stop")

    def excuse(self, for_us: int) -> None:
        """Judge no power for so long."""
        self._excused_until_us = self._agenda.now_us + for_us

    def pressed_reset(self, reset: EStopReset) -> None:
        """A human has asked for this just now."""
        self._resets[reset] = self._agenda.now_us

    def on_reset(self, kind: BoardKind) -> None:
        super().on_reset(kind)
        if kind is BoardKind.BASE:
            self._disarmed("the base board was reset")
            # Where the line to its motor controller is cut, that stops by itself.
            drives_on_us = round(self._body.board.stops_after_s * 1e6)
            self._asked_us = self._agenda.now_us - _OUTLIVES_US + drives_on_us

    def opened(self, process: Process) -> None:
        if process.name == BASE:
            self._disarmed(f"{process.instance} has opened the base board's port")

    def on_grant(self, lease: Lease) -> None:
        what = f"{lease.instance} gives the lease {lease.counter} to {lease.holder or 'nobody'}"
        self._event_log.count("granted" if lease.holder else "lease ended")
        self._event_log.log(what)
        if lease.instance == self._guard or not self._guard:
            self._disarmed(what)

    def on_guarded(self, base: Process, command: GuardedCommand) -> None:
        if base.name != BASE:
            return
        now_us = self._agenda.now_us
        passed = self.passed(command)
        if command.guard_tick is None or now_us - passed.at_us > round(self._settings.base.guard_budget * 1e6):
            return  # a guard that knows no moment, or an old copy: nobody's voice
        self._newest = passed
        if command.instance != self._guard:
            self._disarmed(f"{command.instance} guards instead of {self._guard or 'nobody'}")
            self._guard = command.instance
        if command.source == "fault":
            self._disarmed(f"a fault of the operator's side: {command.reason}")
        if passed.given is not None:
            self._operator_born_us = max(self._operator_born_us, passed.given.born_us)
        stale_us = round(self._settings.base.disarm_time * 1e6) + _TICKS_US
        if now_us - self._operator_born_us > stale_us:
            self._disarmed("the operator was not heard for too long")
        if name := self._missed_sensor(passed, now_us - stale_us):
            self._missed_us, self._missed = now_us, name

    def on_engage(self, process: Process, asked: EStopEngage) -> None:
        self._event_log.log(f"base is asked for an emergency stop by {asked.by}")
        if process.name == BASE:
            self._engaged_at = process
            self._latch.asked(self._agenda.now_us)
        if self._engaged_us is None:
            self._engaged_us = self._agenda.now_us

    def on_reset_asked(self, asked: EStopReset) -> None:
        now_us, pressed_us = self._agenda.now_us, self._resets[asked]
        old = (now_us - pressed_us) / 1e6
        self._event_log.log(f"base is asked to release {asked.id}, {old:.2f} s after {asked.by} did so")
        if pressed_us < self._latch.asked_us or old > self._settings.base.reset_budget:
            return
        self._latch.permit(now_us)  # also of a stop that the board has called for
        if self._engaged_us is not None:
            self._engaged_us = None
            self._disarmed("the emergency stop was reset")

    def on_base_state(self, base: Process, state: BaseState) -> None:
        if base.name != BASE:
            return
        before, self._state = self._state, state
        if before is None:
            return
        if state.armed != before.armed:
            self._event_log.log("armed" if state.armed else f"disarmed: {state.reason}")
            self._event_log.count("armed" if state.armed else "disarmed")
        if before.driving and not state.driving:
            self._event_log.log(f"stops: {state.reason or 'the operator wishes so'}")
            self._event_log.count(f"stop: {kind_of(state.reason.what) or 'the operator wishes so'}")

    def wrote(self, process: Process, frame: Frame) -> None:
        now_us = self._agenda.now_us
        asked = self._of_body.asked(frame, now_us)
        if asked is None or asked.is_nothing:
            return
        if self._engaged_us is not None:
            self._violated("d", f"{process.instance} asks for {asked.text} while stopped")
        if not self.is_of_this_boot(BoardKind.BASE, asked.boot_id):
            return  # base does not know of the board's reset yet, and no motor may have power by this
        self._asked_us = now_us
        wrong, passed = self._explainer.why_not(asked, self.heard_by_base(process), now_us)
        if passed is None:
            self._violated(wrong[0], f"{asked.text} at the board: {wrong[3:]}")
        else:
            self._driver = passed.command.operator
            self._expect_armed(passed.command.operator, asked)
        if asked.goes and (collision := self._obstacles.ahead(asked.linear, self.readings, now_us)):
            self._violated("e", collision)

    def _look_at_resets(self) -> None:
        """Find resets that nobody asked for: a process resets itself where its motor controller is not as it was."""
        if self._body.board.is_process:
            for _ in range(len(self._boots[BoardKind.BASE]), self._simulation.boards[BoardKind.BASE].model.resets + 1):
                self.on_reset(BoardKind.BASE)

    def _measure_way(self, now_us: int) -> None:
        if now_us % _WAY_US:
            return
        path = self._world.plant.path_length
        if path > self._way and self._world.plant.clearance < _NEAR:
            self.near += path - self._way
        self._way = path

    def _look_at_contacts(self, now_us: int) -> None:
        if self._world.plant.contacts == self._contacts:
            return
        self._contacts = self._world.plant.contacts
        self._event_log.log(f"the body touches something: {self._obstacles.touched(self.readings)}")
        if too_fast := self._obstacles.touched_too_fast(now_us):
            self._violated("h", too_fast)

    def _look_at_latch(self, disk: Disk, now_us: int) -> None:
        if wrong := self._latch.judge(disk, now_us):
            self._violated("d", wrong)
        if self._engaged_us is None or self._engaged_at is None:
            return
        if wrong := self._latch.unsaved(self._engaged_at, self._world.step_us):
            self._violated("d", wrong)
        if not self._engaged_at.ended:
            return
        self._engaged_at = None  # what the next one does to the disk is no excuse
        if not self._latch.says_engaged:
            # Nobody was told that it is kept: who asked goes on asking, or knows.
            self._event_log.log("base ended before the emergency stop was on disk")
            self._event_log.count("an emergency stop was lost with its base")
            self._engaged_us = None

    def _expect_armed(self, operator: str, asked: Demand) -> None:
        """A held neutral since the last that disarmed; of travel also since a sensor on its way was missed."""
        if operator != self._armed_for:
            if not self._was_neutral(operator, self._disarmed_us, self._disarmed_by):
                return
            self._armed_for = operator
        missed = f"{self._missed} was not heard for too long"
        if self._missed_us > self._disarmed_us and asked.goes and self._was_neutral(operator, self._missed_us, missed):
            self._missed_us = 0

    def _was_neutral(self, operator: str, since_us: int, since: str) -> bool:
        held_us = self.neutral[operator].longest_since(since_us)
        if held_us >= round(self._settings.base.arm_time * 1e6) - _TICKS_US:
            return True
        ago = (self._agenda.now_us - since_us) / 1e6
        held = f"whose hand was neutral for {held_us / 1e6:.3f} s only"
        self._violated("c", f"driven for {operator}, {held}, since {ago:.3f} s ago {since}")
        return False

    def _disarmed(self, by: str) -> None:
        self._disarmed_us, self._disarmed_by = self._agenda.now_us, by
        self._armed_for = ""

    def _missed_sensor(self, passed: Passed, before_us: int) -> str:
        """A sensor on the way that the operator asks for, unheard since then."""
        if passed.given is None or passed.given.command.linear_x == 0.0:
            return ""
        for name, pose in self._sensors.items():
            looks_there = looks_along(pose, passed.given.command.linear_x)
            if looks_there and name in passed.ranges and passed.ranges[name][1] < before_us:
                return name
        return ""

    def _violated(self, rule: str, what: str) -> None:
        """Put a violation down; one that only goes on is told once."""
        if all((each.rule, kind_of(each.what)) != (rule, kind_of(what)) for each in self.violations):
            self.violations.append(Violation(self._agenda.now_us, rule, what))
            self._event_log.log(f"VIOLATION ({rule}): {what}")
