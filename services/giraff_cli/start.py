"""Entry point of the `giraff` command: ready for Ctrl-C before anything slow is imported."""

import atexit
import io
import os
import signal
import sys
from importlib.util import find_spec

_REFUSED = 2
_FAILED = 1  # as Python's own after an exception that nobody catches


def main() -> None:
    if find_spec("typer") is None:
        from giraff_node.process.libraries import remedy  # noqa: PLC0415

        print(f"giraff: the library typer is missing; {remedy('cli')}", file=sys.stderr)
        sys.exit(_REFUSED)
    # Python's own handler would raise in whatever is being imported, and show that. A command that has something to
    # end first takes the signals over when it begins.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # A stop is confirmed by its exit code, also where whoever began it has closed an output.
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115  as long as the process
    # A letter that the locale's encoding lacks must not end a command: least of all a stop.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    asks_completion = os.environ.pop("_GIRAFF_COMPLETE", "")
    from giraff_cli.main import app  # noqa: PLC0415
    from giraff_cli.usage import complete, run_app  # noqa: PLC0415

    try:
        code = complete(app) if asks_completion else run_app(app)
    except Exception as error:  # noqa: BLE001  that nobody foresaw
        sys.excepthook(type(error), error, error.__traceback__)
        code = _FAILED
    end(code, tidily=not asks_completion)


def end(code: int, *, tidily: bool = True) -> None:
    """End the process, without what Python does after a program's last line.

    A session that does not close would keep it from its end. Zenoh's threads live on for a while after one that does,
    and as soon as one of them calls into a Python that is being taken down, the C library aborts the process: a stop
    that is not confirmed would end with 134. `tidily`: libraries may do what they do at an end.
    """
    if tidily:
        atexit._run_exitfuncs()  # noqa: SLF001  of libraries: there is no public way
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):  # what was told has gone nowhere
            code = code or _FAILED
    os._exit(code)
