"""`giraff tune speed` with a scripted person, a motion that is there by itself, and wheels that a model turns.

Real firmware with bad gains: tests/sim/test_tuned_speed.py.
"""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, cast

import msgspec
import pytest

import giraff_node.motion_client
import giraff_node.network.query_client
import giraff_setup.wheels.speed.tune
from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import SpeedControl
from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import load
from giraff_schemas.codec import encode
from giraff_schemas.messages import Battery, Lease
from giraff_schemas.motion import Move
from giraff_schemas.params import Param, ParamAnswer
from giraff_schemas.topics import BATTERY, CMD_VEL, LEASE, PARAM_DESCRIBE, WHEELS, key_of
from giraff_setup.wheels.speed import drive as speed_drive
from giraff_setup.wheels.speed.fit import Motor
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.human import NobodyError
from giraff_tools.terminal.signals import StopSignal
from tests.rules.repository import ROOT
from tests.support.driven_wheels import MOTORS, STEP, Turning, drive, sample
from tests.support.motion_double import MotionDouble
from tests.support.one_process import Clock, Session
from tests.unit.cli.samples import command
from tests.unit.cli.typed import typed

NAME: Final = "giraff"
GOOD: Final = SpeedControl(motor_time=0.2, speed_p=251.0, speed_i=1255.0, turn_p=71.6, turn_i=429.0)
"""What the rule makes of MOTORS."""


