"""`giraff watch` on a network of its own, with a robot that is nothing but what it says."""

from __future__ import annotations

import errno
import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zenoh

from giraff_cli import output
from giraff_cli import watch as it
from giraff_cli.screen import Lines
from giraff_cli.watcher import free_port
from giraff_node.robots import Roster
from giraff_node.session import NetworkConfig, close_session, open_session
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.topics import BASE, ESTOP, GUARD, LEASE, ODOM, WHEELS, alive_key, key_of
from tests.support.waiting import wait
from tests.unit.cli.samples import base, estop, guard, lease, odometry, verdict, wheels


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> NetworkConfig:
    """A loopback that nobody else is on, for this process and for the watch."""
    network = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
    for name in [name for name in os.environ if name.startswith("GIRAFF_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("GIRAFF_NETWORK_RENDEZVOUS", network.rendezvous)
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    monkeypatch.chdir(tmp_path)
    return network


@pytest.fixture
def session(network: NetworkConfig) -> Iterator[zenoh.Session]:
    opened = open_session(network, "*")
    yield opened
    assert close_session(opened)


@contextmanager
def talking(session: zenoh.Session, robot: str, after: float = 0.0, topics: Sequence[Any] = ()) -> Iterator[None]:
    """A robot that says the same thing again and again, from `after` s on."""
    said = [(ODOM, odometry(0, 2.0)), (LEASE, lease()), (GUARD, guard(verdict())), (BASE, base()), (ESTOP, estop())]
    ended = threading.Event()

    def talk() -> None:
        ended.wait(after)
        with session.liveliness().declare_token(alive_key(robot, "base", "b")):
            for seq in range(1000):
                for topic, sample in (*said, *topics):
                    data = encode(stamped(sample, seq, 0, "b"))
                    session.put(key_of(robot, topic), data, encoding=encoding_of(topic.schema))
                if ended.wait(0.05):
                    return

    speaker = threading.Thread(target=talk)
    speaker.start()
    try:
        yield
    finally:
        ended.set()
        speaker.join()


def watched(
    capfd: pytest.CaptureFixture[str], robot: str | None, seconds: float, *, as_json: bool = False
) -> tuple[int, list[str], str]:
    """Exit code, lines, standard error."""
    code = it.watch(robot, (), seconds, as_json=as_json)
    out, err = capfd.readouterr()
    return code, out.splitlines(), err


def test_the_only_robot_is_watched(session: zenoh.Session, capfd: pytest.CaptureFixture[str]) -> None:
    with talking(session, "otto"):
        code, lines, err = watched(capfd, None, 2.5)
    assert (code, err) == (0, "")
    assert len(lines) == 3
    assert all("path   2.00 m |  0.40 m/s" in line and "base driving" in line for line in lines)
    assert all("| not there: guard, ranger, odometry" in line for line in lines)


def test_it_says_so_while_there_is_none_and_goes_on_when_one_comes(
    session: zenoh.Session, capfd: pytest.CaptureFixture[str]
) -> None:
    with talking(session, "otto", after=1.5):
        code, lines, err = watched(capfd, None, 4.5)
    assert (code, err) == (0, "")
    assert "no robot is heard on the network; check that it is on and on this network" in lines[0]
    assert "base driving" in lines[-1]


def test_a_robot_that_never_comes_is_an_error_and_the_others_are_named(
    session: zenoh.Session, capfd: pytest.CaptureFixture[str]
) -> None:
    with talking(session, "anna"):
        code, lines, err = watched(capfd, "otto", 1.2)
    assert code == 2
    assert "no robot called otto is heard on the network; check that it is on" in lines[-1]
    assert lines[-1].endswith("; on the network: --robot anna")
    assert err.startswith("giraff: no robot called otto is heard on the network")
    assert err.endswith("on the network: --robot anna (waited 1.2 s)\n")


def test_of_several_one_must_be_named(session: zenoh.Session, capfd: pytest.CaptureFixture[str]) -> None:
    with talking(session, "otto"), talking(session, "anna"):
        code, _, err = watched(capfd, None, 5.0)
        assert code == 2
        assert err == "giraff: several robots are on the network; name one: --robot anna, --robot otto\n"
        code, lines, err = watched(capfd, "otto", 1.1, as_json=True)
    assert (code, err) == (0, "")
    assert {msgspec.json.decode(line)["robot"] for line in lines} == {"otto"}


def test_wheels_are_listened_to_only_while_odometry_is_silent(
    session: zenoh.Session, capfd: pytest.CaptureFixture[str]
) -> None:
    rolling = msgspec.structs.replace(wheels(0), left_velocity=0.2, right_velocity=0.2)
    with talking(session, "otto", topics=[(WHEELS, rolling)]):
        _, lines, _ = watched(capfd, "otto", 2.1, as_json=True)
    told = msgspec.json.decode(lines[-1])
    assert told["speed"] == 0.4
    assert "wheels" not in told["topics"]


def test_what_cannot_be_read_is_told_for_as_long_as_it_comes(
    session: zenoh.Session, capfd: pytest.CaptureFixture[str]
) -> None:
    with talking(session, "otto"):
        sender = threading.Timer(1.5, lambda: session.put(key_of("otto", BASE), b"\x93"))
        sender.start()
        _, lines, _ = watched(capfd, "otto", 6.1)
        sender.join()
    told = ["giraff/otto/base: not a BaseState" in line for line in lines]
    assert any(told)
    assert not told[-1]


def test_a_name_that_can_be_none_is_refused(network: NetworkConfig, capfd: pytest.CaptureFixture[str]) -> None:  # noqa: ARG001
    code, lines, err = watched(capfd, "a/b", 1.0)
    assert (code, lines) == (2, [])
    assert "robot: 'a/b' cannot be part of a key" in err


@pytest.mark.parametrize(
    ("number", "code", "told"),
    [
        (errno.EPIPE, 0, ""),
        (errno.EIO, 0, ""),
        (errno.ENOSPC, 1, "giraff: cannot write to standard output: No space left on device\n"),
    ],
)
def test_who_does_not_read_ends_it(
    session: zenoh.Session,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    number: int,
    code: int,
    told: str,
) -> None:
    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(Lines, "show", fail)
    monkeypatch.setattr(output, "drop_output", lambda: None)
    with talking(session, "otto"):
        assert watched(capfd, "otto", 5.0) == (code, [], told)


def test_the_roster_follows_robots_that_come_and_go(session: zenoh.Session, network: NetworkConfig) -> None:
    visitor = open_session(network, "*", visiting=True)
    roster = Roster(visitor)

    assert roster.settled == []
    with talking(session, "otto"):
        wait(lambda: roster.names == ["otto"])
        assert roster.settled == []
        wait(lambda: roster.settled == ["otto"])
        with talking(session, "anna"):
            wait(lambda: roster.settled == ["anna", "otto"])
        wait(lambda: roster.settled == ["otto"])
    wait(lambda: roster.names == [])
    assert roster.settled == []
    assert close_session(visitor)


class StartedAnewError(Exception):
    """In place of the end of this program."""


def test_it_starts_anew_on_a_host_that_is_found_elsewhere(
    network: NetworkConfig,  # noqa: ARG001
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    def start_anew() -> None:
        raise StartedAnewError

    addresses = iter([frozenset[str]()])
    monkeypatch.setattr(it, "host_addresses", lambda: next(addresses, frozenset({"192.0.2.7"})))
    monkeypatch.setattr("giraff_cli.visit.start_anew", start_anew)
    with pytest.raises(StartedAnewError):
        it.watch(None, (), None, as_json=False)
    capfd.readouterr()
