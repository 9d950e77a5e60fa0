"""`giraff estop` against a base made of Python: nothing is taken for done before base has said so."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from giraff_cli.estop import engage, reset, status
from giraff_cli.watcher import Watcher, free_port
from giraff_node.session import NetworkConfig, close_session, open_session
from giraff_schemas.messages import EStop, EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE, key_of
from tests.unit.cli.bases import EPOCH, ROBOT, base


@pytest.fixture
def network() -> Iterator[NetworkConfig]:
    """Of a process that stays, and at whose rendezvous the others meet."""
    made = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
    staying = open_session(made, ROBOT)
    yield made
    assert close_session(staying)


@pytest.fixture
def watcher(network: NetworkConfig) -> Iterator[Watcher]:
    made = Watcher(ROBOT, open_session(network, ROBOT, visiting=True))
    yield made
    assert made.close()


def test_engaging_is_told_once_base_confirms_it(network: NetworkConfig, watcher: Watcher) -> None:
    with base(network) as robot:
        code, text = engage(watcher, "me", "a cat", 10.0)
    assert (code, text) == (0, f"{ROBOT}: STOPPED, latch 8; it stays so until `giraff estop reset`")
    assert robot.asked[0][0] == EStopEngage(by="me", reason="a cat")


def test_engaging_is_repeated_until_somebody_is_there(network: NetworkConfig, watcher: Watcher) -> None:
    told: list[int] = []
    engaging = threading.Thread(target=lambda: told.append(engage(watcher, "me", "", 20.0).code))
    engaging.start()
    time.sleep(0.5)
    with base(network):
        engaging.join()
    assert told == [0]


def test_a_stop_that_nobody_confirms_is_no_stop(watcher: Watcher) -> None:
    began = time.monotonic()
    code, text = engage(watcher, "me", "", 0.5)
    assert code == 2
    assert text.startswith(f"NOT CONFIRMED after 0.5 s: nobody answered {key_of(ROBOT, ESTOP_ENGAGE)}; use the battery")
    assert 0.5 <= time.monotonic() - began < 3.0


@pytest.mark.parametrize(
    ("answer", "code", "told"),
    [
        (None, 2, "NOT CONFIRMED after 1 s: nobody answered"),
        (EStopAnswer(done=False, engaged=False, id=0, reason="no"), 2, "answers that it has not stopped: no; use the"),
        (EStopAnswer(done=True, engaged=False, id=0, reason=""), 2, "NOT CONFIRMED"),
        (EStopAnswer(done=False, engaged=True, id=8, reason="disk full"), 1, "STOPPED, latch 8, but not for sure"),
    ],
)
def test_an_answer_that_is_no_confirmation_is_not_taken_for_one(
    network: NetworkConfig, watcher: Watcher, answer: EStopAnswer | None, code: int, told: str
) -> None:
    with base(network, lambda _: answer) as robot:
        result = engage(watcher, "me", "", 1.0)
    assert result.code == code
    assert told in result.text
    assert len(robot.asked) > 1, "asked again and again"


def test_a_base_that_hangs_does_not_hide_the_answer_of_another(network: NetworkConfig, watcher: Watcher) -> None:
    release = threading.Event()

    def hang(_: Any) -> None:
        release.wait(20.0)

    with base(network, hang, instance="a") as hanging, base(network):
        took = 0.0
        while not hanging.asked:  # until both are met
            began = time.monotonic()
            assert engage(watcher, "me", "", 10.0).code == 0
            took = time.monotonic() - began
        release.set()
    assert took < 1.5, "held back until the slower one's time-out"


def cleared(request: Any) -> EStopAnswer:
    return EStopAnswer(done=True, engaged=False, id=request.id, reason="")


def test_a_reset_names_the_latch_it_clears_and_carries_a_fresh_tick(network: NetworkConfig, watcher: Watcher) -> None:
    with base(network, cleared) as robot:
        code, text = reset(watcher, "me", 10.0)
    assert code == 0
    assert text.startswith(f"cleared latch 7 of {ROBOT}, engaged by ann@desk: smoke")
    assert "hold the hand level until it is armed" in text
    request, when = robot.asked[0]
    assert isinstance(request, EStopReset)
    assert (request.id, request.by) == (7, "me")
    assert request.tick is not None
    assert request.tick.epoch == EPOCH
    assert 0.0 <= (when.robot_ns - request.tick.robot_ns) * 1e-9 < 0.3


@pytest.mark.parametrize("engaged", [True, False])
def test_a_reset_that_base_refuses_is_told_with_its_reason(
    network: NetworkConfig, watcher: Watcher, engaged: bool
) -> None:
    with base(network, lambda _: EStopAnswer(done=False, engaged=engaged, id=9, reason="another latch")):
        code, text = reset(watcher, "me", 10.0)
    assert (code, text) == (1, f"STILL ENGAGED, latch 7 of {ROBOT}, engaged by ann@desk: smoke: another latch")


def test_a_reset_without_an_answer_is_not_taken_for_one(network: NetworkConfig, watcher: Watcher) -> None:
    with base(network, lambda _: None):
        code, text = reset(watcher, "me", 2.0)
    assert code == 2
    assert text.startswith("NOT CONFIRMED after 2 s, latch 7")


def test_without_the_robots_clock_nothing_is_reset(network: NetworkConfig, watcher: Watcher) -> None:
    with base(network, cleared) as robot:
        robot.ticks = False
        time.sleep(0.1)
        code, text = reset(watcher, "me", 2.0)
        assert robot.asked == []
    assert code == 2
    assert "the robot's clock is not heard" in text


def test_what_is_released_is_not_reset(network: NetworkConfig, watcher: Watcher) -> None:
    with base(network, cleared, EStop(engaged=False, id=7, by="ann@desk", reason="")) as robot:
        code, text = reset(watcher, "me", 10.0)
    assert (code, robot.asked) == (0, [])
    assert "not engaged, nothing to clear" in text


def test_of_two_bases_none_is_reset_and_the_engaged_one_shows(network: NetworkConfig, watcher: Watcher) -> None:
    released = EStop(engaged=False, id=1, by="", reason="")
    with base(network, cleared) as one, base(network, cleared, released, "c") as two:
        code, text = status(watcher, 10.0)
        assert code == 1
        assert f"{ROBOT}: ENGAGED, latch 7, by ann@desk: smoke" in text
        assert "2 bases are called" in text
        code, text = reset(watcher, "me", 5.0)
        assert (code, one.asked, two.asked) == (2, [], [])
        assert "end all but one" in text


def test_the_status_is_base_s_own_word(network: NetworkConfig, watcher: Watcher) -> None:
    with base(network, state=EStop(engaged=False, id=7, by="me", reason="")):
        assert status(watcher, 10.0) == (0, f"{ROBOT}: released, latch 7, by me: ")


def test_silence_is_no_status(watcher: Watcher) -> None:
    for told in (status(watcher, 0.3), reset(watcher, "me", 0.3)):
        assert told.code == 2
        assert told.text.startswith(f"UNKNOWN: nothing is heard on {key_of(ROBOT, ESTOP)} after 0.3 s")
