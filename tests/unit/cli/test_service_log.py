"""A service's log: each of its lines is read, and the last ones tell why it ended."""

import os
from pathlib import Path

import pytest

from giraff_cli.run.processes import bound
from giraff_tools.terminal.service_log import Entry, cause_of, read_entry


def line(level: str, message: str) -> str:
    return f'{{"time":"1970-01-01T00:00:05.250Z","level":"{level}","service":"web","message":"{message}"}}'


IN_USE = line("error", "port 18099 is in use: end what listens there")
TRACEBACK = ("Traceback (most recent call last):", '  File "main.py", line 1', "ValueError: 3 is no port", "")
FATAL = ("Fatal Python error: Segmentation fault", "", "Current thread 0x00 (most recent call first):", "  File x", "")


@pytest.mark.parametrize(
    ("lines", "crashed", "cause"),
    [
        ((line("info", "here"), IN_USE, line("info", "ended")), False, "port 18099 is in use: end what listens there"),
        ((IN_USE, *TRACEBACK), False, "ValueError: 3 is no port"),
        ((line("error", "Traceback (most recent call last):\\n  File x\\nOSError: gone\\n"),), False, "OSError: gone"),
        ((IN_USE[:-8],), False, "port 18099 is in use: end what listens"),
        ((line("info", "here"), *FATAL, "Extension modules: zenoh"), True, "Fatal Python error: Segmentation fault"),
        ((IN_USE, line("info", "recovered")), True, ""),
        (("terminate called: what(): no memory", IN_USE, "x" * 2000), True, "x" * 500 + "…"),
        ((), False, ""),
    ],
)
def test_why_it_ended_is_its_own_last_error(lines: tuple[str, ...], *, crashed: bool, cause: str) -> None:
    assert cause_of(lines, crashed=crashed) == cause


def test_a_line_without_a_level_is_an_error_of_who_wrote_the_log() -> None:
    assert read_entry(line("warning", "\\u001b[2J low"), "", 1.0) == Entry(5.25, "web", "warning", "\x1b[2J low")
    assert read_entry("Traceback", "web", 1.0) == Entry(1.0, "web", "error", "Traceback")


def test_a_log_without_bounds_frees_its_beginning_and_loses_nothing_that_is_written_meanwhile(tmp_path: Path) -> None:
    log = tmp_path / "web.log"
    with log.open("wb", buffering=0) as writer:
        writer.write(b"a" * 900_000)
        os.fsync(writer.fileno())
        bound(log, most=200_000)
        writer.write(b"the last word")
        os.fsync(writer.fileno())
    assert log.stat().st_blocks * 512 < 400_000
    told = log.read_bytes()
    assert told.endswith(b"a" * 200_000 + b"the last word")
    assert told.startswith(b"\0" * 600_000)
