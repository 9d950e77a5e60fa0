"""`giraff estop` against a base that is there by itself: nothing is taken for done before base has said so.

With real sessions: tests/functional/cli/test_estop.py.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
import zenoh

from giraff_cli.estop import client
from giraff_cli.estop.client import engage, reset, status
from giraff_core.estop.request import board_note, not_off
from giraff_core.network import NetworkConfig
from giraff_schemas.messages import EStop, RobotTime, Tick
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE, ESTOP_RESET, TICK, alive_key, key_of
from giraff_schemas.trouble import Trouble
from giraff_tools.network.connection import RobotConnection
from tests.support.one_process import Session
from tests.unit.cli.asked import AskedRobot

ROBOT = "sim-estop"
EPOCH = 5
DONE = EStopAnswer(done=True, engaged=True, id=7, instance="b")
LATCHED = EStop(engaged=True, id=7, by="ann@desk", reason=Trouble("smoke"))
RELEASED = EStop(engaged=False, id=7, by="ann@desk")
FULL = msgspec.structs.replace(DONE, done=False, reason=Trouble("disk full"))
REFUSED = EStopAnswer(done=False, engaged=False, id=0, reason=Trouble("no"))
WISH = EStopEngage(by="me", reason=Trouble("a cat"))
SERVICES = (("base", "b"), ("guard", "no-base"))
"""A base, and a service that is none."""

Answer = Callable[[Any], EStopAnswer | None]
"""What base answers to a request; None: nothing, as one that hangs."""


class Network(AskedRobot):
    """One that has bases."""

    def __init__(self) -> None:
        super().__init__(ROBOT, NetworkConfig(connect=("192.168.1.20",), local=True))

    @contextmanager
    def base(
        self, answer: Answer = lambda _: DONE, state: EStop = LATCHED, instance: str = "b", *, ticks: bool = True
    ) -> Iterator[list[tuple[Any, int]]]:
        """Says its clock and its state all the time; what it is asked, and its clock then."""
        asked: list[tuple[Any, int]] = []

        def say(request: Any) -> EStopAnswer | None:
            asked.append((request, self.clock.monotonic_ns()))
            said = answer(request)
            if said is not None and isinstance(request, EStopEngage):
                say_state()  # at once, as base does
            return said

        def say_state() -> None:
            self.put(ESTOP, state, instance)

        def say_tick() -> None:
            self.put(TICK, Tick(epoch=EPOCH, robot_ns=self.clock.monotonic_ns()), instance)

        declared = self.answer((ESTOP_ENGAGE, ESTOP_RESET), say)
        ends = [self.clock.every(1.0 / ESTOP.rate_hz, say_state)]
        ends += [self.clock.every(1.0 / TICK.rate_hz, say_tick)] if ticks else []
        yield asked
        for one in declared:
            one.undeclare()
        for end in ends:
            end()


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    made = Network()
    made.rule(monkeypatch, client)
    monkeypatch.setattr(RobotConnection, "open_other_doors", lambda *_: None)  # test_stopping.py has two
    return made


def test_engaging_is_told_once_base_confirms_it(network: Network, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    monkeypatch.setattr("sys.argv", ["/my clone/giraff", "estop", "engage"])
    with network.base() as asked:
        code, text, *_ = engage(network.connection, "me", "a cat", 10.0)
    release = f"'/my clone/giraff' estop reset --robot {ROBOT} --connect 192.168.1.20"
    assert (code, text) == (0, f"{ROBOT}: STOPPED, latch 7; it stays so until `{release}`")
    assert [request for request, _ in asked] == [EStopEngage(by="me", reason=Trouble("a cat"))]
    assert network.clock.monotonic() < 0.1


def test_engaging_is_repeated_until_somebody_is_there(network: Network) -> None:
    comes = network.base()
    network.clock.after(7.0, comes.__enter__)
    assert engage(network.connection, "me", "", 20.0).code == 0
    assert 7.0 < network.clock.monotonic() < 7.3
    comes.__exit__(None, None, None)


def test_a_stop_that_nobody_confirms_is_no_stop(network: Network) -> None:
    with network.session.declare_token(alive_key("anna", "base", "1")):
        code, text, *_ = engage(network.connection, "me", "", 0.5)
        assert client.hint_of_others(network.connection) == "on the network: --robot anna"
    assert code == 2
    assert text.startswith(f"NOT CONFIRMED after 0.5 s: nobody answered {key_of(ROBOT, ESTOP_ENGAGE)}; use the battery")
    assert network.clock.monotonic() == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(
    ("answer", "code", "told"),
    [
        (None, 2, "NOT CONFIRMED after 1 s: nobody answered"),
        (REFUSED, 2, "answers that it has not stopped: no; use the"),
        (EStopAnswer(done=True, engaged=False, id=0), 2, "NOT CONFIRMED"),
        (FULL, 1, "STOPPED, latch 7, but not for sure"),
        (
            msgspec.structs.replace(DONE, id=8),
            2,
            "an answer says that latch 8 is engaged, but no estop sample of base b",
        ),
        (msgspec.structs.replace(DONE, instance="stranger"), 2, "no estop sample of base stranger says so; use the"),
    ],
)
def test_an_answer_that_is_no_confirmation_is_not_taken_for_one(
    network: Network, answer: EStopAnswer | None, code: int, told: str
) -> None:
    with network.base(lambda _: answer) as asked:
        result = engage(network.connection, "me", "", 1.0)
    assert result.code == code
    assert told in result.text
    assert len(asked) > 1, "asked again and again"


def test_a_base_that_hangs_does_not_hide_the_answer_of_another(network: Network) -> None:
    with network.base(lambda _: None, instance="a") as hanging, network.base():
        assert engage(network.connection, "me", "", 10.0).code == 0
    assert hanging
    assert network.clock.monotonic() < 0.1, "held back until the slower one's time-out"


def test_a_stop_that_one_of_two_bases_confirms_is_none_until_the_other_has_confirmed_or_gone(network: Network) -> None:
    told: list[client.Result] = []
    tokens = [network.session.declare_token(alive_key(ROBOT, service, name)) for service, name in SERVICES]
    with network.base(), tokens[0], tokens[1]:
        with network.session.declare_token(alive_key(ROBOT, "base", "other")):
            told.append(engage(network.connection, "me", "", 1.0))
            client.engage_all(network.connection, WISH, 1.0, (), told.append)
            full = msgspec.structs.replace(FULL, instance="other")
            with network.base(lambda _: full, instance="other"):
                assert engage(network.connection, "me", "", 1.0).code == 1
            with network.base(lambda _: msgspec.structs.replace(DONE, instance="other"), instance="other"):
                assert engage(network.connection, "me", "", 1.0).code == 0
        assert engage(network.connection, "me", "", 1.0).code == 0
    with network.base(lambda _: FULL):
        late = network.session.declare_token(alive_key(ROBOT, "base", "other"))
        network.clock.after(0.5, late.__enter__)
        told.append(engage(network.connection, "me", "", 1.0))
        late.__exit__(None, None, None)
    why = f"NOT CONFIRMED after 1 s: 2 bases are called {ROBOT}; only b confirmed; end all but one (one that has"
    assert [(code, text.removeprefix(f"{ROBOT}: ")[: len(why)]) for code, text, *_ in told] == [(2, why)] * 3


def test_at_several_addresses_each_is_asked_for_itself_whatever_a_page_says(
    network: Network, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One door answers nothing and takes calls, since its process hangs; the page is the other robot's, of one name."""

    class Page(client.OtherWay):
        def stopped(self) -> set[str]:
            return {ROBOT}

    monkeypatch.setattr(client, "find_silent", lambda _: {})
    given = ("192.0.2.1", "192.0.2.2")
    network.connection.network = NetworkConfig(connect=given)
    monkeypatch.setattr(network.connection, "open_other_doors", lambda _: None)
    told: list[client.Result] = []
    assert client.engage_all(network.connection, WISH, 1.0, given, told.append, other=Page()) == 2
    assert "NOTHING IS STOPPED" in told[0].text
    assert ["NOT REACHED" in each.text for each in told[1:]] == [True, True]


