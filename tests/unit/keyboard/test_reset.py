"""The keys r and y: the stop that is shown is released once it was asked for twice, and no stray key releases it."""

import pytest

from giraff_keyboard.keys import KeyReader
from giraff_keyboard.policy import Key
from giraff_keyboard.reset_request import ASKS_FOR, READ_FIRST, ResetRequest
from giraff_schemas.actions import KEYS
from giraff_schemas.messages import EStop, RobotTime
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from tests.unit.keyboard.keyboards import EPOCH, person

RELEASED = EStopAnswer(done=True, engaged=False, id=4)


def stop(
    latch: int = 4, *, engaged: bool = True, base: str = "b", by: str = "carer@tablet", engaged_ns: int = 7
) -> EStop:
    return EStop(engaged=engaged, id=latch, by=by, reason=Trouble("child"), instance=base, engaged_ns=engaged_ns)


class Base:
    """Tells of an engaged stop twice a second, and answers what it is told to."""

    def __init__(self) -> None:
        self.now = 50.0
        self.states = [stop()]
        self.asked: list[tuple[EStop, RobotTime]] = []
        self.attempts = 0
        self.fault = ""
        self.refusal: EStopAnswer | None = None
        self.answer: EStopAnswer | None = None
        self.is_lost = self.is_stopping = False
        self.keys = ResetRequest(self.ask)
        self.wait(0.1)

    def ask(self, latch: EStop, moment: RobotTime) -> "Base":
        self.asked.append((latch, moment))
        return self

    def poll(self, now: float) -> EStopAnswer | None:
        del now
        self.attempts += 1
        return self.answer

    @property
    def moment(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=round(self.now * 1e9))

    def wait(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.1)):
            self.now += 0.1
            for state in self.states:
                self.keys.on_sample(state, self.now)
            self.keys.poll(self.now)

    def press(self, *keys: Key, gap: float = 0.0) -> str:
        for key in keys:
            moment = None if self.is_lost else self.moment
            self.keys.on_key(key, moment, self.now, stopping=self.is_stopping)
            self.wait(gap)
        return self.keys.outcome.line(KEYS)


@pytest.fixture
def base() -> Base:
    return Base()


def test_r_asks_and_y_releases_the_latch_that_is_shown_with_the_robots_time_of_the_y(base: Base) -> None:
    assert base.press(Key.RESET) == "RELEASE? y: yes, any other key: no. It is the stop by carer@tablet: child"
    base.wait(1.0)
    assert base.press(Key.YES) == "RELEASING, not confirmed yet"
    assert base.asked == [(stop(), base.moment)]
    base.wait(0.3)
    base.answer = RELEASED
    base.wait(0.1)
    assert base.keys.outcome == NO_TROUBLE
    attempts = base.attempts
    base.wait(1.0)
    assert base.attempts == attempts


@pytest.mark.parametrize("key", [key for key in Key if key is not Key.YES])
def test_no_other_key_releases_and_each_ends_the_question(base: Base, key: Key) -> None:
    base.press(Key.RESET)
    base.wait(1.0)
    base.press(key)
    base.wait(0.1)
    base.press(Key.YES)
    assert base.asked == []


def test_a_key_that_is_held_releases_nothing() -> None:
    for key in (Key.RESET, Key.YES):
        base = Base()
        base.press(*[key] * 60, gap=0.1)
        assert base.asked == []


def test_words_that_are_typed_release_nothing() -> None:
    reader, base = KeyReader(), Base()
    for step, letter in enumerate(b"try very hard, every library: r y ry"):
        for key in reader.feed(bytes((letter,)), step * 0.15):
            base.press(key)
        base.now += 0.15
    assert base.asked == []


def test_a_yes_counts_once_one_has_read_and_while_the_question_stands() -> None:
    for wait, asked in ((READ_FIRST - 0.1, 0), (READ_FIRST + 0.1, 1), (ASKS_FOR - 0.1, 1), (ASKS_FOR + 0.2, 0)):
        base = Base()
        base.press(Key.RESET)
        base.wait(wait)
        base.press(Key.YES)
        assert len(base.asked) == asked, wait


