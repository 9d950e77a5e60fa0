"""The socket that healthchecks ask: nothing that a client, a namesake or a disk does holds or ends the loop."""

import os
import select
import socket
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from giraff_health.ask import ask
from giraff_node.process.health_socket import RETRY, TOUCHED, HealthSocket
from giraff_schemas.health import Health
from giraff_schemas.trouble import NO_TROUBLE, Trouble

HEALTH = Health(
    service="base", instance="1", host="h", pid=7, uptime=1.0, ok=False, faults=(Trouble("x"),), notices=(Trouble("y"),)
)


def opened(directory: Path, now: float = 0.0) -> HealthSocket:
    answerer = HealthSocket("base", {"RUNTIME_DIRECTORY": str(directory)})
    answerer.keep_open(now)
    return answerer


@pytest.fixture
def answerer(tmp_path: Path) -> Iterator[HealthSocket]:
    answerer = opened(tmp_path / "made" / "by it")
    yield answerer
    answerer.close()


def connected(path: Path) -> socket.socket:
    client = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    client.settimeout(5.0)
    client.connect(str(path))
    return client


def told(client: socket.socket) -> bytes:
    """All that a client is sent until it is let go."""
    with client:
        return b"".join(iter(lambda: client.recv(65536), b""))


def path_of(answerer: HealthSocket) -> Path:
    assert answerer._path is not None
    return answerer._path


def test_who_connects_is_told_the_health_as_one_line(answerer: HealthSocket) -> None:
    assert answerer.fault == NO_TROUBLE
    client = connected(path_of(answerer))
    descriptor = answerer.descriptor()
    assert descriptor is not None
    assert select.select([descriptor], [], [], 5.0)[0]
    answerer.answer(lambda: HEALTH)
    answer = told(client)
    assert msgspec.json.decode(answer, type=Health) == HEALTH
    assert answer.count(b"\n") == 1
    assert answer.endswith(b"\n")


def test_clients_that_are_mute_deaf_or_gone_hold_nothing(answerer: HealthSocket) -> None:
    huge = msgspec.structs.replace(HEALTH, faults=("x" * 2_000_000,))  # more than any socket buffers
    deaf = [connected(path_of(answerer)) for _ in range(50)]
    connected(path_of(answerer)).close()
    for _ in range(10):
        answerer.answer(lambda: huge)
    last = connected(path_of(answerer))
    answerer.answer(lambda: HEALTH)
    assert msgspec.json.decode(told(last), type=Health) == HEALTH
    for client in deaf:
        client.close()


def test_a_crowd_is_answered_over_several_turns(answerer: HealthSocket) -> None:
    asked = []

    def health() -> Health:
        asked.append(1)
        return HEALTH

    crowd = [connected(path_of(answerer)) for _ in range(30)]
    answerer.answer(health)
    assert 0 < len(asked) < 30
    for _ in range(10):
        answerer.answer(health)
    assert len(asked) == 30
    assert all(told(client) for client in crowd)


def test_without_a_runtime_directory_there_is_none() -> None:
    for environment in ({}, {"RUNTIME_DIRECTORY": ""}):
        answerer = HealthSocket("base", environment)
        answerer.keep_open(0.0)
        answerer.answer(lambda: HEALTH)
        assert answerer.descriptor() is None
        assert answerer.fault == NO_TROUBLE
        answerer.close()


@pytest.mark.parametrize("what", ["socket", "file"])
def test_what_a_dead_process_left_is_replaced(tmp_path: Path, what: str) -> None:
    if what == "socket":
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as dead:
            dead.bind(str(tmp_path / "base.sock"))
    else:
        (tmp_path / "base.sock").write_text("left over")
    (tmp_path / "base.lock").touch()
    answerer = opened(tmp_path)
    assert answerer.fault == NO_TROUBLE
    client = connected(tmp_path / "base.sock")
    answerer.answer(lambda: HEALTH)
    assert told(client)
    answerer.close()