def test_of_a_flood_of_names_the_first_are_told_and_those_that_answer_before_the_others(network: Network) -> None:
    told: list[client.Result] = []
    with ExitStack() as declared, network.base(lambda _: REFUSED):
        for name in (ROBOT, *(f"r{number}" for number in range(49))):
            declared.enter_context(network.session.declare_token(alive_key(name, "base", "b")))
        network.connection.robot = ""
        assert client.engage_all(network.connection, WISH, 1.0, (), told.append) == 2
        network.connection.robot = ROBOT
        assert client.hint_of_others(network.connection).endswith("--robot r17 and 39 more")
    assert told[0].text.startswith(f"{ROBOT}: NOT CONFIRMED after 1 s: {key_of(ROBOT, ESTOP_ENGAGE)} answers that")
    assert (len(told), told[-1].text) == (21, "and 30 more: NOT CONFIRMED; use the battery switch")


ODD = "\x1b[2J\udcc3\nfalse: \x9b1m"
"""What a terminal obeys, a byte of another locale, and the end of a line."""


def test_a_name_and_a_reason_stop_no_stop_and_steer_no_terminal(network: Network) -> None:
    odd = msgspec.structs.replace(LATCHED, by="\x1b[2J", reason=Trouble("\x9b1m\nsim-estop: released\u202e"))
    with network.base(state=odd) as asked:
        assert engage(network.connection, ODD, ODD, 10.0).code == 0
        code, text, *_ = status(network.connection, 10.0)
        refused = reset(network.connection, "me", 10.0)
    assert asked[0][0] == EStopEngage(by="?[2J??false: ?1m", reason=Trouble("?[2J??false: ?1m"))
    assert (code, text) == (1, f"{ROBOT}: ENGAGED, latch 7, by ?[2J: ?1m?sim-estop: released?")
    assert refused.text.isprintable()


