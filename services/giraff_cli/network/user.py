"""Who runs this command."""

from __future__ import annotations

import getpass
import os
import socket


def user_at_host() -> str:
    """Whom to name to those who ask who it was."""
    try:
        user = getpass.getuser()
    except (OSError, KeyError):  # a container's user may have no name
        user = str(os.getuid())
    return f"{user}@{socket.gethostname()}"
