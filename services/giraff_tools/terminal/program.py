"""How this very program is called by a person, and by whom."""

import getpass
import os
import shlex
import shutil
import socket
import sys
from collections.abc import Container
from itertools import pairwise
from pathlib import Path
from typing import Final

from giraff_schemas.text import printable

_NAME: Final = "giraff"


def called_here() -> list[str]:
    """The words that call it in this terminal, as they were typed."""
    name = Path(sys.argv[0]).name
    return [name if shutil.which(name) else sys.argv[0]]


def called_anywhere() -> list[str]:
    """The words that call it in another terminal, which stands in any folder and knows nothing of this one's."""
    program = Path(sys.executable).with_name(_NAME)
    if not program.is_file():
        return [sys.executable, "-m", "giraff_cli"]
    on_path = shutil.which(_NAME)
    # An activated environment is on the path of its own terminal alone.
    if on_path is not None and not os.environ.get("VIRTUAL_ENV") and program.samefile(on_path):
        return [_NAME]
    return [str(program)]


def redirected(stray: Container[str]) -> str:
    """Return how `--json FILE` is written, where FILE is among the stray words or in the text; empty: it is not."""
    words = sys.argv[1:]
    for at, (option, file) in enumerate(pairwise(words)):
        if option == "--json" and file in stray:
            typed = shlex.join([*called_here(), *words[: at + 1], *words[at + 2 :]])
            return f"--json prints; write it as: {typed} > {shlex.quote(file)}"
    return ""


def user_at_host() -> str:
    """Return whom to name to those who ask who it was. Bytes of another locale could not be sent, and become "?"."""
    try:
        user = getpass.getuser()
    except (OSError, KeyError):  # a container's user may have no name
        user = str(os.getuid())
    return printable(f"{user}@{socket.gethostname()}")
