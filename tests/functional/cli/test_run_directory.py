"""A run leaves nothing behind: what was killed is cleared away by the next one, and nothing else is."""

import fcntl
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from giraff_cli.run.directory import RunDirectory, remove_run_sockets
from giraff_core.network import NetworkConfig
from giraff_node.network import sockets

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


def test_the_sockets_of_a_killed_run_go_with_the_next(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder stays if it is in use, young, of another kind, or behind a link."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(temporary))
    monkeypatch.setattr(sockets, "SHARED", temporary / "nowhere")
    network = NetworkConfig(rendezvous="127.0.0.1:20000")
    own = sockets.socket_folder(network)
    killed, used, starting, robots, far = (own.with_name(name) for name in ("20001", "20002", "20003", "7447", "far"))
    linked = own.with_name("20004")
    for folder in (killed, used, starting, robots, far):
        folder.mkdir()
    linked.symlink_to(far)
    for folder in (killed, used, far):
        for name in ("base-1", "base-1.lock"):
            (folder / name).touch()
            os.utime(folder / name, (0, 0))
    for folder in (killed, used, robots, far):
        os.utime(folder, (0, 0))
    os.utime(linked, (0, 0), follow_symlinks=False)
    (own / "base-1.lock").touch()  # its parts have just ended
    with (used / "base-1.lock").open("rb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        remove_run_sockets(network)
    assert {*own.parent.iterdir()} == {used, starting, robots, far, linked}
    assert len([*used.iterdir(), *far.iterdir()]) == 4
