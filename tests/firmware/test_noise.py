"""Noise on the line neither crashes a board nor drives a motor: the boards' C under sanitizers."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from giraff_sim.board import ROOT
from tests.firmware.builds import sanitized

MILLISECONDS = 20_000


def sanitizer_runtime() -> str:
    command = ["cc", "-print-file-name=libasan.so"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def throw_noise(library: Path, seed: str, milliseconds: int) -> subprocess.CompletedProcess[str]:
    # Python itself is not sanitized: the runtime comes first, and Python's own leaks are not this test's business.
    environment = os.environ | {"LD_PRELOAD": sanitizer_runtime(), "ASAN_OPTIONS": "detect_leaks=0"}
    command = [sys.executable, "-m", "tests.firmware.noise", str(library), seed, str(milliseconds)]
    return subprocess.run(command, check=False, capture_output=True, text=True, env=environment, cwd=ROOT)


@pytest.mark.parametrize("board", ["base", "joystick", "ranger"])
def test_noise_does_nothing(board: str) -> None:
    run = throw_noise(sanitized() / "host" / f"{board}.so", board, MILLISECONDS)
    assert run.returncode == 0, run.stderr
    assert int(run.stdout) > 100, "the noise has reached the board"
