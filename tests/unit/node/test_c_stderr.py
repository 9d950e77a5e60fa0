"""C libraries are silent for a moment, and nobody else is."""

import ctypes
import os
import sys

import pytest

from giraff_node.process.c_library import muted_c_stderr


def test_only_c_libraries_are_silent_and_for_that_moment_only(capfd: pytest.CaptureFixture[str]) -> None:
    perror = ctypes.CDLL(None).perror
    with muted_c_stderr():
        perror(b"lost")
        os.write(2, b"descriptor\n")
        print("python", file=sys.stderr, flush=True)
    perror(b"heard")
    lines = capfd.readouterr().err.splitlines()
    assert [line.partition(":")[0] for line in lines] == ["descriptor", "python", "heard"]
