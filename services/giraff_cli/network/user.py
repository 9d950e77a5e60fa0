"""Who runs this command."""

from __future__ import annotations

import getpass
import os
import socket

from giraff_schemas.text import printable


def user_at_host() -> str:
    """Return whom to name to those who ask who it was. Bytes of another locale could not be sent, and become "?"."""
    try:
        user = getpass.getuser()
    except (OSError, KeyError):  # a container's user may have no name
        user = str(os.getuid())
    return printable(f"{user}@{socket.gethostname()}")