def test_a_question_that_nobody_answers_goes(base: Base) -> None:
    base.press(Key.RESET)
    base.wait(ASKS_FOR + 0.2)
    assert base.keys.outcome == NO_TROUBLE


@pytest.mark.parametrize(
    ("meanwhile", "says"),
    [
        ([stop(5, by="another")], "another stop"),
        ([stop(engaged_ns=8)], "another stop"),
        ([stop(4, base="restarted")], "2 bases"),
        ([stop(engaged=False)], "not engaged"),
    ],
)
def test_what_has_changed_since_it_was_shown_is_not_released(base: Base, meanwhile: list[EStop], says: str) -> None:
    base.press(Key.RESET)
    base.states = meanwhile
    base.wait(0.7)
    assert says in base.press(Key.YES)
    assert base.asked == []


def test_nothing_is_released_of_a_robot_that_is_not_heard(base: Base) -> None:
    base.press(Key.RESET)
    base.wait(1.0)
    base.is_lost = True
    assert "not heard" in base.press(Key.YES)
    base.states = []
    base.wait(2.0)
    assert "base is not heard" in base.press(Key.RESET)
    assert base.asked == []


def test_nothing_is_released_while_a_stop_is_asked_for_and_a_stop_ends_a_release(base: Base) -> None:
    base.is_stopping = True
    assert base.press(Key.RESET) == ""
    base.is_stopping = False
    base.press(Key.RESET)
    base.wait(1.0)
    base.press(Key.YES)
    base.press(Key.STOP)
    attempts = base.attempts
    base.wait(1.0)
    assert base.attempts == attempts


def test_a_release_that_is_refused_or_unanswered_says_so_and_is_not_asked_for_ever(base: Base) -> None:
    base.press(Key.RESET)
    base.wait(1.0)
    base.press(Key.YES)
    base.fault = "estop/reset: nobody there"
    base.wait(3.0)
    assert str(base.keys.outcome) == "RELEASE NOT CONFIRMED: estop/reset: nobody there; ask again"
    base.press(Key.RESET)
    base.wait(1.0)
    base.answer = EStopAnswer(done=False, engaged=True, id=5, reason=Trouble("latch 4 is not the one engaged"))
    base.press(Key.YES)
    base.wait(0.1)
    assert str(base.keys.outcome) == "STILL STOPPED: latch 4 is not the one engaged"


@pytest.mark.parametrize(
    "pieces",
    [
        (b"\x1b[200~", b"r", b"y", b"\x1b[201~"),
        (b"\x1b[200~r", b"y\x1b[201~"),
        (b"\x1b", b"r", b"y"),
        (b"r", b"\x1b", b"y"),
        (b"r", b"\x1b[", b"y"),
        (b"\x1b[1;5r", b"y"),
        (b"r", b"\x1by"),
        (b"r", b"y\n"),
        (b"r\n", b"y"),
        (b"R", b"y"),
        (b"r", b"Y"),
    ],
)
def test_no_paste_and_no_torn_escape_releases_anything_however_slowly_it_comes(pieces: tuple[bytes, ...]) -> None:
    base, reader = Base(), KeyReader()
    for piece in pieces:
        for data in (*[b""] * 10, piece):
            base.wait(0.1)
            for key in reader.feed(data, base.now):
                base.press(key)
    assert base.asked == []


def test_no_keyboard_that_a_base_comes_back_to_moves_it_without_a_new_press() -> None:
    someone = person()
    someone.hear("me", 3)
    someone.press(Key.FORWARD)
    someone.wait(0.2)
    someone.wait(2.0, ticks=False)
    someone.robot_ns = 1_000_000  # base was started anew
    assert all(command.neutral for command in someone.wait(3.0))
    assert someone.policy.moment(someone.now) is not None