def test_a_robot_that_may_be_another_is_asked_and_never_called_the_right_one(network: Network) -> None:
    doubt = "whether it is yours is not known: robot.toml cannot be read"
    with network.base(), network.session.declare_token(alive_key(ROBOT, "base", "b")):
        told = [engage(network.connection, "me", "", 10.0, doubt=doubt)]
        assert client.engage_all(network.connection, WISH, 10.0, (), told.append, doubt=doubt) == 2
    assert [each[:2] for each in told] == [(2, f"a robot called {ROBOT} at an unknown host has stopped; {doubt}")] * 2
    with network.base(lambda _: FULL), network.session.declare_token(alive_key(ROBOT, "base", "b")):
        told = [engage(network.connection, "me", "", 1.0, doubt=doubt)]
        assert client.engage_all(network.connection, WISH, 1.0, (), told.append, doubt=doubt) == 2
    assert [each[:2] for each in told] == [(2, f"a robot called {ROBOT} at an unknown host has stopped; {doubt}")] * 2
    nobody = engage(network.connection, "me", "", 1.0, doubt=doubt)
    assert nobody.text.startswith("NOT CONFIRMED after 1 s: nobody answered")


def at_once(_: object, act: Callable[..., Any], *words: Any) -> SimpleNamespace:
    """Act in the thread that submits: real threads know nothing of the simulated clock."""
    result = act(*words)
    return SimpleNamespace(result=lambda: result)


