"""A service as healthchecks and systemd see it: by its own loop, so that one that hangs looks hung."""

from __future__ import annotations

import signal
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import psutil
import pytest

from giraff_health.ask import ask
from giraff_node.health import Condition
from giraff_node.logs import service_logger
from giraff_schemas.codec import encode
from giraff_schemas.messages import EStopEngage, Health
from giraff_schemas.topics import ESTOP_ENGAGE, key_of
from tests.support.waiting import wait
from tests.unit.health.answering import check
from tests.unit.node.manager import FakeManager
from tests.unit.node.peers import ROBOT, Peers


@pytest.fixture
def peers(tmp_path: Path) -> Iterator[Peers]:
    started = Peers(tmp_path)
    yield started
    started.close()


@pytest.fixture
def manager(tmp_path: Path) -> Iterator[FakeManager]:
    fake = FakeManager(str(tmp_path / "notify"))
    yield fake
    fake.close()


def sleep(peers: Peers, seconds: float) -> None:
    """Let the service's loop hang for a while."""
    request = encode(EStopEngage(by="test", reason=str(seconds)))
    querier: Any = peers.session.declare_querier(key_of(ROBOT, ESTOP_ENGAGE), timeout=0.1)  # its stubs are wrong
    wait(lambda: bool(querier.matching_status.matching))  # before they have met, a question reaches nobody
    querier.get(lambda _reply: None, payload=request)


def test_a_condition_is_its_own_faults_and_what_it_notices() -> None:
    condition = Condition("base", "1", service_logger("base"))
    assert condition.summary == "well"
    condition.set_notice("link", "no robot")
    assert condition.health().ok
    assert condition.health().notices == ("no robot",)
    condition.set_fault("board", "unplugged")
    condition.set_fault("disk", "full")
    assert not condition.health().ok
    assert condition.health().faults == ("unplugged", "full")
    assert condition.summary == "unplugged; full; no robot"
    condition.set_fault("board", "")
    condition.set_fault("disk", "")
    condition.set_notice("link", "")
    assert condition.health().ok
    assert condition.summary == "well"


def test_a_fault_that_is_no_text_is_told_all_the_same() -> None:
    condition = Condition("base", "1", service_logger("base"))
    condition.set_fault("board", "/dev/\udcff: no such port")
    assert msgspec.json.decode(msgspec.json.encode(condition.health()), type=Health).faults == ("/dev/?: no such port",)


def test_a_service_tells_what_it_speaks_of_and_listens_to_and_what_it_takes(peers: Peers) -> None:
    process = peers.start("talker")
    wait(lambda: peers.alive() == ["base"])
    wait(lambda: "estop/engage" in peers.health("base").answers)  # its own comes after what every service has
    health = peers.health("base")
    assert (health.publishes, health.subscribes) == (("tick",), ("tick",))
    assert health.answers == ("param/base", "param/base/set", "param/base/save", "estop/engage")
    seen = psutil.Process(process.pid)
    assert health.rss_bytes == pytest.approx(seen.memory_info().rss, rel=0.1)
    assert 0.0 < health.cpu_time <= sum(seen.cpu_times()[:2]) + 0.02  # the kernel cuts both to 10 ms


def test_the_socket_tells_what_the_network_is_told(peers: Peers, tmp_path: Path) -> None:
    process = peers.start("talker", RUNTIME_DIRECTORY=str(tmp_path / "run"))
    wait((tmp_path / "run" / "base.sock").exists)
    local = msgspec.json.decode(ask(str(tmp_path / "run" / "base.sock")), type=Health)
    remote = peers.health("base")
    now = {name: getattr(local, name) for name in ("uptime", "cpu_time", "rss_bytes", "stamp_ns")}
    assert local == msgspec.structs.replace(remote, **now)
    assert check(tmp_path / "run", "base")[0] == 0
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=2.0) == 0
    assert not (tmp_path / "run" / "base.sock").exists()


def test_a_loop_that_hangs_does_not_answer_though_its_process_lives(peers: Peers, tmp_path: Path) -> None:
    peers.start("sleepy", RUNTIME_DIRECTORY=str(tmp_path))
    path = str(tmp_path / "guard.sock")
    wait(lambda: Path(path).exists())
    assert ask(path)
    sleep(peers, 2.0)
    time.sleep(0.5)
    with pytest.raises(TimeoutError):
        ask(path, timeout=0.5)
    assert peers.health("guard").ok  # a thread's word, which proves nothing
    assert ask(path, timeout=5.0)


def test_a_service_killed_outright_comes_back_at_the_same_place(peers: Peers, tmp_path: Path) -> None:
    first = peers.start("talker", RUNTIME_DIRECTORY=str(tmp_path))
    path = tmp_path / "base.sock"
    wait(path.exists)
    first.kill()
    first.wait()
    assert check(tmp_path, "base")[0] == 2
    second = peers.start("talker", RUNTIME_DIRECTORY=str(tmp_path))
    wait(lambda: check(tmp_path, "base")[0] == 0)
    assert msgspec.json.decode(ask(str(path)), type=Health).pid == second.pid


def test_a_second_process_of_a_service_is_unwell_and_says_why(peers: Peers, tmp_path: Path) -> None:
    first = peers.start("listener", RUNTIME_DIRECTORY=str(tmp_path))
    wait((tmp_path / "guard.sock").exists)
    second = peers.start("sleepy", RUNTIME_DIRECTORY=str(tmp_path))
    wait(lambda: "another giraff_guard" in peers.log("sleepy").read_text())
    assert second.poll() is None
    assert msgspec.json.decode(ask(str(tmp_path / "guard.sock")), type=Health).pid == first.pid


def test_those_who_ask_without_pause_or_never_read_cost_no_sample(peers: Peers, tmp_path: Path) -> None:
    peers.start("talker", RUNTIME_DIRECTORY=str(tmp_path))
    path = str(tmp_path / "base.sock")
    wait(Path(path).exists)
    peers.start("listener")
    began = time.monotonic()
    asked = 0
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as deaf:
        deaf.connect(path)
        while time.monotonic() - began < 2.0:
            asked += bool(ask(path))
    assert asked > 100
    wait(lambda: peers.output("listener").read_text().count("\n") >= 2)
    assert "gapless=False" not in peers.output("listener").read_text()


def test_systemd_hears_of_the_start_of_life_and_of_the_end(peers: Peers, manager: FakeManager) -> None:
    process = peers.start("sleepy", **manager.environment, WATCHDOG_USEC="400000")
    assert manager.await_next() == ["READY=1", "STATUS=well", "WATCHDOG=1"]
    assert [manager.await_next() for _ in range(3)] == [["WATCHDOG=1"]] * 3
    sleep(peers, 2.0)
    time.sleep(0.5)
    manager.heard()
    time.sleep(1.0)
    assert manager.heard() == []  # the loop hangs: no sign of life
    assert manager.await_next() == ["WATCHDOG=1"]
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=2.0) == 0
    *signs, last = manager.heard()
    assert last == "STOPPING=1"
    assert set(signs) <= {"WATCHDOG=1"}


def test_a_manager_that_is_not_there_is_told_of_and_does_not_matter(peers: Peers, tmp_path: Path) -> None:
    peers.start("talker", NOTIFY_SOCKET=str(tmp_path / "nobody"))
    wait(lambda: bool(peers.health("base").notices))
    assert "NOTIFY_SOCKET" in peers.health("base").notices[0]
    assert peers.health("base").ok
