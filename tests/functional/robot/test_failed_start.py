"""A robot of processes that does not start: nothing of it stays, and it says why."""

import threading
from contextlib import suppress
from pathlib import Path

import pytest

from tests.support.process_robot import PATIENCE, process_robot
from tests.support.waiting import wait


def processes_of(directory: Path) -> list[int]:
    found = []
    for entry in Path("/proc").iterdir():
        with suppress(OSError):
            if entry.name.isdigit() and f"={directory}/".encode() in (entry / "environ").read_bytes():
                found.append(int(entry.name))
    return found


@pytest.mark.parametrize("apart", [False, True])
def test_what_began_before_has_ended_and_the_simulator_s_word_is_told(tmp_path: Path, *, apart: bool) -> None:
    threads = threading.active_count()
    with (
        pytest.raises(AssertionError, match=r"(?s)simulator ended by itself.*world\.toml: "),
        process_robot(tmp_path, "no world", apart=apart),
    ):
        raise AssertionError("it began without a world")
    wait(lambda: threading.active_count() == threads, PATIENCE, what="the end of the Zenoh session")
    assert not processes_of(tmp_path)
