"""`giraff calibrate joystick` with a board and a person made of Python, judged by how the sensor truly sits."""

import itertools
import json
import math
import random
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

import pytest

from giraff_core.live import Live
from giraff_core.tilt.clutch import Vector
from giraff_core.tilt.mount import Rows
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_node.boards.serial_link import IN_USE
from giraff_node.config.robot_file import load
from giraff_schemas.boards import JOYSTICK_BOARD, BoardType
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import TiltFrame, TiltStatus
from giraff_setup.joystick import calibrate
from giraff_setup.joystick.attitude import PoseError, gravity_of
from giraff_sim.board import ROOT
from giraff_tools.terminal.human import NobodyError
from tests.support.operators import said
from tests.unit.joystick.frames import ROBOT, tilt_frame

GRAVITY = 9.80665
ZERO, X, Y, Z = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def minus(a: Vector) -> Vector:
    return -a[0], -a[1], -a[2]


AXES: list[Vector] = [X, Y, Z, minus(X), minus(Y), minus(Z)]
SQUARE: list[Rows] = [(x, cross(z, x), z) for x, z in itertools.product(AXES, repeat=2) if x not in {z, minus(z)}]
"""The 24 ways in which a sensor can sit at right angles: the joystick's axes, each in the sensor."""


def tilted(degrees: float, towards: float = 0.0) -> Vector:
    """Gravity in a joystick that is tilted `towards` (degrees: 0 forward, 90 to the left)."""
    tilt, way = math.radians(degrees), math.radians(towards)
    level = GRAVITY * math.sin(tilt)
    return level * math.cos(way), level * math.sin(way), GRAVITY * math.cos(tilt)


class Truth:
    """A sensor in a joystick."""

    def __init__(
        self, square: Rows, off: tuple[float, float] = (0.0, 0.0), offset: Vector = ZERO, noise: float = 0.012
    ) -> None:
        """`off`: degrees off level, about the joystick's axes x and y; `offset`: m/s² that each axis reads too much."""
        self._square, self._offset = square, offset
        self._roll, self._pitch = map(math.radians, off)
        self._random, self._noise = random.Random(7), noise

    def feels(self, gravity: Vector) -> Vector:
        """What it reads, m/s², when this acts on the joystick."""
        x, y, z = gravity
        x, z = (
            x * math.cos(self._pitch) - z * math.sin(self._pitch),
            x * math.sin(self._pitch) + z * math.cos(self._pitch),
        )
        y, z = y * math.cos(self._roll) + z * math.sin(self._roll), z * math.cos(self._roll) - y * math.sin(self._roll)
        axes = zip(*self._square, self._offset, strict=True)
        a, b, c = (ax * x + ay * y + az * z + off + self._random.gauss(0.0, self._noise) for ax, ay, az, off in axes)
        return a, b, c


class Link:
    """A joystick board on its port: 25 frames at each look."""

    fault = Trouble("port: silent for 1 s", "check the board's power and cable")
    truth = Truth((X, Y, Z))
    pose = tilted(0.0)
    status = TiltStatus.RUNNING
    boot = 1
    is_there = True
    shakes = False
    closed = False

    def __init__(self, port: str, kind: BoardType) -> None:
        assert (port, kind) == ("/dev/giraff-joystick", JOYSTICK_BOARD)
        Link.closed = False

    def poll(self, now: float) -> list[TiltFrame]:
        del now
        return [self._frame(number) for number in range(25)] if self.is_there else []

    def _frame(self, number: int) -> TiltFrame:
        x, y, z = self.truth.feels(self.pose)
        z += 2.0 * (-1) ** number if self.shakes else 0.0
        return tilt_frame(x, y, z, status=self.status, boot_id=self.boot)

    def descriptor(self) -> None: ...

    def close(self) -> None:
        Link.closed = True


