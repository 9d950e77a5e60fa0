"""What a person who drives with keys sees, and what of a robot must be known before."""

import ast
import io
import os
import re
from typing import Any
from unittest.mock import MagicMock

import msgspec
import pytest
from rich.console import Console

from giraff_base.drives.wheels.words import engaged_by
from giraff_cli.drive import operate
from giraff_core.lease import IDLE
from giraff_core.parameters.table import Parameters
from giraff_keyboard import main
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.picture import COLUMNS, ROWS, DrivePicture, DriveView
from giraff_keyboard.policy import Key
from giraff_keyboard.reset_request import release_question
from giraff_node.network.consent import NoRobotError
from giraff_node.network.tokens import Token
from giraff_schemas.actions import KEYS
from giraff_schemas.codec import stamped
from giraff_schemas.messages import Battery, DirectionLimit, EStop, GuardState, Lease, Sample
from giraff_schemas.params import ParamAnswer
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import Latch
from giraff_tools.network.limits import limits_of
from giraff_tools.terminal.screen import as_svg
from tests.rules.repository import ROOT
from tests.support.robots import ROBOT
from tests.unit.cli.samples import TYPES, base, bump, estop, guard, odometry, reading, verdict, with_bumpers
from tests.unit.cli.typed import Giraff
from tests.unit.keyboard.keyboards import Person

PICTURE = ROOT / "docs" / "pictures" / "drive.svg"
ARM = Trouble("not armed since base has just started", action="hold_level", argument="0.2 s")
FREE = "wait until it rests for 30 s, is silent for 1 s or at fault for 2 s"
HELD = Trouble("held by joystick (6542d227)", FREE, "ask", "joystick")
FROZEN = "front_right is frozen: it repeats one echo while the robot moves"
BLOCKED = verdict(0.0, "blocked", "front_right", FROZEN, "check it, or look for slip, or turn left or back up")
STOPPED = Trouble("emergency stop by ann@desk: smoke", action="release")
CONFIRMED = Trouble("STOPPED: base has confirmed", action="release")
SMOKE = "By ann@desk: smoke; see that the robot may move"
STUCK = engaged_by(Latch.RIGHT_STUCK)
KEYS_END = 9
"""The last row that tells the keys."""


def all_blocked(reason: DirectionLimit = BLOCKED) -> GuardState:
    return msgspec.structs.replace(guard(reason), backward=reason, turn_left=reason, turn_right=reason)


class Desk:
    """A keyboard's policy and its screen; a robot in order, until something of it is changed."""

    def __init__(self, *, ticks: bool = True) -> None:
        self.person = Person(KeyboardConfig())
        self.person.wait(0.2, ticks=ticks)
        self.view = DriveView("giraff", TYPES)
        self.stop, self.seq = NO_TROUBLE, 0
        self.take(base(), guard(verdict()), estop(), Battery(voltage=24.3), odometry(0, 1.25, 0.5, 0.3))
        self.take(reading("front_left", 1.23), reading("front_right", None, "clear"), reading("rear", 0.4))

    def take(self, *samples: Sample) -> "Desk":
        for sample in samples:
            self.view.on_sample(stamped(sample, self.seq, 0, "m"), self.person.now)
        self.seq += 1
        return self

    def holds(self, holder: str, operator: str, reason: Trouble = NO_TROUBLE, unranked: tuple[str, ...] = ()) -> "Desk":
        lease = Lease(holder=holder, operator=operator, counter=1 if holder else 0, reason=reason, unranked=unranked)
        self.person.policy.operator.on_lease(stamped(lease, 1, 0, "g"))
        return self

    def mine(self) -> "Desk":
        return self.holds("me", "keyboard")

    @property
    def picture(self) -> DrivePicture:
        return self.view.draw(self.person.policy, self.stop, self.person.now)


def drawn(picture: DrivePicture, width: int = COLUMNS, height: int = ROWS) -> list[str]:
    console = Console(file=io.StringIO(), width=width, height=height, color_system=None)
    with console.capture() as capture:
        console.print(picture.render())
    return capture.get().splitlines()


def told(desk: Desk) -> dict[str, str]:
    """The three texts, by label."""
    picture = desk.picture
    return {"ROBOT": picture.status()[0], "WHY": picture.reason()[0], "STOP": picture.stopping()[0]}


