"""`giraff tune speed` with a scripted person, a motion that is there by itself, and wheels that a model turns.

Real firmware with bad gains: tests/sim/test_tuned_speed.py.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, cast

import pytest

import giraff_cli.tune.speed
import giraff_cli.tune.speed_drive as it
import giraff_node.motion_client
import giraff_node.network.query_client
from giraff_base.drives.wheels.config import SpeedControl
from giraff_cli.network.connection import RobotConnection
from giraff_cli.terminal.human import NobodyError
from giraff_cli.terminal.signals import StopSignal
from giraff_cli.tune.speed_fit import CannotTellError, Motor, fastest, identify, legs_of, propose
from giraff_cli.tune.speed_report import tell_drive, tell_fastest
from giraff_core.network import NetworkConfig
from giraff_schemas.messages import Battery, Lease, RobotTime, Wheels
from giraff_schemas.motion import Move
from giraff_schemas.topics import BATTERY, CMD_VEL, LEASE, WHEELS
from tests.rules.repository import ROOT
from tests.support.motion_double import MotionDouble
from tests.support.one_process import Clock, Session
from tests.unit.cli.samples import command
from tests.unit.cli.typed import typed

NAME: Final = "giraff"
TICKS: Final = 2002.0594
STEP: Final = 0.01  # s
MOTORS: Final = (Motor(per_count=0.0085, time=0.2, dead=2.0), Motor(per_count=0.0075, time=0.2, dead=1.0))
GOOD: Final = SpeedControl(motor_time=0.2, speed_p=251.0, speed_i=1255.0, turn_p=71.6, turn_i=429.0)
"""What the rule makes of MOTORS."""


class Turning:
    """One wheel whose motor follows the model, under a slow loop. It is sampled between two changes of its PWM."""

    def __init__(self, motor: Motor) -> None:
        self.motor, self.speed, self.travel, self.pwm = motor, 0.0, 0.0, 0

    def step(self, asked: float, push: int = 0) -> None:
        self._move()
        self.pwm = push or round(asked / 0.0086 + 60.0 * (asked - self.speed)) if asked else 0
        self._move()

    def _move(self) -> None:
        k, time, dead = self.motor
        aim = k * (self.pwm - math.copysign(dead, self.pwm)) if self.pwm else 0.0
        self.speed += (aim - self.speed) / time * STEP / 2.0
        self.travel += self.speed * STEP / 2.0


def drive(*, pace: float = 0.25, ticks: float = TICKS, push: int = 0) -> Iterator[Wheels]:
    """Yield the wheels of a way ahead and back, a sample each STEP. `push`: PWM counts all along, without the loop."""
    sides, asked, at = [Turning(motor) for motor in MOTORS], 0.0, 0
    for way in (1.0, -1.0):
        began = sides[0].travel
        for step in range(300):
            left = max(0.0, 0.5 - way * (sides[0].travel - began))
            asked = min(asked + 0.006, pace, math.sqrt(0.8 * left)) if left > 0.004 and step < 250 else 0.0
            for side in sides:
                side.step(way * asked, round(way * push))
            at += 1
            yield sample(at, *sides, ticks=ticks)


def sample(at: int, left: Turning, right: Turning, *, ticks: float = TICKS) -> Wheels:
    return Wheels(
        instance="base",
        left_ticks=math.floor(left.travel * ticks),
        right_ticks=math.floor(right.travel * ticks),
        left_velocity=left.speed,
        right_velocity=right.speed,
        left_pwm_counts=left.pwm,
        right_pwm_counts=right.pwm,
        board_us=(at * 10_000 - 2_000_000) % (1 << 32),
        boot_id=1,
        tick=RobotTime(1, (1000 + at) * 10_000_000),
    )


def measure(heard: list[Wheels]) -> list[Motor]:
    return [identify(leg) for leg in legs_of(heard, (TICKS, TICKS))]


def test_the_model_is_found_and_the_rule_of_the_defaults_makes_the_gains() -> None:
    left, right = MOTORS
    "\n".join(tell_drive(legs_of(list(drive()), (TICKS, TICKS)), dots=False)).encode("ascii")
    for found, motor in zip(measure(list(drive())), (left, left, right, right), strict=True):
        assert found.per_count == pytest.approx(motor.per_count, rel=0.04)
        assert found.time == pytest.approx(motor.time, rel=0.05)
    usual = Motor(per_count=0.6 / 70.0, time=0.15, dead=0.0)
    proposal = propose([usual] * 4, SpeedControl())
    assert not proposal.changes(SpeedControl()), "the defaults follow from the motor that they are for"
    assert fastest([usual], 70, 1.0) == pytest.approx(0.6)
    assert "does 0.48 m/s at max_level 70" in tell_fastest(fastest([usual], 70, 1.25), 0.6, 70, battery_known=True)
    assert not tell_fastest(0.57, 0.6, 70, battery_known=True)
    assert propose([Motor(0.00001, 0.9, 0.0)] * 4, SpeedControl()).control.speed_p == 3900.0


CANNOT: Final[dict[str, tuple[Callable[[], list[Wheels]], str]]] = {
    "hardly excited": (lambda: list(drive(pace=0.03)), "check its encoder|does not tell its motor"),
    "a gap": (lambda: [each for at, each in enumerate(drive()) if not 40 < at < 60], "not heard all the way"),
    "another scale": (lambda: list(drive(ticks=1500.0)), "ticks_per_metre"),
    "one push all along": (lambda: list(drive(push=30)), "does not tell its motor"),
    "no way back": (lambda: list(drive())[:300], "got nothing on the way back"),
}


@pytest.mark.parametrize("case", CANNOT)
def test_a_drive_that_does_not_tell_proposes_nothing(case: str) -> None:
    heard, words = CANNOT[case]
    with pytest.raises(CannotTellError, match=words):
        measure(heard())


def test_measurements_that_disagree_propose_nothing() -> None:
    with pytest.raises(CannotTellError, match="by one measurement and"):
        propose([MOTORS[0]] * 3 + [Motor(0.0085, 0.9, 0.0)], SpeedControl())


class Desk:
    """A person beside a robot, who types these answers."""

    def __init__(self, patch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], path: Path) -> None:
        self.path, self.before = path, path.read_bytes()
        self.clock = Clock()
        self.session = Session(self.clock)
        self.motion = MotionDouble(self.session, self.clock, NAME)
        self.motion.takes = 6.2
        self.answers = ["yes", "yes"]
        self.told: list[str] = []
        self.guard_says, self.next_lease, self.are_heard = "", 0, True
        self.each: Callable[[StopSignal], object] = lambda _: None
        self.thinks: Callable[[], object] = lambda: None
        self._patch, self._capsys = patch, capsys
        self._wheels = drive()
        for module in (it, giraff_node.motion_client, giraff_node.network.query_client):
            patch.setattr(module, "time", self.clock)
        patch.setattr(giraff_cli.tune.speed, "run_with_robot", self._visit)
        patch.setattr(giraff_cli.tune.speed, "Terminal", lambda *_: self)
        self.clock.every(STEP, self._roll)
        self.clock.every(0.1, self._lease)

        def wait(stopping: StopSignal, seconds: float, patience: int = 1) -> bool:
            self.clock.sleep(seconds)
            self.each(stopping)
            return stopping.asked >= patience

        patch.setattr(StopSignal, "wait", wait)

    def tell(self, text: str) -> None:
        self.told.append(text)

    def ask(self, question: str, meanwhile: object) -> str:
        del question, meanwhile
        self.thinks()
        if not self.answers:
            raise NobodyError
        return self.answers.pop(0)

    def is_untouched(self, besides: int = 0) -> bool:
        """Return whether the file is as it was, with so many others in its folder."""
        return self.path.read_bytes() == self.before and len(list(self.path.parent.iterdir())) == 1 + besides

    def edit(self, old: str, new: str) -> None:
        self.path.write_text(self.path.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
        self.before = self.path.read_bytes()

    def type(self) -> tuple[int, str, str]:
        return typed(self._patch, self._capsys, "tune", "speed", "--file", str(self.path))

    def _visit(
        self, robot: object, connect: object, patience: float, act: Callable[[RobotConnection], int], **how: bool
    ) -> int:
        del robot, connect, patience
        assert how == {"moves": True, "stands_in": False}
        return act(RobotConnection(NAME, cast(Any, self.session), network=NetworkConfig()))

    def _roll(self) -> None:
        if not self.are_heard:
            return
        has_begun = bool(self.motion.asked) and not self.motion.refusal
        resting = Turning(MOTORS[0])
        if (wheels := next(self._wheels, None) if has_begun else sample(0, resting, resting)) is not None:
            self.motion.say(WHEELS, wheels)
        self.motion.say(BATTERY, Battery(voltage=24.0))
        self.motion.say(CMD_VEL, command(None, reason=self.guard_says))

    def _lease(self) -> None:
        counter = self.next_lease if self.clock.monotonic() > 6.5 else 5
        self.motion.say(LEASE, Lease(holder="m" if counter else "", operator="motion", counter=counter, reason=""))


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Desk:
    text = (ROOT / "deploy" / "robot.toml").read_text(encoding="utf-8")
    (path := tmp_path / "robot.toml").write_text(text.replace("# wheel_control", "wheel_control"), encoding="utf-8")
    return Desk(monkeypatch, capsys, path)


def test_what_is_found_is_written_once_and_is_fine_then(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("GIRAFF_BASE_DRIVE__SPEED_CONTROL__TURN_I", "400.0")
    code, out, complaint = desk.type()
    monkeypatch.delenv("GIRAFF_BASE_DRIVE__SPEED_CONTROL__TURN_I")
    assert (code, complaint) == (0, "")
    [request] = desk.motion.asked
    assert (request.steps, request.speed) == ((Move(distance=0.5), Move(distance=-0.5)), 0.25)
    table = tomllib.loads(desk.path.read_text(encoding="utf-8"))["base"]["drive"]["speed_control"]
    assert table["max_pwm"] == 110, "what else is in it stays"
    found = SpeedControl(**table)
    for name in ("motor_time", "speed_p", "speed_i", "turn_p", "turn_i"):
        assert getattr(found, name) == pytest.approx(getattr(GOOD, name), rel=0.06)
    [kept] = [each for each in desk.path.parent.iterdir() if each != desk.path]
    assert kept.read_bytes() == desk.before
    assert "before base is restarted" in desk.told[-2]
    assert "giraff tune speed once more" in desk.told[-2]
    assert "still override it: GIRAFF_BASE_DRIVE__SPEED_CONTROL__TURN_I" in desk.told[-1]
    assert "right  back" in out
    later = Desk(monkeypatch, capsys, desk.path)
    code, _, complaint = later.type()
    assert (code, complaint) == (0, "")
    assert "Fine already" in later.told[-1]
    assert later.is_untouched(besides=1)


def test_what_was_driven_before_the_yes_is_not_judged(desk: Desk) -> None:
    def drive_by_hand() -> None:
        if desk.motion.asked:
            return
        wheels = (
            Turning(Motor(per_count=0.004, time=0.4, dead=2.0)),
            Turning(Motor(per_count=0.004, time=0.4, dead=2.0)),
        )
        for at in range(-1000, 0):
            for wheel in wheels:
                wheel.step(0.25 if at < -500 else -0.25)
            desk.motion.say(WHEELS, sample(at, *wheels))

    desk.thinks = drive_by_hand
    assert desk.type()[::2] == (0, "")
    found = tomllib.loads(desk.path.read_text(encoding="utf-8"))["base"]["drive"]["speed_control"]
    assert found["speed_p"] == pytest.approx(GOOD.speed_p, rel=0.06)


def refuse(desk: Desk) -> None:
    desk.motion.refusal = "held by joystick (1a2b) until it rests for 30 s"


def block(desk: Desk) -> None:
    desk.motion.outcome = "blocked"


def slow(desk: Desk) -> None:
    desk.guard_says = "forward slowed: front_left sees something"


def keep(desk: Desk) -> None:
    desk.next_lease = 5


def silence(desk: Desk) -> None:
    desk.are_heard = False


def deafen(desk: Desk) -> None:
    def each(_: StopSignal) -> None:
        desk.are_heard = desk.clock.monotonic() < 1.0

    desk.each = each


def interrupt(desk: Desk) -> None:
    def each(stopping: StopSignal) -> None:
        if desk.clock.monotonic() > 1.0 and not stopping.asked:
            stopping.ask()

    desk.each = each


def tear(desk: Desk) -> None:
    def each(_: StopSignal) -> None:
        desk.before = b"[base.drive"
        desk.path.write_bytes(desk.before)

    desk.each = each


FIELDS: Final = ("max_level = 70", "stall_level = 25", "battery_nominal = 24.0", 'wheel_control = "speed"')


def spell(robot: str = "", base: str = "") -> Callable[[Desk], None]:
    """Return what writes a drive of these lines in [robot] or in [base], in place of the table of its own."""

    def edit(desk: Desk) -> None:
        text = desk.path.read_text(encoding="utf-8")
        desk.edit(text[text.index("[base.drive]") : text.index("[ranger]")], f"{base}\n\n")
        desk.edit("[robot]", f"[robot]\n{robot}")

    return edit


def level(desk: Desk) -> None:
    desk.edit('wheel_control = "speed"', 'wheel_control = "level"')


_TAKES_NONE: Final = "takes no [base.drive.speed_control]"
UNASKED: Final = ("a no to the way", "nobody at the terminal", "silent wheels", "levels")

REFUSALS: Final[dict[str, tuple[Callable[[Desk], object], list[str], int, str]]] = {
    "a no to the way": (lambda _: None, ["no"], 1, "nothing has moved"),
    "nobody at the terminal": (lambda _: None, [], 2, "nobody answers"),
    "a no to writing": (lambda _: None, ["yes", "no"], 1, "not wanted"),
    "nobody any more": (lambda _: None, ["yes"], 2, "nobody answers"),
    "somebody else drives": (refuse, ["yes"], 1, "the robot has not moved: held by joystick"),
    "a blocked way": (block, ["yes"], 1, "the drive stopped before its end: front_left blocks"),
    "a slowed way": (slow, ["yes"], 1, "guard has slowed the robot: forward slowed: front_left sees something"),
    "a lease that is kept": (keep, ["yes"], 1, "nobody tells that giraff_motion has given the robot back"),
    "silent wheels": (silence, [], 2, "no wheels of giraff are heard"),
    "wheels that fall silent": (deafen, ["yes"], 1, "the wheels fell silent"),
    "Ctrl-C": (interrupt, ["yes"], 130, "interrupted"),
    "a file that is torn meanwhile": (tear, ["yes", "yes"], 1, "by hand:\n    motor_time = "),
    "a drive in [robot]": (spell(robot="\n".join(FIELDS)), [], 2, _TAKES_NONE),
    "a drive on one line": (spell(base=f'drive = {{ type = "wheels", {", ".join(FIELDS)} }}'), [], 2, _TAKES_NONE),
    "a drive in dotted keys": (
        spell(base="\n".join(f"drive.{x}" for x in ('type = "wheels"', *FIELDS))),
        [],
        2,
        _TAKES_NONE,
    ),
    "levels": (level, [], 2, 'write wheel_control = "speed" into [base.drive]'),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_otherwise_it_says_why_and_writes_nothing(desk: Desk, case: str) -> None:
    prepare, desk.answers, code, words = REFUSALS[case]
    prepare(desk)
    told = desk.type()
    assert (told[0], words in told[2]) == (code, True), told
    assert not desk.answers
    assert desk.is_untouched()
    assert "?" not in told[2]
    if case == "Ctrl-C":
        assert desk.motion.cancelled
        assert desk.clock.monotonic() < 2.0
    has_asked = case not in UNASKED and words != _TAKES_NONE
    assert bool(desk.motion.asked) == has_asked


def test_a_robot_that_balances_has_another_verb(desk: Desk) -> None:
    balancer = ROOT / "deploy" / "robots" / "balancer.toml"
    desk.path.write_bytes(balancer.read_bytes())
    code, _, complaint = desk.type()
    assert (code, "giraff tune balance" in complaint, desk.motion.asked) == (2, True, [])
