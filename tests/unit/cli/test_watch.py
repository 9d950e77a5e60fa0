"""`giraff watch` of a robot that only says things. Of a real one: tests/functional/one_robot/test_watch.py."""

import errno
import fcntl
import os
import select
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Self, cast

import msgspec
import pytest

import giraff_node.network.discovery
import giraff_tools.network.command
import giraff_tools.network.connection
from giraff_cli.watch import monitor
from giraff_node.network.discovery import RobotMonitor
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.topics import BASE, ESTOP, GUARD, LEASE, ODOM, WHEELS, alive_key, key_of
from giraff_tools.terminal import output
from giraff_tools.terminal.screen import LineScreen
from tests.support.one_process import Clock, Session
from tests.unit.cli.samples import base, estop, guard, lease, odometry, verdict, wheels


class Network:
    """A clock, and a session of all who are there."""

    def __init__(self) -> None:
        self.clock = Clock()
        self.session = Session(self.clock)

    @contextmanager
    def talking(self, robot: str, topics: Sequence[Any] = ()) -> Iterator[None]:
        """A robot that says the same thing again and again."""
        said = [(ODOM, odometry(0, 2.0)), (LEASE, lease()), (GUARD, guard(verdict())), (BASE, base()), (ESTOP, estop())]

        def talk() -> None:
            for topic, sample in (*said, *topics):
                data = encode(stamped(sample, round(self.clock.monotonic() / 0.05), 0, "b"))
                self.session.put(key_of(robot, topic), data, encoding=encoding_of(topic.schema))

        with self.session.declare_token(alive_key(robot, "base", "b")):
            end = self.clock.every(0.05, talk)
            yield
            end()


class Waits:
    """In the place of StopSignal: nobody asks for the end."""

    asked = 0

    def __init__(self, clock: Clock) -> None:
        self._clock = clock

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def wait(self, seconds: float) -> bool:
        self._clock.sleep(seconds)
        return False


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Network:
    made = Network()
    for name in [name for name in os.environ if name.startswith("GIRAFF_")]:
        monkeypatch.delenv(name)
    monkeypatch.chdir(tmp_path)
    for module in (monitor, giraff_node.network.discovery):
        monkeypatch.setattr(module, "time", made.clock)
    for module in (monitor, giraff_tools.network.connection):
        monkeypatch.setattr(module, "robot_now_ns", made.clock.monotonic_ns)
    monkeypatch.setattr(monitor, "StopSignal", lambda: Waits(made.clock))
    monkeypatch.setattr(monitor, "set_tcp_options", lambda: None)
    monkeypatch.setattr(giraff_tools.network.command, "open_session", lambda *_, **__: made.session)
    monkeypatch.setattr(giraff_tools.network.connection, "close_session", lambda *_: True)
    return made


def watched(
    capfd: pytest.CaptureFixture[str], robot: str | None, seconds: float, *, as_json: bool = False
) -> tuple[int, list[str], str]:
    """Exit code, lines, standard error."""
    code = monitor.watch(robot, (), seconds, as_json=as_json)
    out, err = capfd.readouterr()
    return code, out.splitlines(), err


def test_the_only_robot_is_watched(network: Network, capfd: pytest.CaptureFixture[str]) -> None:
    with network.talking("otto"):
        code, lines, err = watched(capfd, None, 2.5)
    assert (code, err) == (0, "")
    assert len(lines) == 3
    assert all("path   2.00 m |  0.40 m/s" in line and "base driving" in line for line in lines)
    assert all("| not there: guard, ranger, odometry" in line for line in lines)


def test_it_says_so_while_there_is_none_and_goes_on_when_one_comes(
    network: Network, capfd: pytest.CaptureFixture[str]
) -> None:
    comes = network.talking("otto")
    network.clock.after(1.5, comes.__enter__)
    code, lines, err = watched(capfd, None, 4.5)
    comes.__exit__(None, None, None)
    assert (code, err) == (0, "")
    assert "no robot is heard on the network; check that it is on and on this network" in lines[0]
    assert "base driving" in lines[-1]


def test_a_robot_that_never_comes_is_an_error_and_the_others_are_named(
    network: Network, capfd: pytest.CaptureFixture[str]
) -> None:
    with network.talking("anna"):
        code, lines, err = watched(capfd, "otto", 1.2)
    assert code == 2
    assert "no robot called otto is heard on the network; check that it is on" in lines[-1]
    assert lines[-1].endswith("; on the network: --robot anna")
    assert err.startswith("giraff: no robot called otto is heard on the network")
    assert err.endswith("on the network: --robot anna (waited 1.2 s)\n")


