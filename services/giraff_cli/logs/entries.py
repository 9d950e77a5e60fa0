"""Entries of the journal and of containers; their order; how they are shown. No I/O and no clock."""

import re
from collections import deque
from collections.abc import Iterable
from datetime import UTC, datetime, time, timedelta
from typing import Any, Final

import msgspec

from giraff_schemas.text import printable
from giraff_tools.terminal.service_log import LAST_MOMENT, Entry, moment_of, read_entry
from giraff_tools.terminal.text import json_line

_UNIT: Final = re.compile(r"giraff@(.+)\.service")
_BY_PRIORITY: Final = ("critical", "critical", "critical", "error", "warning", "info", "info", "debug")
_OWN_STREAM: Final = "stdout"  # the journal's word for both outputs of a service
_AGO: Final = re.compile(r"(\d+(?:\.\d+)?)\s*(s|min|m|h|d)")
_CLOCK: Final = re.compile(r"\d\d:\d\d(:\d\d)?")
_SECONDS: Final = {"s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
_COLOURS: Final = {"warning": "\x1b[33m", "error": "\x1b[31m", "critical": "\x1b[31m"}
_PLAIN: Final = "\x1b[0m"
_SERVICE: Final = 12  # characters of its column


def since_moment(text: str, now: float) -> float:
    """Return s since 1970, of `10min`, `14:30` or a date with a time. Raises ValueError."""
    word = text.strip()
    try:
        if ago := _AGO.fullmatch(word):
            return max(0.0, now - float(ago[1]) * _SECONDS[ago[2]])
        if _CLOCK.fullmatch(word):
            today = _local(now)
            at = datetime.combine(today, time.fromisoformat(word)).astimezone()
            return (at if at <= today else at - timedelta(days=1)).timestamp()  # 23:50, asked after midnight
        return datetime.fromisoformat(word).timestamp()
    except (ValueError, OverflowError, OSError):
        raise ValueError(f"{text!r} is no time: give one like 10min, 2h, 14:30 or 2026-05-31T14:30") from None


def journal_entry(line: str, now: float) -> Entry | None:
    """Return the entry of a line of `journalctl -o json`. None: it is no unit's of Giraff.

    `now`: for a line whose time no clock can have shown.
    """
    try:
        fields: Any = msgspec.json.decode(line)
    except (msgspec.MsgspecError, UnicodeEncodeError, RecursionError):
        return None
    if not isinstance(fields, dict):
        return None
    units = (_UNIT.fullmatch(str(fields.get(name))) for name in ("_SYSTEMD_UNIT", "UNIT"))
    unit = next(filter(None, units), None)
    stamp, priority = str(fields.get("__REALTIME_TIMESTAMP")), str(fields.get("PRIORITY"))
    if unit is None or not stamp.isdecimal():
        return None
    words, at = _message(fields.get("MESSAGE")), float(stamp) * 1e-6
    if at >= LAST_MOMENT:
        at = now
    if fields.get("_TRANSPORT") == _OWN_STREAM:
        return read_entry(words, unit[1], at)
    level = _BY_PRIORITY[int(priority)] if re.fullmatch("[0-7]", priority) else "info"
    return Entry(at, unit[1], level, words)


def run_text(folder: str, ended: float, now: float) -> str:
    """Return which run is shown where none goes on. `ended`, `now`: s since 1970."""
    at = _local(ended)
    date = "" if at.date() == _local(now).date() else f"on {at:%Y-%m-%d} "
    return f"no run goes on; shown is the run in {folder} that ended {date}at {at:%H:%M}"


def _message(field: Any) -> str:
    """Return the text of a field. The journal writes bytes as numbers, and a field that is there twice as a list."""
    if not isinstance(field, list):
        return "" if field is None else str(field)
    if all(isinstance(each, int) and 0 <= each < 256 for each in field):
        return bytes(field).decode(errors="replace")
    return "\n".join(map(_message, field))


def container_entry(line: str, service: str, now: float) -> Entry:
    """Return the entry of a line of `docker logs --timestamps`. `now`: for Docker's own words, which have no time."""
    stamp, _, words = line.partition(" ")
    at = moment_of(stamp, -1.0)
    return read_entry(words, service, at) if at >= 0.0 else read_entry(line, service, now)


class Merge:
    """Puts the entries of several sources in order of time. It does not wait for a source that has nothing to say."""

    def __init__(self, patience: float) -> None:
        """`patience`: s for which a source may keep the others waiting."""
        self._patience = patience
        self._waiting: dict[object, deque[Entry]] = {}
        self._heard: dict[object, float] = {}
        """Monotonic s at which each open source wrote, or was opened."""

    def open(self, source: object, now: float) -> None:
        """Take a source in. `now`: monotonic, s."""
        self._waiting.setdefault(source, deque())
        self._heard[source] = now

    def add(self, source: object, entries: Iterable[Entry], now: float) -> None:
        """Take entries of a source, in its own order."""
        self._waiting[source].extend(entries)
        self._heard[source] = now

    def end(self, source: object) -> None:
        """Nothing more comes of it."""
        self._heard.pop(source, None)

    def waiting(self, source: object) -> int:
        """Return how many entries of a source wait for the others."""
        return len(self._waiting[source])

    def is_overdue(self, source: object, now: float) -> bool:
        """Return whether an open source has been silent for longer than the others wait."""
        return now - self._heard.get(source, now) >= self._patience

    def pop_due(self, now: float) -> list[Entry]:
        """Return the entries whose place in the order is certain, or that have waited long enough."""
        taken: list[Entry] = []
        while heads := [queue for queue in self._waiting.values() if queue]:
            if any(not self._waiting[each] and not self.is_overdue(each, now) for each in self._heard):
                break
            taken.append(min(heads, key=lambda queue: queue[0].time).popleft())
        for source in [each for each, queue in self._waiting.items() if not queue and each not in self._heard]:
            del self._waiting[source]
        return taken


def line_of(entry: Entry, *, colours: bool) -> str:
    """Return an entry as people read it. What follows its first line stands below that, further in."""
    at = f"{_local(entry.time):%Y-%m-%d %H:%M:%S.%f}"[:-3]
    first, *others = map(printable, entry.words.rstrip("\n").split("\n"))
    colour = _COLOURS.get(entry.level, "") if colours else ""
    level = f"{colour}{entry.level:<8}{_PLAIN}" if colour else f"{entry.level:<8}"
    head = f"{at} {printable(entry.service):<{_SERVICE}} {level} {first}".rstrip()
    return "\n".join([head, *(f"    {line}" for line in others)])


def json_of(entry: Entry) -> str:
    """Return an entry as a JSON object on one line."""
    at = _local(entry.time).isoformat(timespec="milliseconds")
    return json_line({"time": at, "service": entry.service, "level": entry.level, "message": entry.words})


def _local(at: float) -> datetime:
    return datetime.fromtimestamp(at, UTC).astimezone()
