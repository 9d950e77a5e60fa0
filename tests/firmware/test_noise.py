"""Noise on the line neither crashes a board nor drives a motor: the boards' C under sanitizers."""

import os
import sys
from pathlib import Path

import pytest

from giraff_sim.board import ROOT
from tests.firmware.builds import sanitized
from tests.support.tools import finished

MILLISECONDS = 20_000


def sanitizer_runtime() -> str:
    command = ["cc", "-print-file-name=libasan.so"]
    return finished(command, check=True).stdout.strip()


def throw_noise(library: Path, seed: str, milliseconds: int) -> int:
    """How much of it has reached the board."""
    # Python itself is not sanitized: the runtime comes first, and Python's own leaks are not this test's business.
    environment = os.environ | {"LD_PRELOAD": sanitizer_runtime(), "ASAN_OPTIONS": "detect_leaks=0"}
    command = [sys.executable, "-m", "tests.firmware.noise", str(library), seed, str(milliseconds)]
    return int(finished(command, env=environment, cwd=ROOT, check=True).stdout)


@pytest.mark.parametrize("board", ["base", "joystick", "ranger"])
def test_noise_does_nothing(board: str) -> None:
    assert throw_noise(sanitized() / "host" / f"{board}.so", board, MILLISECONDS) > 100
