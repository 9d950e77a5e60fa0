"""A service as healthchecks and systemd see it: by its own loop, so that one that hangs looks hung."""

import signal
import socket
from collections.abc import Iterator
from pathlib import Path

import msgspec
import psutil
import pytest

from giraff_health.ask import ask
from giraff_schemas.codec import encode
from giraff_schemas.health import Health
from giraff_schemas.requests import EStopEngage
from giraff_schemas.topics import ESTOP_ENGAGE, key_of
from giraff_schemas.trouble import Trouble
from tests.functional.health.answering import check
from tests.functional.node.peers import ROBOT, Peers
from tests.support.manager import FakeManager
from tests.support.waiting import wait


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


def test_a_service_tells_what_it_speaks_of_and_listens_to_and_what_it_takes(peers: Peers) -> None:
    process = peers.start("talker")
    wait(lambda: peers.alive() == ["base"], 60.0)
    wait(lambda: "estop/reset" in peers.health("base").answers)  # its own comes after what every service has
    health = peers.health("base")
    assert (health.publishes, health.subscribes) == (("tick",), ("tick",))
    assert health.answers == ("param/base", "param/base/set", "param/base/save", "estop/engage", "estop/reset")
    seen = psutil.Process(process.pid)
    assert health.rss_bytes == pytest.approx(seen.memory_info().rss, rel=0.1)
    assert 0.0 < health.cpu_time <= sum(seen.cpu_times()[:2]) + 0.02  # the kernel cuts both to 10 ms


def test_the_socket_tells_what_the_network_is_told(peers: Peers, manager: FakeManager, tmp_path: Path) -> None:
    process = peers.start("talker", **manager.environment, RUNTIME_DIRECTORY=str(tmp_path / "run"))
    wait((tmp_path / "run" / "base.sock").exists, 60.0)
    local = msgspec.json.decode(ask(str(tmp_path / "run" / "base.sock"), timeout=60.0), type=Health)
    remote = peers.health("base")
    now = {name: getattr(local, name) for name in ("uptime", "cpu_time", "rss_bytes", "stamp_ns")}
    assert local == msgspec.structs.replace(remote, **now)
    assert check(tmp_path / "run", "base")[0] == 0
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=60.0) == 0
    assert not (tmp_path / "run" / "base.sock").exists()
    assert manager.heard() == ["READY=1", "STATUS=well", "STOPPING=1"]


def test_a_service_killed_outright_comes_back_at_the_same_place(peers: Peers, tmp_path: Path) -> None:
    first = peers.start("talker", RUNTIME_DIRECTORY=str(tmp_path))
    path = tmp_path / "base.sock"
    wait(path.exists, 60.0)
    first.kill()
    first.wait()
    assert check(tmp_path, "base")[0] == 2
    second = peers.start("talker", RUNTIME_DIRECTORY=str(tmp_path))
    wait(lambda: check(tmp_path, "base")[0] == 0, 60.0)
    assert msgspec.json.decode(ask(str(path), timeout=60.0), type=Health).pid == second.pid


def test_a_second_process_of_a_service_is_unwell_and_says_why(peers: Peers, tmp_path: Path) -> None:
    first = peers.start("listener", RUNTIME_DIRECTORY=str(tmp_path))
    wait((tmp_path / "guard.sock").exists, 60.0)
    second = peers.start("sleepy", RUNTIME_DIRECTORY=str(tmp_path))
    wait(lambda: "another giraff_guard" in peers.log("sleepy").read_text(), 60.0)
    assert second.poll() is None
    assert msgspec.json.decode(ask(str(tmp_path / "guard.sock"), timeout=60.0), type=Health).pid == first.pid


def test_a_manager_that_is_not_there_is_told_of_and_does_not_matter(peers: Peers, tmp_path: Path) -> None:
    peers.start("talker", NOTIFY_SOCKET=str(tmp_path / "nobody"))
    wait(lambda: bool(peers.health("base").notices), 60.0)
    assert "NOTIFY_SOCKET" in str(peers.health("base").notices[0])
    assert peers.health("base").ok


def test_those_who_ask_without_pause_or_never_read_cost_no_sample(peers: Peers, tmp_path: Path) -> None:
    peers.start("talker", RUNTIME_DIRECTORY=str(tmp_path))
    path = str(tmp_path / "base.sock")
    wait(Path(path).exists, 60.0)
    peers.start("listener")
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as deaf:
        deaf.connect(path)
        for _ in range(200):
            assert ask(path, timeout=60.0)
    wait(lambda: peers.output("listener").read_text().count("\n") >= 2, 60.0)
    assert "gapless=False" not in peers.output("listener").read_text()


def test_a_loop_that_hangs_looks_dead_and_ends_its_process_with_the_place_in_its_log(
    peers: Peers, manager: FakeManager, tmp_path: Path
) -> None:
    runtime = {"RUNTIME_DIRECTORY": str(tmp_path), "WATCHDOG_USEC": "3000000"}
    process = peers.start("sleepy", **manager.environment, **runtime)
    assert manager.await_next() == ["READY=1", "STATUS=well", "WATCHDOG=1"]
    assert [manager.await_next() for _ in range(3)] == [["WATCHDOG=1"]] * 3  # 4.5 s, in which the watchdog leaves it
    path = tmp_path / "guard.sock"
    assert ask(str(path), timeout=60.0)
    request = encode(EStopEngage(by="test", reason=Trouble(str(tmp_path / "never"))))

    def hangs() -> bool:
        peers.session.get(key_of(ROBOT, ESTOP_ENGAGE), lambda _reply: None, payload=request, timeout=0.1)
        return "hangs" in peers.output("sleepy").read_text()

    wait(hangs, 60.0, every=0.2)
    manager.heard()
    with pytest.raises((TimeoutError, ConnectionResetError)):  # the latter, where this test was late
        ask(str(path), timeout=0.5)
    assert manager.heard() == []
    assert process.wait(timeout=60.0) == -signal.SIGALRM
    assert 'service_under_test.py", line' in peers.log("sleepy").read_text()
