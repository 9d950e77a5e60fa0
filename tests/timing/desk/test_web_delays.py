"""How late what a hand does is on the network, what the robot says is on the page, and a STOP is in force.

Page, services and test are on one host: all moments are of its wall clock.
"""

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

import pytest

from giraff_schemas.messages import DriveCommand, EStop, Tick
from giraff_schemas.topics import ESTOP, OPERATOR_CMD_VEL, TICK
from tests.loop.reaction import quantile
from tests.support.browser import Phone, browser
from tests.support.process_robot import ARENA, ProcessRobot, process_robot
from tests.support.report import report
from tests.support.web_page import TILT, choose, served, take, take_hold, tap
from tests.timing.stalled import by_the_wall

TRIALS: Final = 30
STEEP: Final = 25.0
"""Degrees."""
FELT: Final = 2.0
"""m/s² by which a reading differs from that of a level phone."""

DIARY: Final = """
(() => {
  const now = () => performance.timeOrigin + performance.now();
  const diary = (window.diary = { states: [], readings: [], taps: [], lifts: [] });
  const Plain = WebSocket;
  window.WebSocket = class extends Plain {
    constructor(...words) {
      super(...words);
      this.addEventListener("message", (event) => {
        const said = JSON.parse(event.data);
        if (said.type === "state" && said.tick) diary.states.push([now(), said.tick[1]]);
      });
    }
  };
  addEventListener("devicemotion", (event) => {
    diary.readings.push([performance.timeOrigin + event.timeStamp, event.accelerationIncludingGravity.y]);
  });
  addEventListener("pointerdown", (event) => diary.taps.push(performance.timeOrigin + event.timeStamp), true);
  addEventListener("pointerup", (event) => diary.lifts.push(performance.timeOrigin + event.timeStamp), true);
})();
"""
"""What comes to the page, with its moments, ms of the wall clock."""


class Heard:
    """What was said on the network."""

    def __init__(self, robot: ProcessRobot) -> None:
        self.ticks: list[Tick] = []
        self.commands: list[DriveCommand] = []
        self.stops: list[EStop] = []
        robot.observer.listen(TICK, self.ticks.append)
        robot.observer.listen(OPERATOR_CMD_VEL.at("web"), self.commands.append)
        robot.observer.listen(ESTOP, self.stops.append)


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), ARENA, boards="host") as made:
        made.stop("joystick")
        yield made


@pytest.fixture(scope="module")
def phone(robot: ProcessRobot, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Phone]:
    """Its page keeps a diary."""
    with served(robot) as address, browser(tmp_path_factory.mktemp("browser") / "profile") as people:
        held = people.phone()
        held.page.add_init_script(DIARY)
        take(held, address)
        yield held


def diary(phone: Phone, kind: str) -> list[Any]:
    """All that was written since the last look."""
    written: list[Any] = phone.page.evaluate("(kind) => diary[kind].splice(0)", kind)
    return written


def first(lists: Sequence[Any], holds: Callable[[Any], bool]) -> Any | None:
    return next((each for each in [*lists] if holds(each)), None)


def tell(name: str, late: Sequence[float]) -> None:
    """`late`: ms."""
    found = {"median": statistics.median(late), "p95": quantile(late, 0.95), "worst": max(late), "of": len(late)}
    report(f"timing/web-{name}", {key: round(value, 1) for key, value in found.items()})


def test_a_tilt_is_soon_a_command(robot: ProcessRobot, phone: Phone) -> None:
    heard, late, ends = Heard(robot), list[float](), list[float]()
    choose(phone, "Tilt")
    begin_ns = time.monotonic_ns()
    for number in range(TRIALS):
        phone.tilt()
        take_hold(phone, TILT)
        heard.commands.clear()
        diary(phone, "readings")
        phone.tilt(forward=STEEP if number % 2 else -STEEP)
        phone.wait(lambda: first(heard.commands, lambda each: not each.neutral), "a command")
        felt = first(diary(phone, "readings"), lambda each: abs(each[1]) > FELT)
        asked = first(heard.commands, lambda each: not each.neutral)
        assert felt is not None
        assert asked is not None
        late.append(asked.stamp_ns * 1e-6 - felt[0])
        phone.hold(0.1)
        heard.commands.clear()
        phone.lift()
        phone.wait(lambda: first(heard.commands, lambda each: each.neutral), "the end of it")
        neutral = first(heard.commands, lambda each: each.neutral)
        assert neutral is not None
        ends.append(neutral.stamp_ns * 1e-6 - diary(phone, "lifts")[-1])
    tell("tilt", late)
    tell("lift", ends)
    with by_the_wall(begin_ns):
        assert max(quantile(late, 0.95), quantile(ends, 0.95)) <= 100.0


def test_what_the_robot_says_is_soon_on_the_page(robot: ProcessRobot, phone: Phone) -> None:
    heard = Heard(robot)
    begin_ns = time.monotonic_ns()
    diary(phone, "states")
    phone.hold(4.0)
    said = {str(tick.time.robot_ns): tick.stamp_ns * 1e-6 for tick in [*heard.ticks]}
    late = [at - said[robot_ns] for at, robot_ns in diary(phone, "states") if robot_ns in said]
    tell("state", late)
    with by_the_wall(begin_ns):
        assert len(late) > 60
        assert quantile(late, 0.95) <= 100.0


def test_a_stop_is_soon_in_force(robot: ProcessRobot, phone: Phone) -> None:
    heard, late = Heard(robot), list[float]()
    begin_ns = time.monotonic_ns()
    for _ in range(TRIALS):
        heard.stops.clear()
        diary(phone, "taps")
        tap(phone, "STOP")
        phone.wait(lambda: first(heard.stops, lambda each: each.engaged), "the stop")
        engaged = first(heard.stops, lambda each: each.engaged)
        assert engaged is not None
        late.append(engaged.stamp_ns * 1e-6 - diary(phone, "taps")[0])
        assert robot.giraff("estop", "reset") == 0
        phone.wait(lambda: not heard.stops[-1].engaged, "its release")
    tell("stop", late)
    with by_the_wall(begin_ns):
        assert quantile(late, 0.95) <= 100.0