class Person:
    """Holds the joystick as it is asked to, but for what `instead` has, and says what is asked."""

    instead: dict[str, Callable[[], None]]
    answer = "yes"
    shown = ""
    told: list[str]
    poses: ClassVar = {"Lay the": tilted(1e-9), "Tilt it": tilted(32.0, 7.0), "Lay it": tilted(28.0, 85.0)}

    def __init__(self, *_: object) -> None: ...

    def show(self, text: str) -> None:
        self.told.append(text)
        assert len(self.told) < 20, "asked again and again"

    def ask(self, question: str, meanwhile: Callable[[], str]) -> str:
        meanwhile()
        what = question[:7].strip()
        Link.shakes = False
        Link.pose = self.poses.get(what, Link.pose)
        if spoil := self.instead.pop(what, None):
            spoil()
        Person.shown = meanwhile()
        return "" if what in self.poses else self.answer


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    copy = tmp_path / "robot.toml"
    copy.write_bytes((ROOT / "deploy" / "robot.toml").read_bytes())
    monkeypatch.setenv("GIRAFF_CONFIG", str(copy))
    monkeypatch.setattr(calibrate, "BoardLink", Link)
    monkeypatch.setattr(calibrate, "_SILENCE", 0.0)
    monkeypatch.setattr(calibrate, "Terminal", Person)
    for name in ("truth", "pose", "status", "boot", "is_there", "shakes"):
        monkeypatch.setattr(Link, name, getattr(Link, name))
    for name, value in (("instead", {}), ("told", []), ("answer", "yes")):
        monkeypatch.setattr(Person, name, value, raising=False)
    return copy


OFF = (((3.0, -4.0), (0.3, 0.3, 0.3)), ((-5.0, 2.0), (-0.3, 0.3, -0.3)))
"""Degrees off square, and m/s² off zero."""


