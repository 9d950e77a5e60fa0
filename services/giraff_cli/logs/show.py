"""`giraff logs`: reads the sources of this host until they end, or until Ctrl-C."""

import errno
import math
import os
import select
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Final

from giraff_cli.logs.entries import Merge, json_of, line_of, run_text, since_moment
from giraff_cli.logs.sources import SOURCES, LogFile, Program, Stream, Wanted
from giraff_node.config.robot_file import suggestion
from giraff_schemas.services import SERVICES
from giraff_schemas.text import printable
from giraff_tools.terminal.output import DONE, guard_stdout, is_drawn_on
from giraff_tools.terminal.service_log import LEVELS, Entry
from giraff_tools.terminal.signals import StopSignal

_REFUSED: Final = 2
_LOOK_EVERY: Final = 0.2  # s
_FIND_EVERY: Final = 5.0  # s between looks for containers and logs that have come since
_PATIENCE: Final = 5.0  # s
_PATIENCE_FOLLOWING: Final = 0.4  # s; somebody watches
_MOST_WAITING: Final = 2000  # entries of a source that are read before their turn
_SIMULATED: Final = ("simulator", "simulated-camera")
"""Processes of `giraff run` that are no services."""


def show(services: Sequence[str], *, follow: bool, level: str, since: str | None, as_json: bool) -> int:
    """Show the entries; the exit code."""
    known = [*(service.name for service in SERVICES if service.entry), *_SIMULATED]
    for service in services:
        if service not in known:
            return _refuse(f"there is no service {service!r}{suggestion(service, known)}")
    try:
        begin = None if since is None else since_moment(since, time.time())
    except ValueError as error:
        return _refuse(f"--since: {error}")
    with StopSignal() as stopping:
        reading = _Reading(Wanted(services, follow, begin), level, as_json=as_json)
        try:
            if why := reading.find():
                return _refuse(why)
            return guard_stdout(lambda: reading.run(stopping))
        finally:
            reading.close()


def _refuse(why: str) -> int:
    _warn(why)
    return _REFUSED


def _warn(what: str) -> None:
    print(printable(f"giraff logs: {what}"), file=sys.stderr, flush=True)


class _Reading:
    """The streams that are open, and what has been read of them."""

    def __init__(self, wanted: Wanted, level: str, *, as_json: bool) -> None:
        self._wanted = wanted
        self._rank = LEVELS[level]
        self._as_json = as_json
        self._colours = is_drawn_on(sys.stdout) and not os.environ.get("NO_COLOR")
        self._sources = [*SOURCES]
        self._streams: list[Stream] = []
        self._seen: dict[str, float] = {}
        """By name of each stream that has been opened: s since 1970 of its last entry before it ended; else 0."""
        self._last: dict[str, float] = {}
        """By name of stream: s since 1970 of its newest entry."""
        self._merge = Merge(_PATIENCE_FOLLOWING if wanted.follow else _PATIENCE)

    def find(self) -> str:
        """Open what is there and not open yet. Return why there is nothing, with the remedy."""
        is_first = not self._seen
        open_now = {stream.name: math.inf for stream in self._streams}
        wanted = self._wanted if is_first else self._wanted._replace(since=0.0, seen=self._seen | open_now)
        troubles = []
        asked = list(self._sources)
        with ThreadPoolExecutor(len(asked)) as pool:  # at once: each may take some seconds to say nothing
            answers = list(pool.map(lambda source: source(wanted), asked))
        for source, (found, trouble) in zip(asked, answers, strict=True):
            if trouble:  # it is not asked again: one that hangs would hold up the rest each time
                troubles.append(trouble)
                self._sources.remove(source)
            for stream in found:
                self._streams.append(stream)
                self._seen.setdefault(stream.name, 0.0)
                self._merge.open(stream.name, time.monotonic())
        if not is_first:
            for trouble in troubles:
                _warn(f"{trouble}; what starts from here on is left out")
        elif shown := [each for each in self._streams if isinstance(each, LogFile) and each.ended is not None]:
            _warn(run_text(shown[0].folder, shown[0].ended or 0.0, time.time()))
        if self._streams or not is_first:
            return ""
        if troubles:
            return "; ".join(map(str, troubles))
        of = f" of {', '.join(self._wanted.services)}" if self._wanted.services else ""
        return f"nothing{of} is in the journal, in a container or of a run on this host; start one with giraff run"

    def run(self, stopping: StopSignal) -> int:
        """Print until all has ended; DONE. Raises OSError where nobody reads any more."""
        find_at = time.monotonic() + _FIND_EVERY
        while not stopping.asked and (self._streams or self._wanted.follow):
            self._wait()
            for stream in list(self._streams):
                self._read(stream)
            self._print(self._merge.pop_due(time.monotonic()))
            if self._wanted.follow and time.monotonic() >= find_at:
                self.find()
                find_at = time.monotonic() + _FIND_EVERY
        if not stopping.asked:
            self._print(self._merge.pop_due(math.inf))
        return DONE

    def close(self) -> None:
        """End the programs and close the files."""
        for stream in self._streams:
            stream.close()

    def _wait(self) -> None:
        """Wait for more. Raises BrokenPipeError when whoever reads has gone."""
        ready = [each for each in self._streams if self._merge.waiting(each.name) < _MOST_WAITING]
        programs = [each for each in ready if isinstance(each, Program)]
        has_more = any(isinstance(each, LogFile) and each.has_more for each in ready)
        select.select(programs, [], [], 0.0 if has_more else _LOOK_EVERY)
        reader = select.poll()
        reader.register(sys.stdout, 0)
        if any(event & select.POLLERR for _, event in reader.poll(0)):
            raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))

    def _read(self, stream: Stream) -> None:
        now, waiting = time.monotonic(), self._merge.waiting(stream.name)
        if waiting < _MOST_WAITING and (entries := stream.read()):
            self._merge.add(stream.name, [each for each in entries if each.time > self._seen[stream.name]], now)
            self._last[stream.name] = max(self._last.get(stream.name, 0.0), *(each.time for each in entries))
        elif not self._wanted.follow and not waiting and self._merge.is_overdue(stream.name, now):
            _warn(f"{stream.name} has said nothing for {_PATIENCE:g} s, and is left out from here on")
            stream.has_ended = True
        if stream.has_ended:
            stream.close()
            self._streams.remove(stream)
            self._merge.end(stream.name)
            self._seen[stream.name] = self._last.get(stream.name, 0.0)

    def _print(self, entries: Sequence[Entry]) -> None:
        since = self._wanted.since or 0.0
        for entry in entries:
            if entry.time >= since and LEVELS[entry.level] >= self._rank:
                print(json_of(entry) if self._as_json else line_of(entry, colours=self._colours))
        if entries:
            sys.stdout.flush()
