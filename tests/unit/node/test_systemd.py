"""What systemd is told: ready once, its watchdog only by a loop that turns, and nothing that stops the service."""

import os
import secrets
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_node.process.systemd import Notifier
from giraff_schemas.trouble import NO_TROUBLE
from tests.support.manager import FakeManager


@pytest.fixture(params=["path", "abstract"])
def manager(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[FakeManager]:
    abstract = f"@giraff-{secrets.token_hex(8)}"
    fake = FakeManager(abstract if request.param == "abstract" else str(tmp_path / "notify"))
    yield fake
    fake.close()


def test_ready_once_and_each_status_once(manager: FakeManager) -> None:
    notifier = Notifier(manager.environment)
    assert manager.heard() == []
    notifier.turn(0.0, "well")
    assert manager.heard() == ["READY=1", "STATUS=well"]
    notifier.turn(0.1, "well")
    assert manager.heard() == []
    notifier.turn(0.2, "/dev/x: unplugged")
    notifier.turn(0.3, "well")
    assert manager.heard() == ["STATUS=/dev/x: unplugged", "STATUS=well"]
    notifier.stopping()
    assert manager.heard() == ["STOPPING=1"]
    assert notifier.problem == NO_TROUBLE


def test_a_sign_of_life_at_half_the_watchdogs_time_and_by_turns_only(manager: FakeManager) -> None:
    notifier = Notifier(manager.environment | {"WATCHDOG_USEC": "3000000", "WATCHDOG_PID": str(os.getpid())})
    signs = []
    for turn in range(60):  # 6 s
        notifier.turn(turn * 0.1, "well")
        signs += [turn * 0.1 for word in manager.heard() if word == "WATCHDOG=1"]
    assert signs == pytest.approx([0.0, 1.5, 3.0, 4.5])


@pytest.mark.parametrize(
    "variables",
    [
        {},
        {"WATCHDOG_USEC": "0"},
        {"WATCHDOG_USEC": "soon"},
        {"WATCHDOG_USEC": "-5"},
        {"WATCHDOG_USEC": "1000000", "WATCHDOG_PID": "1"},
    ],
)
def test_no_sign_where_none_is_awaited_of_this_process(manager: FakeManager, variables: dict[str, str]) -> None:
    notifier = Notifier(manager.environment | variables)
    for turn in range(30):
        notifier.turn(float(turn), "well")
    assert "WATCHDOG=1" not in manager.heard()


def test_a_status_is_one_line_of_bounded_length(manager: FakeManager) -> None:
    notifier = Notifier(manager.environment)
    notifier.turn(0.0, "a\nREADY=0\nb\udcff" + "c" * 100_000)
    ready, status = manager.heard()
    assert ready == "READY=1"
    assert status.startswith("STATUS=a READY=0 b?c")
    assert len(status) < 2000


def test_nothing_is_said_where_nobody_listens() -> None:
    notifier = Notifier({})
    notifier.turn(0.0, "well")
    notifier.stopping()
    assert notifier.problem == NO_TROUBLE


@pytest.mark.parametrize("address", ["/nowhere/notify", "relative", "vsock:2:1234", "/" + "x" * 200, "@" + "x" * 200])
def test_an_address_that_cannot_be_is_a_problem_with_the_way_out(address: str) -> None:
    notifier = Notifier({"NOTIFY_SOCKET": address, "WATCHDOG_USEC": "1000000"})
    notifier.turn(0.0, "well")
    notifier.stopping()
    assert f"NOTIFY_SOCKET={address}" in str(notifier.problem)
    assert "unset" in str(notifier.problem)


def test_what_was_not_taken_is_said_again(tmp_path: Path) -> None:
    address = str(tmp_path / "notify")
    notifier = Notifier({"NOTIFY_SOCKET": address})
    notifier.turn(0.0, "well")
    assert notifier.problem
    manager = FakeManager(address)
    notifier.turn(0.1, "well")
    assert manager.heard() == ["READY=1", "STATUS=well"]
    assert notifier.problem == NO_TROUBLE
    # A full queue holds nobody up, and what it did not take comes later.
    number = 0
    while number < 10_000:
        number += 1
        notifier.turn(1.0, f"state {number}")
    told = manager.heard()
    assert len(told) < number
    notifier.turn(2.0, f"state {number}")
    assert manager.heard() == [f"STATUS=state {number}"]
    manager.close()
