"""Where services of this host write: the journal, containers, and the directories of `giraff run`."""

import contextlib
import math
import os
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

from giraff_cli.logs.entries import container_entry, journal_entry
from giraff_cli.run.directory import run_directories
from giraff_schemas.services import SERVICES
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_tools.terminal.service_log import Entry, read_entry

_CHUNK: Final = 65_536  # bytes
_LONGEST: Final = 1 << 20  # bytes of a line; a longer one is cut there
_ANSWERS_WITHIN: Final = 5.0  # s
_GRACE: Final = 1.0  # s
LAST_LINES: Final = 10
"""Lines of each source that `--follow` begins with."""
_DENIED: Final = ("permission denied", "insufficient permissions", "not seeing messages")
_JOURNAL_DENIED: Final = Trouble(
    "this user may not read the journal",
    "add it to the group systemd-journal (sudo usermod -aG systemd-journal $USER) and log in again, or use sudo",
)
_DOCKER_DENIED: Final = Trouble(
    "this user may not ask Docker",
    "add it to the group docker (sudo usermod -aG docker $USER) and log in again, or use sudo",
)
_CONTAINER: Final = '{{.ID}}\t{{.Label "com.docker.compose.service"}}\t{{.Image}} {{.Command}}'

Parse = Callable[[str], Entry | None]