def test_of_several_one_must_be_named(network: Network, capfd: pytest.CaptureFixture[str]) -> None:
    with network.talking("otto"), network.talking("anna"):
        code, _, err = watched(capfd, None, 5.0)
        assert code == 2
        assert "several robots are on the network; name one: --robot anna, --robot otto" in err
        code, lines, err = watched(capfd, "otto", 1.1, as_json=True)
    assert (code, err) == (0, "")
    assert {msgspec.json.decode(line)["robot"] for line in lines} == {"otto"}


def test_wheels_are_listened_to_only_while_odometry_is_silent(
    network: Network, capfd: pytest.CaptureFixture[str]
) -> None:
    rolling = msgspec.structs.replace(wheels(0), left_velocity=0.2, right_velocity=0.2)
    with network.talking("otto", topics=[(WHEELS, rolling)]):
        _, lines, _ = watched(capfd, "otto", 2.1, as_json=True)
    told = msgspec.json.decode(lines[-1])
    assert told["speed"] == 0.4
    assert "wheels" not in told["topics"]
    assert key_of("otto", WHEELS) in network.session.subscribed


def test_what_cannot_be_read_is_told_for_as_long_as_it_comes(
    network: Network, capfd: pytest.CaptureFixture[str]
) -> None:
    with network.talking("otto"):
        network.clock.after(1.5, lambda: network.session.put(key_of("otto", BASE), b"\x93"))
        _, lines, _ = watched(capfd, "otto", 6.1)
    told = ["giraff/otto/base: not a BaseState" in line for line in lines]
    assert told == [False, False, True, True, True, False, False]


@pytest.mark.usefixtures("network")
def test_a_name_that_can_be_none_is_refused(capfd: pytest.CaptureFixture[str]) -> None:
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
    network: Network,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    number: int,
    code: int,
    told: str,
) -> None:
    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(LineScreen, "show", fail)
    monkeypatch.setattr(output, "discard_stdout", lambda: None)
    with network.talking("otto"):
        assert watched(capfd, "otto", 5.0) == (code, [], told)


def test_a_line_that_is_longer_than_a_pipe_waits_for_its_reader_and_holds_nothing_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    read, write = os.pipe()
    fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, 4096)
    with os.fdopen(read, "rb", buffering=0) as reader, os.fdopen(write, "w", encoding="utf-8") as pipe:
        monkeypatch.setattr("sys.stdout", pipe)
        screen, heard = LineScreen(), b""
        for elapsed, letter in ((0.0, "a"), (1.0, "b")):  # a second later nobody has read the first
            screen.show(cast(Any, SimpleNamespace(elapsed=elapsed, line=lambda said=letter * 6000: said)))
        while select.select([reader], [], [], 0.0)[0]:
            heard += reader.read(4096) or b""
            screen.close()
    assert heard == b"a" * 6000 + b"\n"


def test_the_roster_follows_robots_that_come_and_go(network: Network) -> None:
    network.clock.sleep(1.0)  # no machine's clock stands at 0
    roster = RobotMonitor(cast(Any, network.session))
    assert roster.settled == []
    with network.talking("otto"):
        assert roster.names == ["otto"]
        assert roster.settled == []
        network.clock.sleep(0.4)
        assert roster.settled == []
        network.clock.sleep(0.2)
        assert roster.settled == ["otto"]
        with network.talking("anna"):
            assert roster.settled == ["anna", "otto"]
        assert roster.settled == ["otto"]
    assert roster.names == []
    assert roster.settled == []


class StartedAnewError(Exception):
    """In place of the end of this program."""


@pytest.mark.usefixtures("network")
def test_it_starts_anew_on_a_host_that_is_found_elsewhere(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def restart_program(marks: dict[str, str]) -> None:
        assert marks, "an address that is out of reach by then would end it"
        raise StartedAnewError

    addresses = iter([frozenset[str]()])
    monkeypatch.setattr(monitor, "host_addresses", lambda: next(addresses, frozenset({"192.0.2.7"})))
    monkeypatch.setattr("giraff_node.process.lifecycle.restart_program", restart_program)
    with pytest.raises(StartedAnewError):
        monitor.watch(None, (), None, as_json=False)
    capfd.readouterr()
