"""A node as a process: peers meet on the loopback alone, end cleanly, and hide nothing. How soon: tests/timing."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from giraff_node.network.query_client import QueryClient
from giraff_schemas.codec import encode
from giraff_schemas.messages import Battery, Tick
from giraff_schemas.requests import EStopAnswer, EStopEngage
from giraff_schemas.topics import BATTERY, ESTOP_ENGAGE, ESTOP_RESET, TICK, Query, alive_key, key_of
from giraff_schemas.trouble import Trouble
from tests.functional.node.peers import ROBOT, SERVICE, Peers
from tests.support.waiting import wait


@pytest.fixture
def peers(tmp_path: Path) -> Iterator[Peers]:
    started = Peers(tmp_path)
    yield started
    started.close()


@pytest.fixture(scope="module")
def talker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Peers, int]]:
    """One that nothing here harms, and its process id."""
    started = Peers(tmp_path_factory.mktemp("talker"))
    yield started, started.start("talker").pid
    started.close()


def test_two_processes_meet_on_the_loopback_alone(peers: Peers) -> None:
    peers.start("talker")
    peers.start("listener")
    wait(lambda: peers.output("listener").read_text().count("\n") >= 2, 60.0)
    assert set(peers.output("listener").read_text().splitlines()) == {"heard gapless=True newest=True"}


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_cleanly(peers: Peers, number: signal.Signals) -> None:
    process = peers.start("talker")
    wait(lambda: peers.alive() == ["base"], 60.0)
    process.send_signal(number)
    assert process.wait(timeout=60.0) == 0
    wait(lambda: peers.alive() == [], 60.0)
    assert '"message":"ended"' in peers.log("talker").read_text()


def test_a_session_that_hangs_at_its_end_does_not_keep_the_process(peers: Peers) -> None:
    process = peers.start("hanging")
    wait(lambda: peers.alive() == ["guard"], 60.0)
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=60.0) == 0


def test_an_exception_in_the_loop_ends_it_with_a_traceback(peers: Peers) -> None:
    process = peers.start("broken")
    assert process.wait(timeout=60.0) == 1
    entries = [json.loads(line) for line in peers.log("broken").read_text().splitlines()]
    (error,) = [entry for entry in entries if entry["level"] == "error"]
    assert "the loop itself broke down" in error["message"]
    assert "service_under_test.py" in error["traceback"]


def test_an_exception_in_a_callback_ends_it_with_a_traceback(peers: Peers) -> None:
    process = peers.start("fragile")
    payload = encode(Battery(instance="test", voltage=99.0))
    peers.put_until(BATTERY, payload, lambda: process.poll() is not None)
    assert process.returncode == 1
    log = peers.log("fragile").read_text()
    assert "99.0 V is too much for this test" in log
    assert "break_down" in log


def test_a_payload_that_is_no_sample_is_named_and_survived(peers: Peers) -> None:
    process = peers.start("listener")
    assert not peers.health("guard").notices
    peers.put_until(TICK, b"\xc1 not MessagePack", lambda: bool(peers.health("guard").notices))
    (fault,) = peers.health("guard").notices
    assert key_of(ROBOT, TICK) in str(fault)
    assert "not MessagePack" in str(fault)
    assert peers.health("guard").ok  # whoever sent it, this service is well
    assert process.poll() is None
    # Good ones mend it, once no bad one has come for a while.
    payload = encode(Tick(instance="test", epoch=1, robot_ns=1))
    peers.put_until(TICK, payload, lambda: not peers.health("guard").notices)
    wait(lambda: peers.log("listener").read_text().count("recovered") == 1)  # told after it is so
    assert peers.log("listener").read_text().count("not MessagePack") == 1


def test_a_bad_configuration_ends_it_with_one_line(tmp_path: Path) -> None:
    given = os.environ | {"GIRAFF_CONFIG": str(tmp_path / "absent.toml")}
    ended = subprocess.run(
        [sys.executable, str(SERVICE), "talker"], env=given, capture_output=True, text=True, check=False, timeout=60
    )
    assert ended.returncode == 2
    assert "absent.toml" in ended.stderr
    assert "Traceback" not in ended.stderr


def test_health_says_who_answers(talker: tuple[Peers, int]) -> None:
    peers, pid = talker
    wait(lambda: peers.alive() == ["base"], 60.0)
    health = peers.health("base")
    (token,) = [str(reply.ok.key_expr) for reply in peers.session.liveliness().get(alive_key(ROBOT)) if reply.ok]
    assert token == alive_key(ROBOT, "base", health.instance)
    assert (health.service, health.pid, health.ok, health.faults) == ("base", pid, True, ())
    assert health.uptime > 0.0


def test_logs_are_one_json_object_a_line(talker: tuple[Peers, int]) -> None:
    peers, _ = talker
    for line in peers.log("talker").read_text().splitlines():
        entry = json.loads(line)
        assert {"time", "level", "service", "message"} <= set(entry)


def test_a_request_is_answered_by_the_services_own_loop(talker: tuple[Peers, int]) -> None:
    peers, _ = talker
    asking = QueryClient(peers.session, ROBOT, ESTOP_ENGAGE, EStopEngage(by="test", reason=Trouble("refuse")))
    answers: list[EStopAnswer] = []

    def answered() -> bool:
        if (answer := asking.poll(time.monotonic())) is not None:
            answers.append(answer)
        return bool(answers)

    wait(answered, 60.0)
    assert not answers[0].done
    assert str(answers[0].reason) == "refuse"


def test_a_request_that_is_none_is_refused_but_a_stop_is_a_stop_and_the_service_lives(
    talker: tuple[Peers, int],
) -> None:
    peers, _ = talker
    for payload in (b"", b"\xc1", encode(Battery(voltage=1.0)), b"\x91" * 5000):
        for query, told in ((ESTOP_RESET, "not a EStopReset"), (ESTOP_ENGAGE, "a request that cannot be read")):
            wait(lambda: told in told_to(peers, query, payload), 60.0)  # noqa: B023  it is called before the next round
    assert peers.health("base").ok


def told_to(peers: Peers, query: Query[Any, Any], payload: bytes) -> str:
    """Return what the service says to a request of these bytes."""
    replies = peers.session.get(key_of(ROBOT, query), payload=payload, timeout=60.0)
    found = [reply.ok or reply.err for reply in replies]
    return "".join(bytes(each.payload).decode(errors="replace") for each in found if each is not None)