@pytest.mark.parametrize(
    ("doubt", "says"), [("", "STOPPED"), ("whose is it", "a robot called sim-estop at an unknown host has stopped")]
)
def test_each_robot_is_asked_for_itself_whatever_goes_wrong_with_another(
    network: Network, monkeypatch: pytest.MonkeyPatch, doubt: str, says: str
) -> None:
    """And told at once, though another one does not answer."""
    get = network.session.get

    def fails_for_one(key: str, *words: Any, **more: Any) -> Any:
        if "/anna/" in key:
            raise zenoh.ZError("no such key")
        return get(key, *words, **more)

    monkeypatch.setattr(network.session, "get", fails_for_one)
    told: list[client.Result] = []
    told_at: list[float] = []
    monkeypatch.setattr("giraff_cli.estop.client.ThreadPoolExecutor.submit", at_once)

    def tell(result: client.Result) -> None:
        told.append(result)
        told_at.append(network.clock.monotonic())

    alive = [network.session.declare_token(alive_key(name, "base", "b")) for name in ("anna", ROBOT)]
    network.connection.robot = ""
    with network.base(), alive[0], alive[1]:
        assert client.engage_all(network.connection, WISH, 2.0, (), tell, doubt=doubt) == 2
    assert says in told[0].text
    assert told_at[0] < 0.5
    assert told[1].text.startswith("anna: NOT CONFIRMED after 2 s: giraff/anna/estop/engage: no such key")


@pytest.mark.parametrize("unheard", [0.0, 0.3])
@pytest.mark.parametrize("tells", [True, False])
def test_off_is_told_where_base_tells_it_and_hears_its_board(network: Network, tells: bool, unheard: float) -> None:
    note = board_note(unheard)
    answer, is_off = msgspec.structs.replace(DONE, unheard_stops_s=unheard), tells and not unheard
    alive = network.session.declare_token(alive_key(ROBOT, "base", "b"))
    with network.base(lambda _: answer, msgspec.structs.replace(LATCHED, off=tells)) as asked, alive:
        told = [engage(network.connection, "me", "a cat", 10.0, off=True)]
        client.engage_all(network.connection, msgspec.structs.replace(WISH, off=True), 2.0, (), told.append)
        assert status(network.connection, 1.0).text.startswith(f"{ROBOT}: {'OFF' if tells else 'ENGAGED'}, latch 7")
    assert all(request.off for request, _ in asked)
    assert [each[:1] + each[2:] for each in told] == [(0 if is_off else 1, ROBOT, True, is_off, 7, None, None)] * 2
    assert told[0].text.startswith(f"{ROBOT}: {'OFF' if is_off else not_off(note)}, latch 7{note}; it stays so until")


@pytest.mark.parametrize("name", [ROBOT, ""])
@pytest.mark.parametrize(("answers", "code"), [(True, 0), (False, 2)])
def test_robots_of_one_name_behind_two_doors_are_both_asked(
    network: Network, monkeypatch: pytest.MonkeyPatch, answers: bool, code: int, name: str
) -> None:
    other = Network()
    other.clock, other.session = network.clock, Session(network.clock)
    monkeypatch.setattr(RobotConnection, "open_other_doors", lambda _, on_door: on_door(other.session))
    told: list[client.Result] = []
    alive = [each.session.declare_token(alive_key(ROBOT, "base", "b")) for each in (network, other)]
    with network.base(), other.base(lambda _: DONE if answers else None) as asked, alive[0], alive[1]:
        network.connection.robot = name
        assert client.engage_all(network.connection, WISH, 2.0, (), told.append) == code
    assert asked
    assert [result.code for result in told] == ([0] if answers else [0, 2])


def cleared(request: Any) -> EStopAnswer:
    return EStopAnswer(done=True, engaged=False, id=request.id)


