"""The program that asks a service how it is: its exit codes and its words, and that it waits for nobody."""

import socket
from pathlib import Path

import msgspec
import pytest

from giraff_health.ask import WELL, socket_path
from giraff_schemas.health import Health
from giraff_schemas.trouble import Trouble
from tests.functional.health.answering import answering, check

UNCHECKED = Trouble("the wiring is not checked", "lift the wheels", "run", "giraff check wheels")


def line(*faults: Trouble, notice: str = "") -> bytes:
    """The answer of a service with these faults."""
    health = Health(
        service="base",
        instance="1",
        host="h",
        pid=7,
        uptime=1.5,
        ok=not faults,
        faults=faults,
        notices=(Trouble(notice),) if notice else (),
    )
    return msgspec.json.encode(health) + b"\n"


def test_a_well_service_is_0_with_the_whole_answer(tmp_path: Path) -> None:
    answer = line(notice="no wheels")
    with answering(tmp_path, answer):
        assert check(tmp_path, "base") == (0, answer.decode())


def test_an_unwell_one_is_1_with_a_line_a_fault(tmp_path: Path) -> None:
    with answering(tmp_path, line(UNCHECKED, Trouble("the disk is full"))):
        told = "the wiring is not checked; lift the wheels, then run `giraff check wheels`\nthe disk is full\n"
        assert check(tmp_path, "base") == (1, told)


def test_no_words_of_a_fault_make_a_service_well() -> None:
    assert WELL in line()
    assert WELL not in line(*map(Trouble, ('"ok":true', WELL.decode(), '\\"ok":true')))


def test_an_answer_in_pieces_is_put_together(tmp_path: Path) -> None:
    answer = line(Trouble("a" * 5000))
    with answering(tmp_path, answer[:100], answer[100:]):
        assert check(tmp_path, "base") == (1, "a" * 5000 + "\n")


@pytest.mark.parametrize("answer", [b"\n", b"{}\n", b"[1]\n", b'{"faults":3}\n', b"\xff\xfe\n", b"[" * 60_000 + b"\n"])
def test_what_is_no_answer_is_2_and_no_traceback(tmp_path: Path, answer: bytes) -> None:
    with answering(tmp_path, answer):
        code, words = check(tmp_path, "base")
    assert code == 2
    assert "not an answer" in words


def test_a_service_that_ends_meanwhile_is_2(tmp_path: Path) -> None:
    with answering(tmp_path, line()[:20]):
        code, words = check(tmp_path, "base")
    assert code == 2
    assert "ended just now" in words


def test_a_service_that_hangs_is_2(tmp_path: Path) -> None:
    """How soon: tests/timing."""
    with answering(tmp_path, b"{", then_silent=True):
        code, words = check(tmp_path, "base")
    assert code == 2
    assert "hangs" in words


def test_a_queue_that_is_full_is_2_at_once(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(tmp_path / "base.sock"))
        listener.listen(0)
        waiting = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        with waiting:
            waiting.connect(str(tmp_path / "base.sock"))
            code, words = check(tmp_path, "base")
    assert code == 2
    assert "hangs" in words


def test_nobody_there_is_2_with_the_likely_cause(tmp_path: Path) -> None:
    code, words = check(tmp_path, "base")
    assert code == 2
    assert f"{tmp_path}/base.sock" in words
    assert "does not run" in words


def test_a_dead_ones_socket_is_2(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as dead:
        dead.bind(str(tmp_path / "base.sock"))
    code, words = check(tmp_path, "base")
    assert code == 2
    assert "died" in words


def test_a_path_that_no_socket_can_have_is_2(tmp_path: Path) -> None:
    code, words = check(tmp_path / ("x" * 120), "base")
    assert code == 2
    assert "too long" in words


@pytest.mark.parametrize("arguments", [(), ("base", "guard"), ("../base",), ("",)])
def test_a_wrong_call_is_2_with_the_right_one(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    code, words = check(tmp_path, *arguments)
    assert code == 2
    assert words.startswith("usage:")


def test_without_a_variable_it_asks_where_the_unit_has_it() -> None:
    assert socket_path("base", {}) == "/run/giraff/base/base.sock"
    assert socket_path("base", {"RUNTIME_DIRECTORY": "/run/a:/run/b"}) == "/run/a/base.sock"
