"""`giraff play`: says again what a recording holds, in its own order and rhythm, as a robot of another name."""

import secrets
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import msgspec
import zenoh

from giraff_cli.play.reader import Reader, RecordedSample
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.unread import Unread
from giraff_node.network.consent import NoRobotError, print_notice
from giraff_node.network.tokens import Token, watch_tokens
from giraff_schemas.services import PLAY
from giraff_schemas.text import meant
from giraff_schemas.topics import alive_key, key_below
from giraff_tools.network.command import print_error, run_on_network
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.topic_keys import UnknownKeyError, all_below_robot, find_topic, publish_refusal
from giraff_tools.terminal.progress import Progress
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import json_line

_MEET_WITHIN: Final = 1.0  # s, to meet who listens, and a robot of this name
_LOOK_EVERY_NS: Final = 200_000_000
_LONG_SILENCE: Final = 5.0
"""s of waiting that a person is told of."""

_DONE: Final = 0
_STOPPED: Final = 1


class Played(msgspec.Struct, kw_only=True):
    """What came of it."""

    file: str
    robot: str
    samples: int = 0
    seconds: float = 0.0
    latest: float = 0.0
    """s by which the latest sample came too late."""
    ended_by: str = "the end of the recording"
    unread: Unread = msgspec.field(default_factory=Unread)
    """What is missing in the recording."""


def play(
    path: Path,
    robot: str | None,
    connect: Sequence[str],
    topics: Sequence[str],
    rate: float,
    *,
    loop: bool,
    skip_gaps: bool,
    as_json: bool,
) -> int:
    """Until the end, or Ctrl-C; the exit code."""
    try:
        recording = Recording(path, any_format=True)
        topics, _ = all_below_robot(topics, recording.robot, f"{path} is of")
        keys = keys_played(recording, topics)
    except (RecordingError, UnknownKeyError) as error:
        return print_error(str(error))
    name = robot or f"replay-{recording.robot}"
    with StopSignal() as stopping:
        reader = Reader(recording, topics, loop=loop, skip_gaps=skip_gaps)
        begin, end = recording.bounds_ns
        # Nobody knows how much the skipped gaps take.
        progress = Progress("playing", None if loop or skip_gaps else (end - begin) * 1e-9, shown=not as_json)
        played = Played(file=str(path), robot=name)
        return run_on_network(
            name,
            connect,
            lambda met: _play(met, stopping, reader, played, keys, rate, progress, as_json=as_json),
            role="apart",
        )


def keys_played(recording: Recording, topics: Sequence[str]) -> set[str]:
    """Of these patterns. RecordingError: the recording has none of one of them."""
    known = set(recording.keys)
    for pattern in topics:
        if not recording.matching((pattern,)):
            raise RecordingError(
                f"--topics {pattern}: {recording.path} has no such key; {meant(pattern, known)}"
                f"it has {', '.join(sorted(known))}"
            )
    return recording.matching(topics)


class ReplayToken:
    """Of robots of this name: the one that is played, and those that are there."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self._session = session
        self._own = Token(robot, PLAY.name, secrets.token_hex(8))
        self._token: zenoh.LivelinessToken | None = None
        self._tokens: dict[Token, bool] = {}
        self._subscriber = watch_tokens(session, robot, self._tokens.__setitem__)

    def declare(self) -> None:
        """Let the played one be found."""
        self._token = self._session.liveliness().declare_token(alive_key(*self._own))

    @property
    def services(self) -> list[str]:
        """Those that are there, of others."""
        there = [token for token, present in list(self._tokens.items()) if present]
        return sorted({token.service for token in there if token != self._own})


def _play(
    connection: RobotConnection,
    stopping: StopSignal,
    reader: Reader,
    played: Played,
    keys: set[str],
    rate: float,
    progress: Progress,
    *,
    as_json: bool,
) -> int:
    presence = ReplayToken(connection.session, played.robot)
    progress.prepare()
    reader.start()
    stopping.wait(_MEET_WITHIN)
    if why := _refusal(keys, presence.services):
        raise NoRobotError(why)
    presence.declare()
    publishers = Publishers(connection.session, played.robot)
    trouble = ""
    began_ns = time.monotonic_ns()
    looked_ns = began_ns
    while (said := reader.next()) is not None:
        due_ns = began_ns + round(said.at_ns / rate)
        if (silent := (due_ns - time.monotonic_ns()) * 1e-9) > _LONG_SILENCE:
            progress.hide()
            print_notice(
                f"nothing was recorded here; the next sample comes in {silent:.0f} s (--skip-gaps leaves that out)"
            )
        if stopping.wait((due_ns - time.monotonic_ns()) * 1e-9):
            played.ended_by = "Ctrl-C or a signal"
            break
        publishers.put(said)
        now_ns = time.monotonic_ns()
        played.samples += 1
        played.latest = max(played.latest, (now_ns - due_ns) * 1e-9)
        if now_ns - looked_ns > _LOOK_EVERY_NS:
            looked_ns = now_ns
            progress.move(said.at_ns * 1e-9)
            if trouble := _refusal(keys, presence.services):
                break
    progress.hide()
    played.seconds = (time.monotonic_ns() - began_ns) * 1e-9
    trouble = trouble or reader.trouble
    played.ended_by = trouble or played.ended_by
    played.unread = reader.unread
    sys.stdout.write(_told(played, as_json=as_json))
    troubles = [*([trouble] if trouble else []), *(f"{played.file}: {line}" for line in reader.unread.texts())]
    for line in troubles:
        print_error(line)
    return _STOPPED if troubles else _DONE


class Publishers:
    """One for each key, all of one priority: of two, what was said earlier might be heard later.

    Who listens too slowly holds it up, and that is told as lateness: a sample that is left out would not be.
    """

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self._session = session
        self._robot = robot
        self._publishers: dict[str, zenoh.Publisher] = {}

    def put(self, said: RecordedSample) -> None:
        publisher = self._publishers.get(said.key)
        if publisher is None:
            publisher = self._publishers[said.key] = self._session.declare_publisher(
                key_below(self._robot, said.key),
                encoding=said.encoding,
                congestion_control=zenoh.CongestionControl.BLOCK,
                priority=zenoh.Priority.DATA_HIGH,
                express=True,
            )
        publisher.put(said.payload)


def _refusal(keys: Iterable[str], services: Sequence[str]) -> str:
    """Why these may not be said in the name of a robot of which these services are there; empty: they may."""
    live: dict[str, tuple[str, ...]] = dict.fromkeys(services, ())
    for key in sorted(keys) if live else ():
        try:
            why = publish_refusal(find_topic(key), live)
        except UnknownKeyError as error:
            why = str(error)
        if why:
            return why
    return ""


def _told(played: Played, *, as_json: bool) -> str:
    if as_json:
        return json_line(played) + "\n"
    return (
        f"{played.file} as {played.robot}: {played.samples} samples in {played.seconds:.1f} s, the latest "
        f"{played.latest * 1000.0:.1f} ms late; ended by {played.ended_by}\n"
    )
