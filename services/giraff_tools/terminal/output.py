"""Standard output of a command, which whoever reads it may close, and a full disk refuse."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from collections.abc import Callable
from typing import Final, TextIO

DONE: Final = 0
UNWRITABLE: Final = 1
_READER_GONE: Final = (errno.EPIPE, errno.EIO)  # a pipe's, a terminal's


def is_drawn_on(stream: TextIO) -> bool:
    """Return whether a stream is a terminal that knows colours and a cursor."""
    return stream.isatty() and os.environ.get("TERM", "dumb") != "dumb"


def guard_stdout(act: Callable[[], int], *, unfinished: str = "") -> int:
    """The exit code of `act`, which prints: DONE if it has lost its reader, which is no fault.

    UNWRITABLE, and a word, if standard output takes nothing for another reason. `unfinished`: said where the reader
    goes before `act` has ended, which then is UNWRITABLE, too.
    """
    code: int | None = None
    try:
        code = act()
        sys.stdout.flush()
    except OSError as error:
        if error.filename is not None:
            raise
        discard_stdout()
        if error.errno not in _READER_GONE:
            print(f"giraff: cannot write to standard output: {error.strerror}", file=sys.stderr, flush=True)
            return UNWRITABLE
        if code is None and unfinished:
            with contextlib.suppress(OSError):  # both may have had one reader
                print(unfinished, file=sys.stderr, flush=True)
            return UNWRITABLE
    return DONE if code is None else code


def discard_stdout() -> None:
    """Nobody takes standard output any more: forget what waits there, or Python complains of it at its exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
