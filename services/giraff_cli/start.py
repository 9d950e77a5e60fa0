"""Entry point of the `giraff` command: ready for Ctrl-C before anything slow is imported."""

import io
import signal
import sys


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

    sys.exit(obey(app))
