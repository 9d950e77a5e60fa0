"""The `giraff` command, typed in this process."""

import io
import sys
from collections.abc import Callable
from typing import Final

import pytest
import typer.main

from giraff_cli.main import app
from giraff_cli.usage import run_app
from giraff_tools.network import command as visit

Giraff = Callable[..., tuple[int, str, str]]

_COMMAND: Final = typer.main.get_command(app)
"""Typer takes 50 ms to build it, and no call changes it."""


def typed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Exit code, output and complaint."""
    monkeypatch.setattr(visit, "_CLOSE_WITHIN", 60.0)  # a session that does not end would take this process along
    monkeypatch.setattr(typer.main, "get_command", lambda _app: _COMMAND)
    monkeypatch.setattr(sys, "argv", ["giraff", *words])
    capsys.readouterr()
    code = run_app(app)
    said = capsys.readouterr()
    return code, said.out, said.err


class Tty(io.StringIO):
    """Looks like a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def giraff(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Giraff:
    """Return what types the command: exit code, output and complaint."""
    return lambda *words: typed(monkeypatch, capsys, *words)
