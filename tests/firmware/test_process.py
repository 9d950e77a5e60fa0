"""A board that is a process: each mistake in its words is refused before anything is sent to the motors."""

import fcntl
import os
from pathlib import Path
from typing import Final

import pytest

from giraff_sim.board import BUILD
from tests.support.tools import finished

WORDS: Final = {"--line": "tty", "--port": "port", "--eeprom": "eeprom"}


@pytest.mark.parametrize(
    ("changes", "code", "complaint"),
    [
        ({"--baud": "9600"}, 2, "--baud is none of its options\nusage: roboclaw --line TTY --port LINK --eeprom FILE"),
        (
            {"--eeprom": "/dev/full"},
            1,
            "/dev/full cannot be written (No space left on device). It keeps an emergency stop",
        ),
        ({"--eeprom": "other"}, 1, "other is some other file, since it is longer than 8 bytes: name another one"),
        ({"--port": "other"}, 1, "other is there, and is no board's port: name another path"),
        ({"--port": "taken"}, 1, "taken is the port of another board, or cannot be: end that, or name another path"),
        ({}, 1, "tty is in use by another program: end it"),
    ],
)
def test_a_mistake_is_named_with_its_remedy(tmp_path: Path, changes: dict[str, str], code: int, complaint: str) -> None:
    program = BUILD / "firmware" / "roboclaw"
    (tmp_path / "other").write_text("somebody's file")
    (tmp_path / "eeprom").write_bytes(b"\xff" * 8)
    taken = os.open(tmp_path / "taken.lock", os.O_CREAT | os.O_RDWR)
    fcntl.flock(taken, fcntl.LOCK_EX)
    master, line = os.openpty()
    fcntl.flock(line, fcntl.LOCK_EX)
    (tmp_path / "tty").symlink_to(os.ttyname(line))
    words = [word for name, value in (WORDS | changes).items() for word in (name, value)]
    done = finished([program, *words], cwd=tmp_path)
    os.set_blocking(master, False)
    with pytest.raises(BlockingIOError):
        os.read(master, 1)  # nothing was sent
    os.close(taken)
    os.close(line)
    os.close(master)
    assert (done.returncode, done.stdout) == (code, "")
    assert done.stderr.startswith("roboclaw: ")
    assert complaint in done.stderr
    assert (tmp_path / "other").read_text() == "somebody's file"
