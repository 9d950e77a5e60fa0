"""How a command ends."""

import atexit
import io
import sys
from collections.abc import Callable
from typing import NoReturn

import pytest

from giraff_cli import start
from giraff_cli.usage import run_app


class _Full(io.StringIO):
    def flush(self) -> None:
        raise OSError("no space left on device")


def _closed() -> None:
    """What Python has for a stream that was closed before it began."""


def _leave(code: int) -> NoReturn:
    raise StopIteration(code)


@pytest.mark.parametrize(
    ("told_to", "code", "ended"), [(io.StringIO, 2, 2), (io.StringIO, 0, 0), (_Full, 0, 1), (_closed, 2, 2)]
)
def test_a_command_ends_without_taking_python_down(
    told_to: Callable[[], io.StringIO | None], code: int, ended: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Zenoh's threads would abort the process then. Libraries are still told, and what cannot be told counts."""

    told: list[str] = []
    monkeypatch.setattr("signal.signal", lambda *_: None)
    monkeypatch.setattr("os._exit", _leave)
    monkeypatch.setattr("sys.stdout", told_to())
    monkeypatch.setattr(atexit, "_run_exitfuncs", lambda: told.append("exit"))
    monkeypatch.setattr(f"{run_app.__module__}.run_app", lambda _: code)
    with pytest.raises(StopIteration) as end:
        start.main()
    assert (end.value.value, told) == (ended, ["exit"])
    sys.stdout.close()


def test_an_exception_that_nobody_foresaw_is_shown_and_ends_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without Python's end, too, which a session that does not close would hold up."""

    def fail(_: object) -> NoReturn:
        raise KeyError("nobody foresaw this")

    monkeypatch.setattr("signal.signal", lambda *_: None)
    monkeypatch.setattr("os._exit", _leave)
    monkeypatch.setattr(atexit, "_run_exitfuncs", lambda: None)
    monkeypatch.setattr(f"{run_app.__module__}.run_app", fail)
    with pytest.raises(StopIteration) as end:
        start.main()
    assert end.value.value == 1
    assert "KeyError: 'nobody foresaw this'" in capsys.readouterr().err
