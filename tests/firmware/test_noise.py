"""Noise neither crashes a board nor drives a motor, nor do extremes overflow one: the boards' C under sanitizers."""

import os
import re
import sys
from pathlib import Path

from giraff_sim.board import ROOT
from tests.firmware.builds import sanitized, sanitized_roboclaw
from tests.support.tools import finished

SESSIONS = 60


def sanitizer_runtime(library: Path) -> str:
    """Return the runtime that a sanitized library needs, by the name that the loader finds it by."""
    needed = re.search(rb"libasan\.so\.\d+", library.read_bytes())
    assert needed
    return needed[0].decode()


def told_by(program: str, library: Path, *words: str) -> list[int]:
    """Return what a program prints that does something to the C of this board and others under sanitizers."""
    # Python itself is not sanitized: the runtime comes first, and Python's own leaks are not this test's business.
    environment = os.environ | {"LD_PRELOAD": sanitizer_runtime(library), "ASAN_OPTIONS": "detect_leaks=0"}
    command = [sys.executable, "-m", f"tests.firmware.{program}", *words]
    return [int(word) for word in finished(command, env=environment, cwd=ROOT, check=True).stdout.split()]


def test_noise_does_nothing() -> None:
    throw_noise(6_000)


def throw_noise(milliseconds: int) -> None:
    """Throw noise at each board, and look at what its program says."""
    libraries = [*sanitized("base", "joystick", "ranger", "balancer"), sanitized_roboclaw()]
    line_errors = told_by("noise", libraries[0], str(milliseconds), *map(str, libraries))
    assert [errors > 100 for errors in line_errors] == [True] * len(libraries)


def test_no_settings_and_no_wheels_overflow_the_speed_control() -> None:
    """Nor does any of them give a motor more than its most, or anything of the other sign."""
    [base] = sanitized("base")
    opened, driven = told_by("extremes", base, str(base), "1", str(SESSIONS))
    assert opened > SESSIONS / 3
    assert driven > SESSIONS / 4
