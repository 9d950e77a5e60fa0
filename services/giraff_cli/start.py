"""Entry point of the `giraff` command: ready for Ctrl-C before anything slow is imported."""

import signal
import sys


def main() -> None:
    # Python's own handler would raise in whatever is being imported, and show that. A command that has something to
    # end first takes the signals over when it begins.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    from giraff_cli.main import app  # noqa: PLC0415
    from giraff_cli.usage import obey  # noqa: PLC0415

    sys.exit(obey(app))