def test_a_second_process_says_so_and_takes_over_when_the_first_has_ended(tmp_path: Path) -> None:
    first, second = opened(tmp_path), opened(tmp_path)
    assert "another giraff_base" in str(second.fault)
    assert "end one" in str(second.fault)
    client = connected(tmp_path / "base.sock")
    second.answer(lambda: HEALTH)
    first.answer(lambda: HEALTH)
    assert told(client)
    first.close()
    second.keep_open(RETRY / 2)
    assert second.fault  # it is not asked for in every turn
    second.keep_open(RETRY)
    assert second.fault == NO_TROUBLE
    client = connected(tmp_path / "base.sock")
    second.answer(lambda: HEALTH)
    assert told(client)
    second.close()
    assert not (tmp_path / "base.sock").exists()


def test_the_file_of_faults_is_written_on_a_change_and_touched_as_long_as_the_loop_turns(tmp_path: Path) -> None:
    answerer, file = opened(tmp_path), tmp_path / "base.faults"
    second = opened(tmp_path)
    second.update(0.0, "of a second process\n")
    assert not file.exists()
    answerer.update(0.0, "")
    assert file.read_text() == ""
    os.utime(file, (1.0, 1.0))
    answerer.update(TOUCHED / 2, "")
    assert file.stat().st_mtime == 1.0  # it costs no more than it must
    answerer.update(TOUCHED, "")
    assert file.stat().st_mtime > 1.0
    answerer.update(TOUCHED * 1.1, "unplugged\n")
    assert file.read_text() == "unplugged\n"
    answerer.close()
    assert not file.exists()


def test_an_old_word_does_not_stay_where_a_new_one_cannot_be_written(tmp_path: Path) -> None:
    answerer, file = opened(tmp_path), tmp_path / "base.faults"
    answerer.update(0.0, "")
    (tmp_path / "base.faults.new").mkdir()
    answerer.update(1.0, "unplugged\n")
    assert not file.exists()
    assert "base.faults" in str(answerer.fault)
    (tmp_path / "base.faults.new").rmdir()
    answerer.update(2.0, "")
    assert file.read_text() == ""
    assert answerer.fault == NO_TROUBLE
    answerer.close()


def test_a_directory_that_cannot_be_is_a_fault_with_the_way_out(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for directory in (tmp_path / "file", tmp_path / "file" / "below", tmp_path / ("x" * 120), Path("/proc/giraff")):
        answerer = opened(directory)
        assert "RUNTIME_DIRECTORY" in str(answerer.fault)
        assert str(directory) in str(answerer.fault)
        answerer.answer(lambda: HEALTH)
        answerer.close()


def test_a_directory_in_the_sockets_place_is_a_fault_until_it_is_gone(tmp_path: Path) -> None:
    (tmp_path / "base.sock").mkdir()
    answerer = opened(tmp_path)
    assert "base.sock" in str(answerer.fault)
    (tmp_path / "base.sock").rmdir()
    answerer.keep_open(RETRY)
    assert answerer.fault == NO_TROUBLE
    answerer.close()


def test_no_descriptor_is_left_behind(tmp_path: Path) -> None:
    before = len(os.listdir("/proc/self/fd"))  # noqa: PTH208  of the count alone
    held = opened(tmp_path)
    for number in range(20):
        HealthSocket("base", {"RUNTIME_DIRECTORY": str(tmp_path)}).keep_open(number)
    held.close()
    opened(tmp_path).close()
    assert len(os.listdir("/proc/self/fd")) == before  # noqa: PTH208


def test_its_answer_is_what_the_program_takes(answerer: HealthSocket) -> None:
    client = connected(path_of(answerer))
    answerer.answer(lambda: HEALTH)
    client.close()
    with pytest.raises(TimeoutError):  # nobody turns the loop here
        ask(str(path_of(answerer)), timeout=0.1)