CASES: dict[str, tuple[Desk, dict[str, str]]] = {
    "not heard": (
        Desk(ticks=False),
        {"ROBOT": "not heard; waits for it, and does not move by itself", "WHY": "no tick"},
    ),
    "nobody's": (
        Desk().holds("", "", IDLE),
        {
            "ROBOT": "nobody's: press an arrow key or c to take it, then let go of all keys",
            "WHY": "idle: nobody asks to drive; press an arrow key or c to ask, then let go of all keys to arm",
        },
    ),
    "another's": (
        Desk().holds("you", "joystick", HELD),
        {
            "ROBOT": "not yours: joystick drives; WHY says when you may",
            "WHY": "2 s, then press an arrow key or c to ask",
        },
    ),
    "another's, which gives way": (
        Desk().holds("you", "demo", Trouble("held by demo (6542d227), which gives way to others", action="take")),
        {
            "ROBOT": "not yours: demo drives; WHY says when you may",
            "WHY": "gives way to others; press an arrow key to take it, then let go of all keys to arm",
        },
    ),
    "not armed": (
        Desk().mine().take(base(armed=False, reason=ARM)),
        {"ROBOT": "yours, not armed: let go of all keys for 0.2 s", "WHY": "base has just started; let go of all keys"},
    ),
    "never to be armed": (
        Desk().mine().take(base(armed=False, reason=Trouble("the wiring is not checked", "lift the wheels", "run"))),
        {"ROBOT": "yours, not armed: WHY says what is missing", "WHY": "the wiring is not checked"},
    ),
    "armed": (
        Desk().mine(),
        {"ROBOT": "yours, armed", "WHY": "nothing: the robot obeys", "STOP": "released; SPACE engages it"},
    ),
    "armed, and of no rank": (
        Desk().holds("me", "keyboard", unranked=("keyboard",)),
        {"ROBOT": "yours, armed", "WHY": "operator keyboard has no priority"},
    ),
    "blocked": (Desk().mine().take(all_blocked()), {"ROBOT": "yours, armed", "WHY": FROZEN}),
    "stopped by another": (
        Desk().mine().take(estop(engaged=True), base(armed=False, reason=STOPPED)),
        {
            "ROBOT": "yours, not armed: see that it may move, then release the stop",
            "WHY": "the emergency stop, as below",
            "STOP": "ENGAGED; r releases it. By ann@desk: smoke",
        },
    ),
    "stopped, and another's": (
        Desk().holds("you", "joystick", HELD).take(estop(engaged=True), base(armed=False, reason=STOPPED)),
        {
            "ROBOT": "stopped: see that it may move, then release the stop",
            "WHY": "the emergency stop, as below",
            "STOP": "ENGAGED; r releases it. By ann@desk: smoke",
        },
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_it_says_whose_the_robot_is_what_stops_it_and_what_to_do(case: str) -> None:
    desk, expected = CASES[case]
    says = told(desk)
    for label, text in expected.items():
        assert text in says[label]


def test_a_stop_that_was_asked_for_here_comes_first_and_does_not_hide_another() -> None:
    desk = Desk().mine()
    asked = desk.stop = Trouble("STOPPING, NOT CONFIRMED after 3 requests", "if it moves, use the battery switch")
    assert told(desk)["STOP"] == str(asked)
    desk.take(estop(engaged=True))
    assert told(desk)["STOP"] == f"{asked}. {SMOKE}"
    desk.stop = CONFIRMED
    assert told(desk)["STOP"] == f"{CONFIRMED.what}. {SMOKE}"
    desk.stop = release_question(estop(engaged=True))
    question = "RELEASE? y: yes, any other key: no. It is the stop by ann@desk: smoke; see that the robot may move"
    assert told(desk)["STOP"] == question


def test_no_reason_has_the_words_of_a_hand() -> None:
    """Each screen has words of its own: nothing that base or guard may say names a hand."""
    of_a_hand = re.compile(r"\b(level|tilt|press|arrow key)\b")
    sources = [path for part in ("base", "guard") for path in (ROOT / "services" / f"giraff_{part}").rglob("*.py")]
    texts = [text for path in sources for text in texts_of(path.read_text())]
    assert [text for text in texts if of_a_hand.search(text)] == []
    assert [text for text in KEYS.values() if re.search(r"\b(level|tilt)\b", text)] == []


def texts_of(source: str) -> list[str]:
    """Return what a person may read of a module: constants of more than a word, without the docstrings."""
    tree = ast.parse(source)
    silent = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    texts = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and id(node) not in silent]
    return [node.value for node in texts if isinstance(node.value, str) and " " in node.value]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("width", [COLUMNS, 200])
def test_it_fills_24_rows_of_the_terminal_and_never_more(case: str, width: int) -> None:
    rows = drawn(CASES[case][0].picture, width)
    assert len(rows) == ROWS
    assert all(len(row) <= width for row in rows)
    assert "Ctrl-C ends" in rows[KEYS_END]


@pytest.mark.parametrize("case", CASES)
def test_a_small_terminal_tells_how_to_stop_release_and_end(case: str) -> None:
    rows = drawn(CASES[case][0].picture, 60, 20)
    assert len(rows) == 20
    assert "SPACE stops   r releases the stop   ← ↑ ↓ →" in rows[KEYS_END - 1]
    assert "Ctrl-C ends   c takes it, stands   + -" in rows[KEYS_END]


@pytest.mark.parametrize("cause", [HELD, ARM, Trouble(f"front_right, front_left: {FROZEN}", "check them")])
def test_the_longest_reasons_are_whole_on_80_by_24(cause: Trouble) -> None:
    blocked = msgspec.structs.replace(all_blocked(), reason=cause)
    desk = Desk().mine().take(blocked, base(armed=False, reason=cause))
    running = desk.picture
    desk.take(EStop(engaged=True, id=3, by=STUCK.by, reason=STUCK.reason))
    desk.stop = CONFIRMED
    by_board = f"By the base board: {STUCK.reason}"
    for picture, told_of in (running, cause.line(KEYS)), (desk.picture, by_board):
        rows = drawn(picture)
        assert len(rows) == ROWS
        text = " ".join(" ".join(rows).split())
        assert text.count(str(BLOCKED.reason)) == 4
        assert told_of in text
        assert "…" not in text


def test_what_the_network_says_can_neither_steer_the_terminal_nor_move_a_row() -> None:
    bad = "a\x1b[2J\nb[bold]\u202e\u009b漢" * 40
    desk = Desk().holds("x", bad, Trouble(bad)).take(estop(engaged=True), base(armed=False, reason=bad))
    desk.take(all_blocked(verdict(0.0, "blocked", bad, bad, bad)), reading(bad, 1e300), Battery(voltage=1e300))
    rows = drawn(desk.picture)
    assert len(rows) == ROWS
    assert all(row.isprintable() for row in rows)
    assert "Ctrl-C ends" in rows[KEYS_END]


def test_what_is_old_is_not_shown_as_if_it_were_now() -> None:
    desk = Desk().mine()
    desk.person.wait(3.0, ticks=False)
    text = "\n".join(drawn(desk.picture))
    assert "not heard for 3 s" in text
    assert text.count("the guard is not heard") == 4
    assert "unknown, since base is not heard" in text
    for old in ("armed", "24.3 V", "ms old", "obeys", "1.23 m", "0.40 m/s"):
        assert old not in text, old


def test_a_guard_or_a_base_that_fell_silent_is_what_stops_it() -> None:
    desk = Desk().mine()
    desk.person.wait(3.0)
    assert "the guard is not heard" in told(desk)["WHY"]
    desk.take(guard(verdict()))
    assert "base is not heard" in told(desk)["WHY"]
    assert "not heard" in told(desk)["ROBOT"]


def test_speed_path_pose_ranges_and_battery_are_told() -> None:
    desk = Desk().mine()
    desk.person.press(Key.FASTER)
    backward, left, right = (verdict(allowed) for allowed in (0.2, 0.3, 0.4))
    desk.take(msgspec.structs.replace(guard(verdict()), backward=backward, turn_left=left, turn_right=right))
    text = "\n".join(drawn(desk.picture))
    for wanted in (
        r"battery 24\.3 V",
        r"speed 3/5: 0\.36 m/s, 0\.94 rad/s",
        r"path +1\.25 m",
        r"speed +0\.40 m/s",
        r"x +1\.250 m",
        r"yaw +17\.2 °",
        r"front left +1\.23 m",
        r"front right +clear",
        r"forward +free +1\.00 m/s",
        r"backward +free +0\.20 m/s",
        r"turn left +free +0\.30 rad/s",
        r"turn right +free +0\.40 rad/s",
    ):
        assert re.search(wanted, text), f"{wanted} is not in\n{text}"


def test_bumpers_have_rows_where_gaps_were() -> None:
    desk = Desk().take(with_bumpers(verdict()), bump("front", pressed=True))
    rows = drawn(desk.picture)
    assert len(rows) == ROWS
    assert [row.split()[:2] for row in rows[-2:]] == [["front", "pushed"], ["back", "silent"]]


def answer(**changes: Any) -> ParamAnswer:
    """What a base of this robot says of its parameters."""
    params = [
        msgspec.structs.replace(param, value=changes.get(param.name, param.value))
        for param in Parameters("base", KeyboardConfig(), ROBOT).describe()
    ]
    return ParamAnswer(service="base", instance="i", host="pi", done=True, params=tuple(params))


def test_the_limits_are_those_that_base_goes_by() -> None:
    assert limits_of(answer(), ROBOT.name) == ROBOT
    slow = limits_of(answer(**{"robot.max_wheel_speed": 0.1}), ROBOT.name)
    assert slow.max_wheel_speed == 0.1


@pytest.mark.parametrize(
    ("name", "value"),
    [("robot.max_wheel_speed", 1e9), ("robot.max_wheel_speed", "fast"), ("robot.track_width", None)],
)
def test_limits_that_cannot_be_are_refused_with_the_way_out(name: str, value: Any) -> None:
    with pytest.raises(NoRobotError, match=r"base of otto at pi tells limits that cannot be: .*; check its robot file"):
        limits_of(answer(**{name: value}), "otto")
    with pytest.raises(NoRobotError, match="limits that cannot be"):
        limits_of(msgspec.structs.replace(answer(), params=()), "otto")


@pytest.mark.parametrize(
    ("is_terminal", "kind", "says"), [(False, "xterm", "start it in one, without a pipe"), (True, "dumb", "it is dumb")]
)
def test_without_a_terminal_it_says_so_and_asks_nobody(
    is_terminal: bool, kind: str, says: str, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    monkeypatch.setattr(main, "in_terminal", lambda: is_terminal)
    monkeypatch.setattr(operate, "run_with_robot", None)
    monkeypatch.setenv("TERM", kind)
    code, out, err = giraff("drive")
    assert (code, out) == (2, "")
    assert says in err


def test_the_picture_of_the_page_is_this_screen() -> None:
    """`GIRAFF_WRITE_DOCS=1 pytest tests/unit/cli/test_drive.py` draws it anew."""
    near = verdict(0.15, "slow", "front_left", "front_left sees something at 0.62 m", "turn right or back up")
    desk = Desk().mine()
    assert desk.picture.elapsed == 0.0
    desk.person.wait(42.0)
    ranges = reading("front_left", 0.62), reading("front_right", None, "clear"), reading("rear", 1.04)
    samples = (base(), msgspec.structs.replace(guard(near), reason=NO_TROUBLE), estop(), Battery(voltage=24.3))
    desk.take(*samples, msgspec.structs.replace(odometry(0, 1.25, 0.5, 0.3), linear_x=0.15), *ranges)
    for _ in range(3):
        desk.person.wait(0.2)
        desk.take(*ranges)
    svg = as_svg(desk.picture.render(), title="giraff drive", columns=COLUMNS)
    if os.environ.get("GIRAFF_WRITE_DOCS"):
        PICTURE.write_text(svg)
    assert PICTURE.read_text() == svg, "drawn by another screen: GIRAFF_WRITE_DOCS=1"


@pytest.mark.parametrize(("service", "leaves"), [("base", True), ("watch", False)])
def test_a_simulation_that_stands_in_is_left_when_the_named_robot_is_heard(
    service: str, leaves: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The screen has a stop on it."""
    node, heard = MagicMock(), []
    monkeypatch.setattr(operate, "Node", lambda *_, **__: node)
    monkeypatch.setattr(operate, "open_hand", MagicMock())
    monkeypatch.setattr(operate, "watch_tokens", lambda _, robot, on_token: heard.append((robot, on_token)))

    def run_keyboard(_: object) -> tuple[str, MagicMock]:
        heard[0][1](Token("giraff", service, "1"), True)
        return "", MagicMock(is_stuck=False)

    monkeypatch.setattr(operate, "run_keyboard", run_keyboard)
    settings = MagicMock(robot=ROBOT)
    code = operate._drive(MagicMock(robot="sim-vm", stands_in_for="giraff"), settings)
    assert heard[0][0] == "giraff"
    assert node.leave.called == leaves
    assert code == int(leaves)
    assert ("drive: giraff is heard now, and this was sim-vm" in capsys.readouterr().err) == leaves
