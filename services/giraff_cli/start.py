"""Entry point of the `giraff` command: ready for Ctrl-C before anything slow is imported."""

import contextlib
import io
import os
import signal
import sys
import threading


def main() -> None:
    # Python's own handler would raise in whatever is being imported, and show that. A command that has something to
    # end first takes the signals over when it begins.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # A letter that the locale's encoding lacks must not end a command: least of all a stop.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    from giraff_cli.main import app  # noqa: PLC0415
    from giraff_cli.usage import obey  # noqa: PLC0415
    from giraff_node.network.session import OPENS  # noqa: PLC0415

    code = obey(app)
    if any(thread.name == OPENS for thread in threading.enumerate()):
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError):
                stream.flush()
        os._exit(code)
    sys.exit(code)
