"""The space bar, and the keys r and y, of a keyboard beside others who stop the robot, with the services themselves."""

import pytest

from giraff_core.io import Inbox, PendingQuery
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.service import Keyboard
from giraff_schemas.requests import EStopAnswer, EStopEngage
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE
from giraff_sim.hosts.network import Member, Message, Subscription
from giraff_sim.hosts.process import Process
from tests.loop.loops import closed_loop
from tests.loop.operators import Scene, scene
from tests.loop.people import Desk
from tests.sim.robots import proving_room
from tests.support.robots import ROBOT


def asks(it: Scene) -> None:
    """Stop it, and press r."""
    it.engage()
    it.run(0.4)
    it.type(b"r")
    it.run(1.0)


def deafen(it: Scene, key: str) -> None:
    """Carry nothing of this key to the keyboard any more."""
    network = it.loop.network
    carry = network.carry

    def carry_others(sender: Member, taker: Subscription, message: Message) -> None:
        if (taker.process, message.key) != (it.loop.processes["keyboard"], key):
            carry(sender, taker, message)

    network.carry = carry_others  # type: ignore[method-assign]  # of this run alone


def test_y_releases_the_stop_that_was_shown_and_moves_nothing() -> None:
    with scene() as it:
        asks(it)
        stopped = it.now
        it.type(b"y")
        it.run(1.0)
        assert not it.loop.newest["estop"].engaged
        assert it.driven_ms(stopped) == 0


@pytest.mark.parametrize(("late", "is_heard"), [(0.004, True), (0.3, True), (0.9, False)])
def test_a_stop_that_is_asked_for_between_r_and_y_is_not_released(late: float, is_heard: bool) -> None:
    """By the same hand for the same reason, so that it is the same latch; base's word of it may be lost."""
    with scene() as it:
        asks(it)
        latch = it.loop.newest["estop"].id
        if not is_heard:
            deafen(it, ESTOP.key)
        it.engage()
        it.run(late)
        it.type(b"y")
        it.run(1.0)
        assert (it.loop.newest["estop"].engaged, it.loop.newest["estop"].id) == (True, latch)


class Stranger:
    """It answers each stop as if it were base."""

    link = None
    timers = ()

    def __init__(self, process: Process) -> None:
        self._asked: Inbox[PendingQuery[EStopEngage, EStopAnswer]] = process.requests(ESTOP_ENGAGE)

    def turn(self, now: float) -> None:
        del now
        for asked in self._asked.pop_all():
            asked.answer(EStopAnswer(done=True, engaged=True, id=1, instance="stranger"))

    def end(self) -> None:
        """Nothing is left to say."""


class AfterTheEnd:
    """A keyboard after its last turn, whose stop is still asked for."""

    link = None
    timers = ()

    def __init__(self, keyboard: Keyboard) -> None:
        self._keyboard = keyboard

    def turn(self, now: float) -> None:
        self._keyboard.ask_on(now)

    def end(self) -> None:
        """Nothing is left to say."""


def test_only_base_confirms_a_stop_and_does_so_within_a_tenth_of_a_second_again_and_again() -> None:
    desk, made = Desk(), list[Keyboard]()

    def keyboard(process: Process) -> Keyboard:
        made.append(Keyboard(process, KeyboardConfig(), ROBOT, desk))
        return made[0]

    with closed_loop(proving_room()) as loop:
        loop.launch("stranger", Stranger, loop.hosts["robot"])
        loop.launch("keyboard", keyboard, loop.hosts["operator"])
        loop.run(0.2)
        for _ in range(3):  # base told its state when it engaged, and is to tell it again when it is asked again
            desk.typed += b" "
            loop.processes["keyboard"].wake()
            loop.run(0.1)
            assert made[0].stopping.outcome.what.startswith("STOPPED")
        loop.processes["keyboard"].run(AfterTheEnd(made[0]))
        for words in ("STOPPED", "STOPPING, NOT CONFIRMED"):
            made[0].stopping.engage()
            loop.run(0.3)
            assert made[0].stopping.outcome.what.startswith(words)
            if words == "STOPPED":
                loop.kill("base")
        assert made[0].stopping.outcome.what.endswith("no estop sample of base stranger says so")
