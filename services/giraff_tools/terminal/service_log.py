"""The lines that services write: `giraff_node.process.logs` as JSON, and Python or a library as plain text.

No I/O. Times are seconds since 1970.
"""

import re
from collections.abc import Sequence
from datetime import datetime
from typing import Final

import msgspec

LEVELS: Final = {"debug": 0, "info": 1, "warning": 2, "error": 3, "critical": 4}
"""Ranks of the levels: the higher, the worse."""
_NO_LEVEL: Final = "error"
"""Level of plain text. A service writes none: Python or a library has, of a fault."""
LAST_MOMENT: Final = 4.1e9  # s since 1970: the year 2099
_LONGEST: Final = 500  # characters of a cause that is told on one line
_TORN: Final = re.compile(r'\{"time":"([^"]*)","level":"(\w+)","service":"([^"]*)","message":"(.*)')
_CRASH: Final = "Fatal Python error"
_NO_CAUSE: Final = ("Current thread 0x", "Thread 0x", "Extension modules:")


class Entry(msgspec.Struct, frozen=True):
    """What a service wrote at one moment."""

    time: float
    """s since 1970."""
    service: str
    level: str
    words: str
    """One line or more, with the control characters that they had."""


class _Line(msgspec.Struct):
    time: str
    level: str
    service: str
    message: str
    traceback: str = ""


def read_entry(line: str, service: str, at: float) -> Entry:
    """Return the entry of a line. `service`, `at`: who wrote it, and when, where the line does not say so."""
    found = _decoded(line)
    if found is None:
        return Entry(at, service, _NO_LEVEL, line.rstrip("\r"))
    words = found.message + (f"\n{found.traceback}" if found.traceback else "")
    level = found.level if found.level in LEVELS else _NO_LEVEL
    return Entry(moment_of(found.time, at), service or found.service, level, words)


def moment_of(text: str, otherwise: float) -> float:
    """Return the moment of a date and time in ISO 8601; `otherwise` where it is none that a clock can have shown."""
    try:
        at = datetime.fromisoformat(text).timestamp()
    except (ValueError, OverflowError, OSError):
        return otherwise
    return at if 0.0 <= at < LAST_MOMENT else otherwise


def cause_of(lines: Sequence[str], *, crashed: bool) -> str:
    """Return why a process ended, in its own words, by the last lines of its log. Empty: it did not say.

    `crashed`: a signal ended it. What it wrote of earlier errors is then no cause.
    """
    plain: list[str] = []
    for line in reversed(lines):
        found = _decoded(line)
        if found is None:
            plain.append(line)
            continue
        if told := _cause_in(plain):
            return told
        plain = []
        if crashed:
            return ""
        if LEVELS.get(found.level, 0) >= LEVELS["error"]:
            return _shortened(_last(found.message) if "\nTraceback (most" in f"\n{found.message}" else found.message)
    return _cause_in(plain)


def _cause_in(plain: Sequence[str]) -> str:
    """`plain`: lines of no service, the last one first."""
    crash = next((line for line in plain if line.startswith(_CRASH)), "")
    causes = (line for line in plain if line.strip() and not line[0].isspace() and not line.startswith(_NO_CAUSE))
    return _shortened(crash or next(causes, ""))


def _last(text: str) -> str:
    return next((line for line in reversed(text.split("\n")) if line.strip()), "")


def _shortened(text: str) -> str:
    line = text.strip().partition("\n")[0]
    return line if len(line) <= _LONGEST else f"{line[:_LONGEST]}…"


def _decoded(line: str) -> _Line | None:
    """Return the parts of a service's line, also of one that its end cut off. None: it is another's."""
    try:
        return msgspec.json.decode(line, type=_Line)
    except (msgspec.MsgspecError, UnicodeEncodeError, RecursionError):
        torn = _TORN.match(line)
        return None if torn is None else _Line(torn[1], torn[2], torn[3], torn[4])
