"""Runs `board.py` for one board, under sanitizers."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Final

import msgspec

from giraff_sim.board import ROOT
from tests.firmware.builds import sanitized
from tests.firmware.test_noise import sanitizer_runtime
from tests.fuzz.growth import LIMIT

BOARDS: Final = ("base", "joystick", "ranger")


class BoardCounted(msgspec.Struct, frozen=True, kw_only=True):
    """What `board.py` prints."""

    board: str
    bytes: int
    simulated_s: float
    active_reports: int | None
    """Of the base board: reports of a board that would have driven."""
    peak_counts: int
    torn: int
    complaints: int
    growth_bytes: int


def fuzz_board(board: str, wanted: int, seed: int) -> BoardCounted:
    """Throw `wanted` bytes at a board. AssertionError when a sanitizer has found something."""
    # Python itself is not sanitized: the runtime comes first, and Python's own leaks are not this test's business.
    # What Python frees shall not be kept for the sanitizer's sake either.
    options = "detect_leaks=0:quarantine_size_mb=1"
    environment = os.environ | {"LD_PRELOAD": sanitizer_runtime(), "ASAN_OPTIONS": options}
    library = sanitized() / "host" / f"{board}.so"
    command = [sys.executable, "-m", "tests.fuzz.board", str(library), f"{seed}/{board}", str(wanted)]
    done = subprocess.run(command, check=False, capture_output=True, text=True, env=environment, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return msgspec.json.decode(done.stdout, type=BoardCounted)


def require_harmless(counted: BoardCounted) -> None:
    assert counted.peak_counts == 0, "noise drives"
    assert (counted.torn, counted.complaints) == (0, 0), counted
    assert counted.growth_bytes < LIMIT, counted
    assert counted.active_reports is None or counted.active_reports > counted.simulated_s * 20, "it would have driven"