class Desk:
    """A person beside a robot, who types these answers."""

    def __init__(self, patch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], path: Path) -> None:
        self.path, self.before = path, path.read_bytes()
        self.clock = Clock()
        self.session = Session(self.clock)
        self.motion = MotionDouble(self.session, self.clock, NAME)
        self.motion.takes = 6.2
        self.answers = ["yes", "yes", "yes"]
        self.told: list[str] = []
        self.guard_says, self.next_lease, self.are_heard = "", 0, True
        self.each: Callable[[StopSignal], object] = lambda _: None
        self.thinks: Callable[[], object] = lambda: None
        self._patch, self._capsys = patch, capsys
        self.gains = [60.0, 600.0]
        """Of the loop of each drive."""
        self.restarts: Callable[[], object] = self.restart
        """What becomes of base once the file is written."""
        self.restart()
        self.session.answer(key_of(NAME, PARAM_DESCRIBE.at("base")), self._describe)
        self._asked, self._began, self._wheels = 0, 0.0, drive()
        for module in (speed_drive, giraff_node.motion_client, giraff_node.network.query_client):
            patch.setattr(module, "time", self.clock)
        patch.setattr(giraff_setup.wheels.speed.tune, "run_with_robot", self._visit)
        patch.setattr(giraff_setup.wheels.speed.tune, "Terminal", lambda *_: self)
        self.clock.every(STEP, self._roll)
        self.clock.every(0.1, self._lease)

        def wait(stopping: StopSignal, seconds: float, patience: int = 1) -> bool:
            self.clock.sleep(seconds)
            self.each(stopping)
            return stopping.asked >= patience

        patch.setattr(StopSignal, "wait", wait)

    def show(self, text: str) -> None:
        self.told.append(text)

    def ask(self, question: str, meanwhile: object) -> str:
        del meanwhile
        self.thinks()
        if "Is base restarted" in question:
            self.restarts()
        if not self.answers:
            raise NobodyError
        return self.answers.pop(0)

    def restart(self) -> None:
        """Have base go by the file."""
        drive = load("base", BaseConfig, {"GIRAFF_CONFIG": str(self.path)}).drive
        self.in_force = msgspec.to_builtins(getattr(drive, "speed_control", {}))

    def is_untouched(self, besides: int = 0) -> bool:
        """Return whether the file is as it was, with so many others in its folder."""
        return self.path.read_bytes() == self.before and len(list(self.path.parent.iterdir())) == 1 + besides

    def edit(self, old: str, new: str) -> None:
        self.path.write_text(self.path.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
        self.before = self.path.read_bytes()

    def type(self) -> tuple[int, str, str]:
        return typed(self._patch, self._capsys, "tune", "speed", "--file", str(self.path))

    def _visit(self, robot: object, connect: object, act: Callable[[RobotConnection], int], **how: bool) -> int:
        del robot, connect
        assert how == {"moves": True, "stands_in": False}
        return act(RobotConnection(NAME, cast(Any, self.session), network=NetworkConfig()))

    def _roll(self) -> None:
        if not self.are_heard:
            return
        asked = {each.id for each in self.motion.asked if not self.motion.refusal}
        if len(asked) > self._asked:
            self._began = self.clock.monotonic()
            self._asked, self._wheels = len(asked), drive(gain=self.gains[self._asked])
        resting = Turning(MOTORS[0])
        if (wheels := next(self._wheels, None) if asked else sample(0, resting, resting)) is not None:
            self.motion.say(WHEELS, wheels)
        self.motion.say(BATTERY, Battery(voltage=24.0))
        self.motion.say(CMD_VEL, command(None, reason=self.guard_says))

    def _describe(self, payload: bytes) -> tuple[float, bytes]:
        del payload
        values: dict[str, Any] = {"drive.type": "wheels", "drive.speed_control": self.in_force}
        params = tuple(
            Param(name=name, value=value, filed=value, saved=True, kind="", live="fixed", doc="")
            for name, value in values.items()
        )
        answer = ParamAnswer(service="base", instance="1", host="desk", done=True, params=params)
        return 0.02, encode(answer)

    def _lease(self) -> None:
        counter = self.next_lease if self.clock.monotonic() > self._began + 6.5 else 5
        self.motion.say(LEASE, Lease(holder="m" if counter else "", operator="motion", counter=counter))


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
    assert len({each.id for each in desk.motion.asked}) == 2, "one drive before, and one after"
    wished = {(each.steps, each.speed) for each in desk.motion.asked}
    assert wished == {((Move(distance=0.5), Move(distance=-0.5)), 0.25)}
    table = tomllib.loads(desk.path.read_text(encoding="utf-8"))["base"]["drive"]["speed_control"]
    assert table["max_pwm"] == 110, "what else is in it stays"
    found = SpeedControl(**table)
    for name in ("motor_time", "speed_p", "speed_i", "turn_p", "turn_i"):
        assert getattr(found, name) == pytest.approx(getattr(GOOD, name), rel=0.06)
    [kept] = [each for each in desk.path.parent.iterdir() if each != desk.path]
    assert kept.read_bytes() == desk.before
    assert "Restart base now" in desk.told[-3]
    assert "still override it: GIRAFF_BASE_DRIVE__SPEED_CONTROL__TURN_I" in desk.told[-2]
    assert "The second drive is better" in desk.told[-1]
    assert "right  back" in out
    later = Desk(monkeypatch, capsys, desk.path)
    later.gains = [600.0]
    code, _, complaint = later.type()
    assert (code, complaint) == (0, "")
    assert "Keep what the file has: it drives as well" in later.told[-1]
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


def test_a_second_drive_that_is_no_better_leaves_the_file(desk: Desk) -> None:
    desk.gains = [60.0, 60.0]
    assert desk.type()[::2] == (0, "")
    assert "is as it was" in desk.told[-2]
    assert desk.told[-1] == "The second drive is not better."
    assert desk.is_untouched()


def test_a_file_that_somebody_edits_during_the_trial_is_not_overwritten(desk: Desk) -> None:
    def edit() -> None:
        desk.restart()
        desk.path.write_text(desk.path.read_text(encoding="utf-8") + "# mine\n", encoding="utf-8")

    desk.gains, desk.restarts = [60.0, 60.0], edit
    assert desk.type()[::2] == (1, "")
    assert "gains on trial are still in" in desk.told[-2]
    assert desk.path.read_text(encoding="utf-8").endswith("# mine\n")
    [kept] = [each for each in desk.path.parent.iterdir() if each != desk.path]
    assert kept.read_bytes() == desk.before


def sets(**fields: object) -> Callable[[Desk], None]:
    """Return what gives these to a desk, or to the motion beside it."""

    def prepare(desk: Desk) -> None:
        for name, value in fields.items():
            setattr(desk.motion if hasattr(desk.motion, name) else desk, name, value)

    return prepare


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


def block_later(desk: Desk) -> None:
    def restart() -> None:
        desk.restart()
        desk.motion.outcome = "blocked"

    desk.restarts = restart


def interrupt_later(desk: Desk) -> None:
    def each(stopping: StopSignal) -> None:
        if desk.path.read_bytes() != desk.before and not stopping.asked:
            stopping.ask()

    desk.each = each


def differ(desk: Desk) -> None:
    desk.in_force["speed_p"] += 1.0


FIELDS: Final = ("max_level = 70", "stall_level = 25", "battery_nominal = 24.0", 'wheel_control = "speed"')


def spell(base: str) -> Callable[[Desk], None]:
    """Return what writes a drive of these lines in [base], in place of the table of its own."""

    def edit(desk: Desk) -> None:
        text = desk.path.read_text(encoding="utf-8")
        desk.edit(text[text.index("[base.drive]") : text.index("[ranger]")], f"{base}\n\n")

    return edit


def level(desk: Desk) -> None:
    desk.edit('wheel_control = "speed"', 'wheel_control = "level"')


_TAKES_NONE: Final = "takes no [base.drive.speed_control]"
UNASKED: Final = ("other gains in force", "a no to the way", "nobody at the terminal", "silent wheels", "levels")

REFUSALS: Final[dict[str, tuple[Callable[[Desk], object], list[str], int, str]]] = {
    "a no to the way": (sets(), ["no"], 1, "nothing has moved"),
    "nobody at the terminal": (sets(), [], 2, "nobody answers"),
    "a no to writing": (sets(), ["yes", "no"], 1, "not wanted"),
    "nobody any more": (sets(), ["yes"], 2, "nobody answers"),
    "somebody else drives": (
        sets(refusal="held by joystick (1a2b) until it rests for 30 s"),
        ["yes"],
        1,
        "the robot has not moved: held by joystick",
    ),
    "a blocked way": (sets(outcome="blocked"), ["yes"], 1, "the drive stopped before its end: front_left blocks"),
    "a slowed way": (
        sets(guard_says="forward slowed: front_left sees something"),
        ["yes"],
        1,
        "guard has slowed the robot: forward slowed: front_left sees something",
    ),
    "a lease that is kept": (
        sets(next_lease=5),
        ["yes"],
        1,
        "nobody tells that giraff_motion has given the robot back",
    ),
    "silent wheels": (sets(are_heard=False), [], 2, "no wheels of giraff are heard"),
    "wheels that fall silent": (deafen, ["yes"], 1, "the wheels fell silent"),
    "Ctrl-C": (interrupt, ["yes"], 130, "interrupted"),
    "a file that is torn meanwhile": (tear, ["yes", "yes"], 1, "by hand:\n    motor_time = "),
    "other gains in force": (differ, [], 2, "base does not say that it goes by the gains of"),
    "a no to the second drive": (sets(), ["yes", "yes", "no"], 1, "are not tried"),
    "nobody for the second drive": (sets(), ["yes", "yes"], 2, "nobody answers"),
    "base that is not restarted": (sets(restarts=lambda: None), ["yes", "yes", "yes", "no"], 1, "are not tried"),
    "a blocked second way": (block_later, ["yes"] * 3, 1, "the drive stopped before its end: front_left blocks"),
    "Ctrl-C in the second drive": (interrupt_later, ["yes"] * 3, 130, "interrupted"),
    "a drive on one line": (spell(f'drive = {{ type = "wheels", {", ".join(FIELDS)} }}'), [], 2, _TAKES_NONE),
    "a drive in dotted keys": (
        spell("\n".join(f"drive.{x}" for x in ('type = "wheels"', *FIELDS))),
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
    if case == "base that is not restarted":
        assert len({each.id for each in desk.motion.asked}) == 1
    has_asked = case not in UNASKED and words != _TAKES_NONE
    assert bool(desk.motion.asked) == has_asked


def test_a_robot_that_balances_has_another_verb(desk: Desk) -> None:
    balancer = ROOT / "deploy" / "robots" / "balancer.toml"
    desk.path.write_bytes(balancer.read_bytes())
    code, _, complaint = desk.type()
    assert (code, "giraff tune balance" in complaint, desk.motion.asked) == (2, True, [])