@pytest.mark.parametrize(("square", "off"), [(square, OFF[n % 2]) for n, square in enumerate(SQUARE)], ids=str)
def test_a_tilt_asks_for_its_own_direction_however_the_sensor_sits(
    square: Rows, off: tuple[tuple[float, float], Vector], path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth = Truth(square, *off)
    monkeypatch.setattr(Link, "truth", truth)
    assert calibrate.calibrate_joystick(None, None) == 0
    config = load("joystick", JoystickConfig)
    for towards, degrees in itertools.product((0.0, 90.0, 180.0, 270.0), (0.0, 25.0)):
        joystick = JoystickPolicy(Live(config), ROBOT, "me")
        tilt = joystick.on_frame(tilt_frame(*truth.feels(tilted(degrees, towards))), 1.0)
        asks = said(joystick, 1.0)
        true = tilted(degrees, towards)
        for axis, is_asked, truly in ((tilt.x, asks.linear_x, true[0]), (tilt.y, asks.angular_z, true[1])):
            angle, right = (math.degrees(math.asin(part / GRAVITY)) for part in (axis, truly))
            assert angle == pytest.approx(right, abs=3.0)
            assert math.copysign(bool(is_asked), is_asked) == (0 if abs(right) < 1 else math.copysign(1, right))
    assert "forward" in Person.shown
    kept = [each.name for each in path.parent.iterdir() if ".before-" in each.name]
    assert len(kept) == 1
    before, after = (tomllib.loads(each.read_text()) for each in (ROOT / "deploy" / "robot.toml", path))
    for name in ("mount_roll", "mount_pitch", "mount_yaw"):
        del after["joystick"][name]
    assert after == before


@pytest.mark.parametrize(
    ("sits", "words"),
    [
        ((X, Y, Z), "not turned"),
        ((minus(Y), X, Z), "turned 90° to the left"),
        ((Y, minus(X), Z), "turned 90° to the right"),
        ((X, minus(Y), minus(Z)), "upside down"),
        ((Z, Y, minus(X)), "on edge, facing backward"),
        ((X, minus(Z), Y), "on edge, facing left"),
    ],
)
def test_it_is_told_in_words(
    sits: Rows, words: str, path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Link, "truth", Truth(sits, (2.1, 0.0)))
    assert calibrate.calibrate_joystick(None, path, as_json=True) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["tables"]["joystick"].keys() == {"mount_roll", "mount_pitch", "mount_yaw"}
    assert told["robot_file"] == str(path)
    assert f"The sensor is {words}, and 2.1° off level." in Person.told


def hold(**values: object) -> Callable[[], None]:
    def spoil() -> None:
        for name, value in values.items():
            setattr(Link, name, value)

    return spoil


def raising(error: BaseException) -> Callable[[], None]:
    def spoil() -> None:
        raise error

    return spoil


@pytest.mark.parametrize(
    ("instead", "code", "told"),
    [
        ({"Lay it": hold(pose=tilted(30.0, 270.0))}, 1, "left and right, or forward and backward, were exchanged"),
        ({"Tilt it": hold(pose=tilted(30.0, 180.0))}, 1, "left and right, or forward and backward, were exchanged"),
        ({"Lay it": hold(pose=tilted(30.0))}, 1, "both tilts were along one axis"),
        ({"Tilt it": hold(pose=tilted(30.0, 35.0))}, 1, "in doubt: the tilt forward is 35 degrees beside"),
        (
            {"Tilt it": hold(is_there=False)},
            1,
            "silent for 1 s; check the board's power and cable. Nothing",
        ),
        ({"Tilt it": hold(status=TiltStatus.BUS_FAULT)}, 1, "no reading, or one without gravity; press its shield"),
        ({"Tilt it": hold(status=TiltStatus.STARTING)}, 1, "the tilt sensor is starting; wait a second"),
        ({"Tilt it": hold(truth=Truth((ZERO, ZERO, ZERO), noise=0.0))}, 1, "no reading, or one without gravity"),
        ({"Lay it": hold(boot=2)}, 1, "the board was reset in between"),
        ({"Lay the": raising(NobodyError())}, 2, "nobody answers"),
        ({"Lay it": raising(KeyboardInterrupt())}, 130, "interrupted"),
        ({"Write i": lambda: setattr(Person, "answer", "no")}, 1, "not wanted"),
        ({"Write i": hold(is_there=False)}, 1, "silent for 1 s"),
    ],
)
def test_any_doubt_writes_nothing(
    instead: dict[str, Callable[[], None]],
    code: int,
    told: str,
    path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = path.read_bytes()
    monkeypatch.setattr(Person, "instead", instead)
    assert calibrate.calibrate_joystick(None, None) == code
    err = capsys.readouterr().err
    assert told in err
    assert "Nothing was written" in err
    assert path.read_bytes() == before
    assert Link.closed


@pytest.mark.parametrize(
    ("what", "spoil", "told"),
    [
        (
            "Tilt it",
            hold(pose=tilted(12.0)),
            "the joystick is tilted by 12 degrees; tilt it by 15 to 75, best about 30.",
        ),
        ("Tilt it", hold(shakes=True), "the joystick does not keep still; rest it on something firm."),
        ("Lay it", hold(pose=tilted(80.0, 90.0)), "the joystick is tilted by 80 degrees; tilt it by 15 to 75"),
        (
            "Lay the",
            hold(pose=tilted(30.0, 10.0)),
            "the sensor is 30 degrees off level; lay the joystick flat, or glue",
        ),
        ("Lay the", hold(pose=(0.0, 0.0, 5.0)), "the sensor reads 5.0 m/s², and gravity is 9.81; unplug the board"),
    ],
)
@pytest.mark.usefixtures("path")
def test_a_pose_that_tells_nothing_is_asked_for_again(
    what: str, spoil: Callable[[], None], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Person, "instead", {what: spoil})
    assert calibrate.calibrate_joystick(None, None) == 0
    assert any(each.startswith(told) for each in Person.told)


@pytest.mark.parametrize(
    ("readings", "told"),
    [
        ([(math.nan, 0.0, 9.8)] * 50, "does not keep still"),
        ([ZERO] * 50, "reads 0.0 m/s²"),
        ([(0.0, 0.0, 9.3), (0.0, 0.0, 10.4)] * 25, "does not keep still"),
    ],
)
def test_what_is_no_gravity_or_moves_is_no_pose(readings: list[Vector], told: str) -> None:
    with pytest.raises(PoseError, match=told):
        gravity_of(readings)


def test_where_the_port_is_taken_or_no_table_is_there_it_does_not_begin(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Link, "is_there", False)
    monkeypatch.setattr(Link, "fault", IN_USE.of("/dev/giraff-joystick"))
    assert calibrate.calibrate_joystick(None, None) == 2
    complaint = "/dev/giraff-joystick: in use by another process; end that one; giraff_joystick must not run meanwhile"
    assert capsys.readouterr().err == f"giraff calibrate joystick: {complaint}\n"
    path.write_text(re.sub(r"\[joystick\]\n(.+\n)*", "", path.read_text(encoding="utf-8")), encoding="utf-8")
    assert calibrate.calibrate_joystick("/dev/giraff-joystick", None) == 2
    assert "has no table [joystick]; add a line with this name" in capsys.readouterr().err
    assert not Person.told
