"""Text with colours and columns on standard output."""

from __future__ import annotations

import errno
import os
import sys
from typing import Final, NoReturn

from rich.console import Console

_PIPE_WIDTH: Final = 1000  # characters: a line stays a line for whoever searches them


class Page(Console):
    """As wide as the terminal; colourless, and as wide as it takes, in a pipe."""

    def __init__(self) -> None:
        super().__init__(highlight=False, width=None if sys.stdout.isatty() else _PIPE_WIDTH)

    def on_broken_pipe(self) -> NoReturn:
        """Leave it to whoever prints: Rich would end the program here, and Zenoh's session with it, or never."""
        raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))