def test_a_reset_names_the_latch_it_clears_and_carries_a_fresh_tick(network: Network) -> None:
    with network.base(cleared) as asked:
        code, text, *_ = reset(network.connection, "me", 10.0)
    assert code == 0
    assert text.startswith(f"cleared latch 7 of {ROBOT}, engaged by ann@desk: smoke")
    assert "hold the hand level until it is armed" in text
    request, when_ns = asked[0]
    assert isinstance(request, EStopReset)
    assert (request.id, request.by) == (7, "me")
    assert isinstance(request.tick, RobotTime)
    assert request.tick.epoch == EPOCH
    assert 0 <= when_ns - request.tick.robot_ns < 30_000_000


def test_a_reset_of_off_says_that_the_robot_must_be_held(network: Network) -> None:
    with network.base(cleared, msgspec.structs.replace(LATCHED, off=True)):
        assert "it is off, so hold it upright and still; to drive" in reset(network.connection, "me", 10.0).text


@pytest.mark.parametrize("engaged", [True, False])
def test_a_reset_that_base_refuses_is_told_with_its_reason(network: Network, engaged: bool) -> None:
    with network.base(lambda _: EStopAnswer(done=False, engaged=engaged, id=9, reason=Trouble("another latch"))):
        code, text, *_ = reset(network.connection, "me", 10.0)
    assert (code, text) == (1, f"STILL ENGAGED, latch 7 of {ROBOT}, engaged by ann@desk: smoke: another latch")


def test_a_reset_without_an_answer_is_not_taken_for_one(network: Network) -> None:
    with network.base(lambda _: None):
        code, text, *_ = reset(network.connection, "me", 2.0)
    assert (code, text[:32]) == (2, "NOT CONFIRMED after 2 s, latch 7")
    assert network.clock.monotonic() == pytest.approx(2.0, abs=0.02)


def test_without_the_robots_clock_nothing_is_reset(network: Network) -> None:
    with network.base(cleared, ticks=False) as asked:
        code, text, *_ = reset(network.connection, "me", 2.0)
    assert (code, asked) == (2, [])
    assert "the robot's clock is not heard" in text


def test_what_is_released_is_not_reset(network: Network) -> None:
    with network.base(cleared, RELEASED) as asked:
        code, text, *_ = reset(network.connection, "me", 10.0)
    assert (code, asked) == (0, [])
    assert "not engaged, nothing to clear" in text


def test_of_two_bases_none_is_reset_and_the_engaged_one_shows(network: Network) -> None:
    with network.base(cleared) as one, network.base(cleared, RELEASED, "c") as two:
        code, text, *_ = status(network.connection, 10.0)
        assert f"{ROBOT}: ENGAGED, latch 7, by ann@desk: smoke" in text
        assert (code, "2 bases are called" in text) == (1, True)
        code, text, *_ = reset(network.connection, "me", 5.0)
        assert (code, one, two) == (2, [], [])
        assert "end all but one" in text


def test_the_status_is_base_s_own_word(network: Network) -> None:
    with network.base(state=RELEASED):
        told = f"{ROBOT}: released, latch 7, by ann@desk"
        assert status(network.connection, 10.0) == (0, told, ROBOT, False, False, 7, "ann@desk", "")


def test_silence_is_no_status(network: Network) -> None:
    for told in (status(network.connection, 0.3), reset(network.connection, "me", 0.3)):
        assert told.code == 2
        assert told.text.startswith(f"UNKNOWN: nothing is heard on {key_of(ROBOT, ESTOP)} after 0.3 s")


def test_a_stop_of_all_is_not_done_where_an_address_does_not_answer_though_others_are_stopped(
    network: Network, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[client.Result] = []
    monkeypatch.setattr(client, "_engage_heard", lambda *_: client.RELEASED)
    monkeypatch.setattr(client, "find_silent", lambda addresses: dict.fromkeys(addresses, "No route to host"))
    for addresses, code in (((), 0), (("192.168.1.9",), 2)):
        assert client.engage_all(network.connection, WISH, 10.0, addresses, told.append) == code
    assert [result.text for result in told] == [
        "--connect 192.168.1.9: No route to host; NOT REACHED: a robot there was NOT STOPPED, use its battery switch"
    ]