class _Lines:
    """Whole lines of the bytes that come."""

    def __init__(self) -> None:
        self._rest = b""

    def add(self, data: bytes) -> list[str]:
        """Return the lines that the data completes. No data: the rest, which nothing completes any more."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        if self._rest and (not data or len(self._rest) > _LONGEST):
            lines.append(self._rest)
            self._rest = b""
        return [line.decode(errors="replace") for line in lines]


class Program:
    """Entries that another program prints. It ends with this one."""

    def __init__(self, name: str, command: Sequence[str], parse: Parse, *, errors: bool = False) -> None:
        """`errors`: it prints them to standard error, and what else it prints is nothing here."""
        self.name = name
        self.has_ended = False
        self._parse = parse
        self._lines = _Lines()
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL if errors else subprocess.PIPE,
            stderr=subprocess.PIPE if errors else subprocess.DEVNULL,
            env=_environment(),
        )
        pipe = self._process.stderr if errors else self._process.stdout
        assert pipe is not None  # noqa: S101  as it was asked for
        self._pipe = pipe
        self._out = pipe.fileno()
        os.set_blocking(self._out, False)

    def fileno(self) -> int:
        """Return the descriptor that is readable when there is more."""
        return self._out

    def read(self) -> list[Entry]:
        """Return what there is now. Never waits."""
        try:
            data = os.read(self._out, _CHUNK)
        except BlockingIOError:
            return []
        self.has_ended = not data
        return [entry for line in self._lines.add(data) if (entry := self._parse(line)) is not None]

    def close(self) -> None:
        """End it. Bounded."""
        self._process.terminate()
        try:
            self._process.wait(_GRACE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._pipe.close()


class LogFile:
    """Entries of a log of `giraff run`."""

    def __init__(self, path: Path, *, follow: bool, last: int | None, ended: float | None = None) -> None:
        """`last`: begin with so many lines. None: with all. Raises OSError."""
        self.name = str(path)
        self.folder = str(path.parent)
        self.ended = ended
        """s since 1970, of its run. None: that goes on."""
        self.has_ended = False
        self.has_more = True
        """There may be more to read at once."""
        self._follow = follow
        self._last = last
        self._lines = _Lines()
        # Neither a link nor a pipe: the folder for temporary files is everybody's.
        self._file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        self._at = os.fstat(self._file).st_mtime
        self._service = path.stem
        self._path = path
        if last is not None:
            os.lseek(self._file, max(0, os.fstat(self._file).st_size - _CHUNK), os.SEEK_SET)

    def read(self) -> list[Entry]:
        """Return what there is now."""
        data = os.read(self._file, _CHUNK)
        self.has_more = bool(data)
        if not data and self._follow and self._path.exists():
            return []
        self.has_ended = not data
        # The beginning of a long log may have been freed: it reads as zeros.
        entries: list[Entry] = []
        lines = self._lines.add(data.lstrip(b"\0"))
        for line in lines if self._last is None else lines[-self._last :]:
            entries.append(read_entry(line, self._service, self._at))
            self._at = entries[-1].time
        self._last = None
        return entries

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)


Stream = Program | LogFile


class Wanted(NamedTuple):
    """Which streams are to be opened."""

    services: Sequence[str]
    """Empty: all."""
    follow: bool
    since: float | None
    """s since 1970. None: all, or the last lines of those that are followed."""
    seen: Mapping[str, float] = {}
    """By names of streams that have been opened before: s since 1970 of the last entry of one that has ended; infinite
    for one that is open."""

    def includes(self, service: str) -> bool:
        """Return whether its words are wanted."""
        return not self.services or service in self.services


def journal(wanted: Wanted) -> tuple[list[Stream], Trouble]:
    """Return the stream of the units giraff@*, or why there is none."""
    if wanted.seen:
        return [], NO_TROUBLE  # it knows of new units by itself
    # By name: a pattern would stand for those units alone that the journal knows already.
    names = wanted.services or [service.name for service in SERVICES if service.entry]
    units = [f"--unit=giraff@{name}.service" for name in names]
    command = ["journalctl", "--output=json", "--all", "--no-pager", *units]
    out, trouble = _asked([*command, "--lines=1"], _JOURNAL_DENIED)
    if not out:
        return [], trouble
    begin = [f"--since=@{wanted.since:.6f}"] if wanted.since is not None else []
    goes_on = ["--follow", f"--lines={LAST_LINES}" if wanted.since is None else "--no-tail"] if wanted.follow else []
    return [Program("the journal", [*command, "--quiet", *begin, *goes_on], _journal_entry)], NO_TROUBLE


def containers(wanted: Wanted) -> tuple[list[Stream], Trouble]:
    """Return a stream for each container that docker-compose.yml has made, or why there is none."""
    listing = ["docker", "ps", "--all", "--no-trunc", "--filter=label=com.docker.compose.service"]
    out, trouble = _asked([*listing, f"--format={_CONTAINER}"], _DOCKER_DENIED)
    streams: list[Stream] = []
    for identity, service in containers_in(out):
        name = f"container {identity[:12]} of {service}"
        since = wanted.seen.get(name, wanted.since)
        if wanted.includes(service) and since != math.inf:
            begin = [f"--since={since:.6f}"] if since is not None else []
            goes_on = ["--follow", *([] if begin else [f"--tail={LAST_LINES}"])] if wanted.follow else []
            command = ["docker", "logs", "--timestamps", *begin, *goes_on, identity]
            streams.append(Program(name, command, partial(_container_entry, service=service), errors=True))
    return streams, trouble


def runs(wanted: Wanted) -> tuple[list[Stream], Trouble]:
    """Return a stream for each log of `giraff run`."""
    last = LAST_LINES if wanted.follow and wanted.since is None else None
    streams: list[Stream] = []
    folders, ended = run_directories()
    for log in sorted(log for folder in folders for log in folder.glob("*.log")):
        if wanted.includes(log.stem) and str(log) not in wanted.seen:
            with contextlib.suppress(OSError):  # just gone
                streams.append(LogFile(log, follow=wanted.follow, last=last, ended=ended))
    return streams, NO_TROUBLE


SOURCES: Final = (journal, containers, runs)


def containers_in(listing: str) -> Iterator[tuple[str, str]]:
    """Yield identity and service of each container of Giraff in a list of `docker ps`."""
    for line in listing.splitlines():
        name, _, rest = line.partition("\t")
        service, _, made_of = rest.partition("\t")
        if "giraff" in made_of:
            yield name, service


def _journal_entry(line: str) -> Entry | None:
    return journal_entry(line, time.time())


def _container_entry(line: str, service: str) -> Entry:
    return container_entry(line, service, time.time())


def _environment() -> dict[str, str]:
    return os.environ | {"LC_ALL": "C"}


def _asked(command: Sequence[str], denied: Trouble) -> tuple[str, Trouble]:
    """Return what a program prints, or why it prints nothing. NO_TROUBLE: it is not there, or has nothing."""
    try:
        asked = subprocess.run(
            command,
            check=False,
            capture_output=True,
            timeout=_ANSWERS_WITHIN,
            stdin=subprocess.DEVNULL,
            env=_environment(),
        )
    except subprocess.TimeoutExpired:
        why = f"{command[0]} did not answer within {_ANSWERS_WITHIN:g} s"
        return "", Trouble(why, "see what it says in a terminal of its own")
    except OSError:
        return "", NO_TROUBLE
    complaint = asked.stderr.decode(errors="replace").lower()
    out = asked.stdout.decode(errors="replace")
    return out, denied if not out and any(word in complaint for word in _DENIED) else NO_TROUBLE
