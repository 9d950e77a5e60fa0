"""Runs `board.py` for one board, under sanitizers."""

import os
import sys

import msgspec

from giraff_sim.board import ROOT
from tests.firmware.builds import sanitized
from tests.firmware.test_noise import sanitizer_runtime
from tests.fuzz.board import BoardCounted
from tests.support.tools import finished


def fuzz_board(board: str, wanted: int, seed: int) -> BoardCounted:
    """Throw `wanted` bytes at a board. AssertionError when a sanitizer has found something."""
    # Python itself is not sanitized: the runtime comes first, and Python's own leaks are not this test's business.
    # What Python frees shall not be kept for the sanitizer's sake either.
    options = "detect_leaks=0:quarantine_size_mb=1"
    [library] = sanitized(board)
    environment = os.environ | {"LD_PRELOAD": sanitizer_runtime(library), "ASAN_OPTIONS": options}
    command = [sys.executable, "-m", "tests.fuzz.board", str(library), f"{seed}/{board}", str(wanted)]
    return msgspec.json.decode(finished(command, env=environment, cwd=ROOT, check=True).stdout, type=BoardCounted)
