"""A run leaves nothing behind: what was killed is cleared away by the next one, and nothing else is."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from giraff_cli.run.directory import RunDirectory

KILLED = """
import os, signal
from giraff_cli.run.directory import RunDirectory
directory = RunDirectory()
(directory.path / "some.log").write_text("said")
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    return tmp_path


def test_what_a_killed_run_left_is_removed(temporary: Path) -> None:
    subprocess.run([sys.executable, "-c", KILLED], check=False)
    [left] = temporary.iterdir()
    assert (left / "some.log").exists()
    directory = RunDirectory()
    assert [*temporary.iterdir()] == [directory.path]
    directory.remove()
    assert [*temporary.iterdir()] == []


def test_a_running_one_and_kept_logs_stay(temporary: Path) -> None:
    running, failed = RunDirectory(), RunDirectory()
    (failed.path / "base.log").write_text("the port is gone")
    failed.keep()
    (temporary / "giraff-run-notes").mkdir()
    third = RunDirectory()
    assert {*temporary.iterdir()} == {running.path, failed.path, third.path, temporary / "giraff-run-notes"}
    assert [path.name for path in failed.path.iterdir()] == ["base.log"]
    running.remove()
    third.remove()
