"""Noise neither crashes a board nor drives a motor, nor do extremes overflow one: the boards' C under sanitizers."""

import os
import re
import sys
from pathlib import Path

import pytest

from giraff_sim.board import ROOT
from tests.firmware.builds import sanitized
from tests.support.tools import finished

MILLISECONDS = 20_000
SESSIONS = 60


def sanitizer_runtime(library: Path) -> str:
    """Return the runtime that a sanitized library needs, by the name that the loader finds it by."""
    needed = re.search(rb"libasan\.so\.\d+", library.read_bytes())
    assert needed
    return needed[0].decode()


def told_by(program: str, board: str, *arguments: str) -> list[int]:
    """What a program prints that does something to a board's C under sanitizers."""
    # Python itself is not sanitized: the runtime comes first, and Python's own leaks are not this test's business.
    library = sanitized() / "host" / f"{board}.so"
    environment = os.environ | {"LD_PRELOAD": sanitizer_runtime(library), "ASAN_OPTIONS": "detect_leaks=0"}
    command = [sys.executable, "-m", f"tests.firmware.{program}", str(library), *arguments]
    return [int(word) for word in finished(command, env=environment, cwd=ROOT, check=True).stdout.split()]


@pytest.mark.parametrize("board", ["base", "joystick", "ranger", "balancer"])
def test_noise_does_nothing(board: str) -> None:
    (line_errors,) = told_by("noise", board, board, str(MILLISECONDS))
    assert line_errors > 100


def test_no_settings_and_no_wheels_overflow_the_speed_control() -> None:
    """Nor does any of them give a motor more than its most, or anything of the other sign."""
    opened, driven = told_by("extremes", "base", "1", str(SESSIONS))
    assert opened > SESSIONS / 3
    assert driven > SESSIONS / 4
