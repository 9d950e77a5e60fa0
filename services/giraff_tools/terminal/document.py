"""The JSON document of a command that talks with a person before it can tell anything to a program."""

import contextlib
import sys
from collections.abc import Callable
from typing import Any, Final, TextIO

from giraff_tools.terminal.output import DONE, guard_stdout
from giraff_tools.terminal.text import json_page

REFUSED: Final = 1
UNUSABLE: Final = 2
INTERRUPTED: Final = 130
"""Exit codes, beside DONE."""

Report = Callable[[Any], None]
"""Takes the document of a command. The last one counts."""


def no_report(_document: Any) -> None:
    """Drop a document that no program has asked for."""


def complain(command: str, reason: str, code: int) -> int:
    """Print on standard error, in one line, why a command ends; return the code."""
    print(f"giraff {command}: {reason}", file=sys.stderr, flush=True)
    return code


def print_report(act: Callable[[Report], int], *, as_json: bool) -> int:
    """Return the exit code of `act`. With `as_json` its talk goes to standard error, and its document is printed.

    Nothing is printed where `act` reports no document.
    """
    documents: list[Any] = []
    out = sys.stdout
    with contextlib.redirect_stdout(sys.stderr if as_json else out):
        code = act(documents.append)
    if not (as_json and documents):
        return code
    return guard_stdout(lambda: _print(documents[-1], out)) or code


def _print(document: Any, out: TextIO) -> int:
    print(json_page(document), file=out)
    return DONE
