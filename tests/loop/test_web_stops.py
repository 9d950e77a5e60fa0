"""What ends a page's hand stops the robot within the bound of a lost operator, in simulated time: the motors' record
is the judge. And nothing of it goes on by itself."""

from collections.abc import Callable
from typing import Final

import pytest

from giraff_web.messages import Input
from tests.loop.browsers import Browser, Room, room

OPERATORS: Final = 0.45
"""s to PWM 0, as `tests/timing/faults.py` has it."""
AT_ONCE: Final = 0.15
"""s, of what the page itself still says."""

Fault = Callable[[Room, Browser], object]


def hang(_: Room, browser: Browser) -> None:
    browser.hung = True


def cut(it: Room, _: Browser) -> None:
    for link in it.links:
        link.cut = "holds"


FAULTS: Final[dict[str, tuple[float, Fault]]] = {
    "finger up": (AT_ONCE, lambda _, browser: browser.let_go()),
    "tab hidden": (AT_ONCE, lambda _, browser: browser.let_go("hidden")),
    "page closed": (AT_ONCE, lambda _, browser: browser.let_go("left")),
    "connection ended": (AT_ONCE, lambda it, browser: it.browsers.drop(browser)),
    "page hangs, or its network is cut": (OPERATORS, hang),
    "link between web service and robot cut": (OPERATORS, cut),
    "web service killed": (OPERATORS, lambda it, _: it.loop.kill("web")),
    "web service ended": (AT_ONCE, lambda it, _: it.loop.terminate("web")),
}


@pytest.mark.parametrize(
    ("name", "how"),
    [*((name, "pad") for name in FAULTS), ("finger up", "tilt"), ("page hangs, or its network is cut", "tilt")],
)
def test_what_ends_a_hand_stops_the_robot_within_its_bound(name: str, how: Input) -> None:
    bound, fault = FAULTS[name]
    with room() as it:
        browser = it.browsers.add()
        browser.input = how
        it.drive(browser)
        since = it.now
        fault(it, browser)
        it.run(0.7)
        assert it.last_driven(since) <= bound
        assert it.driven_ms(since + bound) == 0


@pytest.mark.parametrize("how", ["pad", "tilt"])
def test_a_page_that_hung_drives_again_only_with_another_touch(how: Input) -> None:
    with room() as it:
        browser = it.browsers.add()
        browser.input = how
        it.drive(browser)
        browser.hung = True
        it.run(0.8)
        browser.hung = False
        since = it.now
        it.run(1.2)
        assert it.driven_ms(since) == 0, "the finger was not lifted"
        assert "let go" in browser.refusals[-1].remedy
        browser.let_go()
        browser.tilted = (0.0, 0.0)
        it.drive(browser)


@pytest.mark.parametrize("how", ["pad", "tilt"])
def test_a_hang_that_hands_over_all_at_once_drives_not_a_moment(how: Input) -> None:
    """What a page made while its network stood comes with ticks of then."""
    with room() as it:
        browser = it.browsers.add()
        browser.input = how
        it.drive(browser)
        since = it.now
        it.loop.processes["web"].paused = True
        it.run(0.8)
        it.loop.processes["web"].paused = False
        it.loop.processes["web"].go_on()
        it.run(0.7)
        assert it.last_driven(since) <= OPERATORS
        assert it.driven_ms(since + OPERATORS) == 0


def test_what_was_recorded_and_comes_again_moves_nothing() -> None:
    with room() as it:
        browser = it.browsers.add()
        it.drive(browser)
        browser.let_go()
        it.run(0.5)
        recorded = [said for said in browser.said if said.message.__class__.__name__ == "PageWish"]
        since = it.now
        for said in recorded[-60:]:
            browser.push(said)
        it.run(0.5)
        again = it.browsers.add("thief")
        for said in recorded[-60:]:
            again.push(said._replace(page=again.number))
        it.run(1.0)
        assert it.driven_ms(since) == 0


def test_nothing_moves_by_a_page_without_a_token() -> None:
    with room() as it:
        browser = it.browsers.add(may_drive=False)
        browser.touch()
        it.run(0.5)
        it.go(browser)
        it.run(1.0)
        assert it.driver == ""
        assert it.driven_ms(0.0) == 0


def test_two_pages_do_not_drive_at_once_and_each_arms_for_itself() -> None:
    with room() as it:
        one, two = it.browsers.add("phone"), it.browsers.add("laptop")
        it.drive(one)
        two.touch()
        it.run(0.2)
        two.asks = (-1.0, 0.0)
        it.run(0.5)
        assert it.loop.newest["cmd_vel/web"].linear_x > 0.0
        assert "phone drives" in two.refusals[-1].what
        one.let_go()
        it.run(0.5)
        since = it.now
        it.run(1.0)
        assert it.driven_ms(since) == 0, "a hold that was refused never counts"
        two.let_go()
        it.run(0.3)
        assert it.armed, "by the hand before: it does not stand for the next one's"
        two.touch()
        it.run(0.05)
        it.go(two)
        since = it.now
        it.run(0.8)
        assert (it.driven_ms(since), it.armed) == (0, False), "this hand was not neutral yet"
        two.asks = (0.0, 0.0)
        it.run(0.4)
        it.go(two)
        it.run(0.5)
        assert it.driven_ms(it.now - 0.1) > 90
        assert two.state is not None
        assert (two.state.operator, two.state.device, two.state.page) == ("web", "laptop", two.number)


def test_a_touch_that_begins_off_the_middle_does_not_count() -> None:
    with room() as it:
        browser = it.browsers.add()
        it.run(0.3)
        browser.touch()
        browser.asks = (1.0, 0.0)
        it.run(1.2)
        assert it.driven_ms(0.0) == 0
        assert browser.refusals[-1]


def test_a_stop_holds_until_it_is_released_and_its_release_moves_nothing() -> None:
    with room() as it:
        browser = it.browsers.add()
        it.drive(browser)
        since = it.now
        browser.stop()
        it.run(0.6)
        assert it.is_stopped()
        assert it.last_driven(since) <= AT_ONCE
        assert browser.state is not None
        assert browser.state.stop is not None
        assert browser.state.stop.engaged
        assert it.browsers.confirmed[0].engaged
        browser.release()
        it.run(1.2)
        assert not it.is_stopped()
        browser.asks = (0.0, 0.0)
        it.run(1.0)
        it.go(browser)
        it.run(1.0)
        assert it.driven_ms(since + AT_ONCE) == 0, "the finger was not lifted"
        assert [line for line in it.log if "emergency stop" in line] == [
            "phone asks for the emergency stop",
            "phone asks for the release of the emergency stop",
            "the emergency stop is released",
        ]
        browser.let_go()
        it.drive(browser)


def test_a_page_without_a_token_stops_and_does_not_release() -> None:
    with room() as it:
        browser = it.browsers.add(may_drive=False)
        it.run(0.3)
        browser.stop()
        it.run(0.5)
        assert it.is_stopped()
        browser.release()
        it.run(1.0)
        assert it.is_stopped()
