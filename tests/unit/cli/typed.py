"""The `giraff` command, typed in this process."""

from __future__ import annotations

import sys

import pytest

from giraff_cli.main import app
from giraff_cli.usage import obey


def typed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Exit code, output and complaint."""
    monkeypatch.setattr(sys, "argv", ["giraff", *words])
    capsys.readouterr()
    code = obey(app)
    said = capsys.readouterr()
    return code, said.out, said.err
