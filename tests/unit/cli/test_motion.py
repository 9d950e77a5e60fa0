"""`giraff move`, `turn`, `arc` and `go` against a motion that is there by itself: what is said, and the exit codes.

With real processes: tests/functional/robot/test_motion.py.
"""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import pytest
from rich.console import Console

import giraff_node.motion_client
import giraff_node.network.query_client
import giraff_tools.terminal.screen
from giraff_cli.motion import perform
from giraff_cli.motion.perform import MotionView, describe
from giraff_core.motion.result import MotionResult
from giraff_core.network import NetworkConfig
from giraff_node.network.consent import NoRobotError
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.localization import MapPose
from giraff_schemas.motion import NOWHERE, Arc, GoTo, Move, Outcome, Step, Turn
from giraff_schemas.topics import POSE, key_of
from giraff_tools.network.command import print_error
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.signals import StopSignal
from tests.rules.repository import ROOT
from tests.support.motion_double import BLOCKED, MotionDouble, motion_state
from tests.support.one_process import Clock, Session
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.typed import typed

NAME = "sim-moved"
THERE_AND_BACK = ROOT / "deploy" / "patterns" / "there_and_back.toml"
SQUARE = ROOT / "deploy" / "patterns" / "square.toml"


class Desk:
    """A terminal beside a robot: what is typed there, and who answers."""

    def __init__(self, patch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self.clock = Clock()
        self.session = Session(self.clock)
        self.motion = MotionDouble(self.session, self.clock, NAME)
        self._patch, self._capsys = patch, capsys
        self._connection = RobotConnection(NAME, cast(Any, self.session), network=NetworkConfig())
        self.robots: list[tuple[str | None, bool]] = []
        """Which was named, and whether it may be moved."""
        self.each: Callable[[StopSignal], object] = lambda _: None
        """What happens in each turn."""
        for module in (perform, giraff_node.motion_client, giraff_node.network.query_client):
            patch.setattr(module, "time", self.clock)
        patch.setattr(perform, "run_with_robot", self._visit)
        patch.setattr(giraff_tools.terminal.screen, "_takes_more", lambda: True)

        def wait(stopping: StopSignal, seconds: float, patience: int = 1) -> bool:
            self.clock.sleep(seconds)
            self.each(stopping)
            return stopping.asked >= patience

        patch.setattr(StopSignal, "wait", wait)

    def _visit(self, robot: str | None, connect: object, act: Callable[[RobotConnection], int], *, moves: bool) -> int:
        del connect
        self.robots.append((robot, moves))
        try:
            return guard_stdout(lambda: act(self._connection))
        except NoRobotError as error:
            return print_error(str(error))

    def type(self, *words: str) -> tuple[int, str, str]:
        """Exit code, output and complaint."""
        return typed(self._patch, self._capsys, *words)


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Desk:
    return Desk(monkeypatch, capsys)


def test_it_arrives_and_says_how_far_it_came(desk: Desk) -> None:
    desk.motion.takes = 2.5
    code, out, complaint = desk.type("move", "1.0", "--speed", "0.3", "--time-limit", "20", "--robot", NAME)
    assert (code, complaint) == (0, "")
    *lines, last = out.splitlines()
    assert lines[0] == "   2.0 s | moving | 0.500 of 1.000 m"
    way = "0.998 of 1.000 m; ± 0.010 m ahead, 0.020 m aside, 1.7° (1 sigma)"
    assert last == f"{NAME}: arrived after 2.0 s: {way}"
    [request] = desk.motion.asked
    assert (request.steps, request.speed, request.time_limit) == ((Move(distance=1.0),), 0.3, 20.0)
    assert "@" in request.by
    assert request.id > 0
    assert desk.robots == [(NAME, True)], "it moves: whose robot it may be is asked as of `giraff drive`"
    assert desk.motion.holds[0][0] < 0.1
    assert len(desk.motion.holds) == pytest.approx(62, abs=3)


def test_at_a_point_of_the_map_it_says_how_sure_localization_is(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(perform, "robot_now_ns", desk.clock.monotonic_ns)
    monkeypatch.setattr("giraff_tools.network.connection.robot_now_ns", desk.clock.monotonic_ns)
    said = encode(stamped(map_pose(1, state="told"), 1, 0, "l"))
    desk.each = lambda _: desk.session.put(key_of(NAME, POSE), said, encoding=encoding_of(MapPose))
    assert "on the map" not in desk.type("go", "1,2")[1]
    code, out, _ = desk.type("go", "1,2", "--frame", "map")
    assert (code, out.splitlines()[-1].partition("(1 sigma)")[2]) == (0, "; on the map, told: ± 0.05 m, 1.1°")
    code, out, _ = desk.type("go", "1,2", "--frame", "map", "--json")
    assert json.loads(out)["map"] == {"state": "told", "standard_deviations": {"x": 0.03, "y": 0.04, "yaw": 0.02}}


@pytest.mark.parametrize(
    ("words", "steps"),
    [
        (("move", "-0.5"), [Move(distance=-0.5)]),
        (("move", "--", "-2m"), [Move(distance=-2.0)]),
        (("turn", "-90deg"), [Turn(angle=-math.pi / 2)]),
        (("turn", "--", "-pi/2"), [Turn(angle=-math.pi / 2)]),
        (("turn", "3pi"), [Turn(angle=3 * math.pi)]),
        (("arc", "1.5", "-180°"), [Arc(radius=1.5, angle=-math.pi)]),
        (
            ("go", str(THERE_AND_BACK)),
            [Move(distance=2.0), Turn(angle=math.pi), Move(distance=2.0), Turn(angle=-math.pi)],
        ),
        (("go", "1,-2.5"), [GoTo(x=1.0, y=-2.5)]),
        (("go", "-1.5,2m", "--frame", "map", "--speed", "0.2"), [GoTo(x=-1.5, y=2.0, frame="map")]),
        (("go", str(SQUARE)), [Move(distance=1.0), Turn(angle=math.pi / 2)] * 4),
    ],
    ids=str,
)
def test_what_is_typed_is_what_is_asked(desk: Desk, words: tuple[str, ...], steps: list[Step]) -> None:
    assert desk.type(*words)[0] == 0
    assert list(desk.motion.asked[0].steps) == steps


def test_a_place_is_gone_to_by_its_name_and_a_wait_says_why(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(perform, "robot_now_ns", desk.clock.monotonic_ns)
    monkeypatch.setattr("giraff_tools.network.connection.robot_now_ns", desk.clock.monotonic_ns)
    said = encode(stamped(map_pose(1), 1, 0, "l"))
    desk.each = lambda _: desk.session.put(key_of(NAME, POSE), said, encoding=encoding_of(MapPose))
    desk.motion.takes = 4.0
    code, out, complaint = desk.type("go", "kitchen", "--robot", NAME)
    assert (code, complaint) == (0, "")
    lines = out.splitlines()
    assert lines[0] == "   0.1 s | moving | leg 2 of 5 | 3.2 of 7.9 m"
    assert f"   2.1 s | waiting | leg 2 of 5 | 3.2 of 7.9 m | {BLOCKED}" in lines
    assert lines[-1] == (f"{NAME}: arrived at kitchen after 4.1 s: 7.9 of 7.9 m; on the map, localized: ± 0.05 m, 1.1°")
    [request] = desk.motion.routes
    assert (request.goal, desk.motion.asked, desk.robots) == ("kitchen", [], [(NAME, True)])
    assert len(desk.motion.holds) == pytest.approx(100, abs=3)


@pytest.mark.parametrize(
    ("outcome", "told"),
    [
        ("blocked", f"BLOCKED in leg 2 of 5, at 4.10,2.20 m: {BLOCKED}"),
        ("cancelled", "stopped in leg 2 of 5, at 4.10,2.20 m: it is cancelled"),
        ("no_room", "ended, it cannot stand at its goal: it is no_room"),
        ("no_way", "ended, no way leads to its goal: it is no_way"),
        ("too_narrow", "ended, each way is too narrow: it is too_narrow"),
        ("forbidden", "ended, each way crosses a no-go line: it is forbidden"),
    ],
)
def test_a_route_that_ends_elsewhere_says_where_and_why(desk: Desk, outcome: Outcome, told: str) -> None:
    desk.motion.outcome = outcome
    code, _, complaint = desk.type("go", "dining", "table")
    assert (code, desk.motion.routes[0].goal) == (1, "dining table")
    assert complaint == f"giraff: {NAME}: {told}; it came 3.2 of 7.9 m to kitchen\n"
    code, out, _ = desk.type("go", "kitchen", "--json")
    document = json.loads(out)
    assert (code, document["place"], document["at"], document["step"]) == (1, "kitchen", [4.1, 2.2], 2)


def test_a_place_that_there_is_not_moves_nothing(desk: Desk) -> None:
    desk.motion.refusal = "no place is called kitchn; is kitchen meant?"
    assert desk.type("go", "kitchn") == (2, "", f"giraff: {NAME} has not moved: {desk.motion.refusal}\n")
    desk.motion.refusal, desk.motion.answers, desk.motion.speaks = "", False, False
    assert "check that giraff_places runs" in desk.type("go", "kitchen")[2]


def test_each_wish_has_an_id_of_its_own(desk: Desk) -> None:
    for _ in range(2):
        assert desk.type("move", "1")[0] == 0
    assert len({request.id for request in desk.motion.asked}) == 2


def test_a_blocked_way_says_which_sensor_and_the_way_out(desk: Desk) -> None:
    desk.motion.outcome = "blocked"
    code, out, complaint = desk.type("move", "1.0")
    assert code == 1
    assert "arrived" not in out
    came = "it came 0.500 of 1.000 m; ± 0.010 m ahead, 0.020 m aside, 1.7° (1 sigma)"
    assert complaint == f"giraff: {NAME}: BLOCKED: {BLOCKED}; {came}\n"


@pytest.mark.parametrize(
    "outcome", ["lost_lease", "time_limit", "lost_requester", "disarmed", "lost_odometry", "lost_localization"]
)
def test_whatever_else_ends_it_is_told_with_its_reason(desk: Desk, outcome: Outcome) -> None:
    desk.motion.outcome = outcome
    code, _, complaint = desk.type("move", "1.0")
    assert code == 1
    assert f": it is {outcome}; it came 0.500 of 1.000 m" in complaint


def test_a_refusal_moves_nothing(desk: Desk) -> None:
    desk.motion.refusal = "held by joystick (1a2b) until it rests for 30 s"
    assert desk.type("move", "1.0") == (2, "", f"giraff: {NAME} has not moved: {desk.motion.refusal}\n")


def test_where_no_motion_runs_it_says_what_to_check(desk: Desk) -> None:
    desk.motion.answers = desk.motion.speaks = False
    code, out, complaint = desk.type("turn", "1")
    assert (code, out) == (2, "")
    assert "nobody has answered within 3 s; check that giraff_motion runs; on a secured network" in complaint
    assert len(desk.motion.asked) > 10, "it is asked again"
    assert len({request.id for request in desk.motion.asked}) == 1


def test_a_robot_whose_clock_is_not_heard_is_told_from_one_that_is_not_there(desk: Desk) -> None:
    desk.motion.ticks = False
    code, out, complaint = desk.type("turn", "1")
    assert (code, out) == (2, "")
    assert complaint == f"giraff: the clock of {NAME} is not heard within 3 s; check that giraff_base runs\n"
    assert desk.motion.asked == []


@pytest.mark.parametrize("silent", ["motion", "robot"])
def test_what_is_heard_no_more_has_an_unknown_end(desk: Desk, silent: str) -> None:
    desk.motion.takes = 60.0

    def fall_silent(_: StopSignal) -> None:
        if desk.clock.monotonic() > 1.0:
            desk.motion.speaks = desk.motion.ticks = False
            desk.motion.ticks = silent == "motion"

    desk.each = fall_silent
    code, _, complaint = desk.type("move", "1")
    assert code == 1
    says = {"motion": "HOW IT ENDED IS NOT KNOWN: giraff_motion is silent", "robot": "the robot is not heard any more"}
    assert says[silent] in complaint
    assert "it came 0.500 of 1.000 m" in complaint


def test_ctrl_c_lets_go_and_says_how_far_it_came(desk: Desk) -> None:
    desk.motion.takes = 60.0
    stopped: list[float] = []

    def interrupt(stopping: StopSignal) -> None:
        if not stopped and desk.clock.monotonic() > 1.0:
            stopped.append(desk.clock.monotonic())
            stopping.ask()

    desk.each = interrupt
    code, _, complaint = desk.type("move", "1")
    assert code == 1
    assert f"{NAME}: stopped: it is cancelled; it came 0.500 of 1.000 m" in complaint
    assert [cancel.id for cancel in desk.motion.cancelled] == [desk.motion.asked[0].id]
    assert desk.motion.holds[-1][0] <= stopped[0]


def test_a_cancel_that_is_not_answered_is_asked_again(desk: Desk) -> None:
    desk.motion.takes = 60.0

    def interrupt(stopping: StopSignal) -> None:
        if not stopping.asked and desk.clock.monotonic() > 1.0:
            desk.motion.answers = desk.motion.speaks = False
            stopping.ask()

    desk.each = interrupt
    code, _, complaint = desk.type("move", "1")
    assert code == 1
    assert "HOW IT ENDED IS NOT KNOWN: its end was not heard within 2.5 s of the cancel" in complaint
    assert len(desk.motion.cancelled) > 5


def test_ctrl_c_before_the_robot_is_heard_asks_nothing(desk: Desk) -> None:
    desk.motion.ticks = False
    desk.each = lambda stopping: stopping.ask()
    code, _, complaint = desk.type("move", "1")
    assert code == 2
    assert "has not moved: cancelled before giraff_motion had accepted it" in complaint
    assert desk.motion.asked == []


def test_a_reader_who_has_gone_stops_it(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    class Gone:
        def show(self, _: object) -> None:
            raise BrokenPipeError

        def close(self) -> None:
            """Nothing is left to restore."""

    desk.motion.takes = 60.0
    monkeypatch.setattr(perform, "open_screen", lambda **_: Gone())
    monkeypatch.setattr(perform, "discard_stdout", lambda: None)
    code, out, complaint = desk.type("move", "1")
    assert (code, out) == (1, "")
    assert "stopped: it is cancelled" in complaint
    assert desk.clock.monotonic() < 2.0


def test_json_is_one_object(desk: Desk) -> None:
    code, out, complaint = desk.type("move", "1", "--json")
    told = json.loads(out)
    assert (code, complaint) == (0, "")
    assert (told["robot"], told["outcome"], told["begun"]) == (NAME, "arrived", True)
    assert (told["asked"]["path"], told["achieved"]["path"]) == (1.0, 0.998)
    assert told["standard_deviations"] == pytest.approx({"x": 0.01, "y": 0.02, "yaw": 0.03})
    desk.motion.outcome = "blocked"
    code, out, complaint = desk.type("move", "1", "--json")
    told = json.loads(out)
    assert (code, complaint, told["sensor"], told["reason"]) == (1, "", "front_left", BLOCKED)
    desk.motion.refusal = "no"
    code, out, complaint = desk.type("move", "1", "--json")
    assert (code, json.loads(out)["outcome"], complaint) == (2, "refused", f"giraff: {NAME} has not moved: no\n")


@pytest.mark.parametrize(
    ("view", "share"),
    [
        (MotionView(motion_state(1)), 0.5),
        (MotionView(motion_state(1, asked=NOWHERE)), 0.0),
        (MotionView(motion_state(1, steps=4, step=3)), 0.5),
        (MotionView(motion_state(1, steps=4, step=0)), 0.0),
        (MotionView(motion_state(1, "ended", "arrived")), 1.0),
    ],
)
def test_a_bar_shows_how_far_it_is(view: MotionView, share: float) -> None:
    assert view.share == share
    console = Console(width=80)
    with console.capture() as captured:
        console.print(view.render())
    assert "0.500" in captured.get()


def test_what_the_network_says_steers_no_terminal() -> None:
    told = MotionResult(outcome="blocked", begun=True, reason="\x1b[2J gone\n", step=2, steps=4)
    assert describe(NAME, told).startswith(f"{NAME}: BLOCKED in step 2 of 4: ?[2J gone?; it came ")


def test_a_point_is_a_step_of_a_pattern(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "p.toml").write_text(
        "speed = 0.2\nturn_speed = 0.5\ntime_limit = 30\n[[step]]\ngo_to = [1, -2.5]\n"
        '[[step]]\ngo_to = [3, 4]\nframe = "map"\n'
    )
    assert desk.type("go", str(tmp_path / "p.toml"))[0] == 0
    [request] = desk.motion.asked
    assert request.steps == (GoTo(x=1.0, y=-2.5), GoTo(x=3.0, y=4.0, frame="map"))
    assert (request.speed, request.turn_speed, request.time_limit) == (0.2, 0.5, 30.0)
