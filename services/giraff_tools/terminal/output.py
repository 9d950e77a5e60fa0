"""What a command writes: its standard output, which whoever reads it may close, and files that are not there yet."""

import contextlib
import errno
import os
import sys
from collections.abc import Callable
from pathlib import Path
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


def require_fresh(path: Path) -> None:
    """Raise ValueError, with the cause and the remedy, unless `write_fresh` can make this file now."""
    try:
        write_fresh(path, "")
        path.unlink()
    except FileExistsError as error:
        raise ValueError(f"{path} is there already: name another file, or delete it first") from error
    except FileNotFoundError as error:
        raise ValueError(f"{path} cannot be written: there is no such folder; make it, or name another") from error
    except OSError as error:
        raise ValueError(f"{path} cannot be written: {error.strerror}; name another file") from error


def write_fresh(path: Path, text: str) -> None:
    """Write a file that is not there yet. A piece of it serves nobody and is deleted."""
    with path.open("x", encoding="utf-8") as fresh:
        try:
            fresh.write(text)
            fresh.flush()
        except OSError:
            path.unlink()
            raise
