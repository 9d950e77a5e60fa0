"""`giraff record`: everything that a robot says, into a file that outlives whatever ends the recording."""

import gc
import sys
import time
from collections import deque
from collections.abc import Sequence
from contextlib import closing
from datetime import UTC, datetime
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any, Final

import msgspec
import zenoh

from giraff_cli.record.report import DONE, INCOMPLETE, Report, told
from giraff_core.picture.receiver import PictureReceiver
from giraff_mcap.metadata import ASKED, metadata_of
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.raw_subscriber import RawSubscriber, lower_priority
from giraff_mcap.writing import RecordingWriter
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import RobotMonitor, not_found_text, select_robot
from giraff_node.network.query_client import QueryClient
from giraff_node.network.tcp_options import set_tcp_options
from giraff_node.network.tokens import Token, watch_tokens
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.params import ParamAnswer, ParamDescribe
from giraff_schemas.services import ANSWERING
from giraff_schemas.text import meant, printable
from giraff_schemas.topics import CAMERA_PICTURES, CAMERA_STATE, PARAM_DESCRIBE, TOPICS, key_below, key_of
from giraff_tools.network.command import print_error, run_on_network
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.pictures import pictures_for
from giraff_tools.network.topic_keys import UnknownKeyError, all_below_robot
from giraff_tools.terminal.signals import StopSignal

_LOOK_EVERY: Final = 0.2  # s
_SYNC_EVERY: Final = 0.4  # s; with a slow write still less than the second that a crash may cost
_TUNE_EVERY: Final = 2.0  # s; a link of the recorder's only thread, which would otherwise be held up by its end
_PICTURES_EVERY: Final = 0.015  # s; the quickest camera takes 60 a second
_SILENT_AFTER: Final = 3.0  # s
_MOST: Final = 50  # processes that are asked at once; on an open network anybody may declare a name


class Limits(msgspec.Struct, frozen=True):
    """When a recording ends by itself."""

    seconds: float | None
    """From the first sample on."""
    size: int | None
    """Bytes that the file never exceeds."""


class RecordedPictures:
    """All that the cameras of the robot see. It is asked for, and comes over a link of its own."""

    def __init__(self, connection: RobotConnection, pictures: PictureReceiver) -> None:
        """`pictures`: of the cameras that are heard on `connection`."""
        self._connection, self._pictures = connection, pictures
        self._taken: list[RawSample] = []
        connection.subscribe(CAMERA_STATE)

    def wait(self, stopping: StopSignal, seconds: float) -> bool:
        """Take pictures for so long; True: somebody has asked for the end."""
        until = time.monotonic() + seconds
        while (left := until - (now := time.monotonic())) > 0.0:
            if stopping.wait(min(_PICTURES_EVERY, left)):
                return True
            self._connection.dispatch(self._pictures)
            for topic, sample in self._pictures.ask_all(now):
                key = key_of(self._connection.robot, topic)
                self._taken.append(RawSample(time.monotonic_ns(), key, encode(sample), encoding_of(type(sample))))
        return False

    def pop_all(self) -> list[RawSample]:
        """Return the pictures that were taken since the last call."""
        for trouble in self._pictures.new_troubles():
            print_error(f"no picture: {trouble}")
        taken, self._taken = self._taken, []
        return taken


def record(
    robot: str | None,
    connect: Sequence[str],
    path: Path | None,
    topics: Sequence[str],
    limits: Limits,
    *,
    camera: bool,
    as_json: bool,
) -> int:
    """Until Ctrl-C or a limit; the exit code."""
    lower_priority()
    gc.freeze()  # what is imported stays, and need not be looked through again and again
    with StopSignal() as stopping:
        try:
            topics, robot = all_below_robot(topics, robot)
            wanted = tuple(wanted_topics(topics))
        except (NoRobotError, UnknownKeyError) as error:
            return print_error(str(error))
        return run_on_network(
            robot,
            connect,
            lambda met: _record(met, stopping, path, wanted, limits, camera=camera, as_json=as_json),
            records=True,
            stands_in=True,
        )


def wanted_topics(patterns: Sequence[str]) -> list[str]:
    """Key expressions below the robot's name, each of which meets the table; NoRobotError names one that does not.

    None is of pictures: others would not be told that this host keeps them.
    """
    for pattern in patterns:
        try:
            met = [topic for topic in TOPICS if zenoh.KeyExpr(pattern).intersects(zenoh.KeyExpr(topic.key))]
        except zenoh.ZError:
            met = []
        if any(topic in CAMERA_PICTURES for topic in met):
            raise NoRobotError(
                f"--topics {pattern}: pictures must be asked for; --camera asks for them, and keeps them"
            )
        if not met:
            known = [topic.key for topic in TOPICS]
            raise NoRobotError(
                f"--topics {pattern}: no such topic; {meant(pattern, known)}there are {', '.join(known)}"
            )
    return list(patterns)


def _record(
    connection: RobotConnection,
    stopping: StopSignal,
    path: Path | None,
    topics: Sequence[str],
    limits: Limits,
    *,
    camera: bool,
    as_json: bool,
) -> int:
    monitor = RobotMonitor(connection.session)
    robot = connection.robot or _wait_for_one(connection, monitor, stopping, limits.seconds)
    if not robot:
        return print_error("ended before a robot came: nothing was recorded")
    path = path or Path(f"{robot}-{datetime.now(UTC):%Y%m%d-%H%M%S}.mcap")
    try:
        writer = RecordingWriter(path, metadata_of(robot) | {ASKED: "yes"})
    except FileExistsError:
        return print_error(f"{path} is there already: name another, or move it away; nothing is ever written over")
    except OSError as error:
        return print_error(f"{path}: cannot be written: {error.strerror}")
    keys = [key_below(robot, topic) for topic in topics or ("**",)]
    connection.robot = robot
    with (
        writer,
        closing(RawSubscriber(connection.session, keys)) as subscriber,
        closing(pictures_for(connection, "record")) as receiver,
    ):
        print_progress(f"recording {robot} into {path}; Ctrl-C ends it")
        trouble = ended_by = ""
        pictures = RecordedPictures(connection, receiver) if camera else None
        try:
            parameters = RecordedParameters(connection.session, robot)
            ended_by = _follow(robot, monitor, writer, subscriber, pictures, parameters, stopping, limits)
            if writer.first_ns is not None:
                writer.close(ended_by)
        except OSError as error:
            trouble = (
                f"{path}: cannot be written any more: {error.strerror}; what was recorded until then is kept: make "
                f"room, then giraff record --repair {path}"
            )
        report = Report.of(writer, ended_by or trouble, subscriber.overrun)
    if not report.samples and not trouble:
        path.unlink()
        why = "; ".join(report.unread.texts()) or not_found_text(robot, monitor.names)
        return print_error(f"{why}; nothing was recorded ({ended_by})")
    sys.stdout.write(told(report, as_json=as_json))
    if trouble:
        print_error(trouble)
    return INCOMPLETE if trouble or report.unread else DONE


def print_progress(text: str) -> None:
    """What goes on, for people: standard output is for what comes of it."""
    print(printable(text), file=sys.stderr, flush=True)


def _wait_for_one(
    connection: RobotConnection, monitor: RobotMonitor, stopping: StopSignal, seconds: float | None
) -> str:
    """The only robot, once there is one; empty: the end came before. NoRobotError: there are several."""
    waiting = False
    began = time.monotonic()
    while not (found := monitor.settled):
        if not waiting and time.monotonic() - began > _SILENT_AFTER:
            waiting = True
            print_progress(f"giraff: {not_found_text('', ())}; waiting for one")
        if stopping.wait(_LOOK_EVERY) or (seconds is not None and time.monotonic() - began >= seconds):
            return ""
    return select_robot(connection.session, found, connection.filed)


def _follow(
    robot: str,
    monitor: RobotMonitor,
    writer: RecordingWriter,
    subscriber: RawSubscriber,
    pictures: RecordedPictures | None,
    parameters: "RecordedParameters",
    stopping: StopSignal,
    limits: Limits,
) -> str:
    """Write what is heard, until the end; why it came. Raises OSError."""
    began = time.monotonic()
    warned, waited, tune_at = False, began, began
    while True:
        ended = pictures.wait(stopping, _SYNC_EVERY) if pictures else stopping.wait(_SYNC_EVERY)
        at_ns = time.monotonic_ns()  # what is heard later than this is not taken before the parameters
        heard = [*subscriber.pop_all(), *(pictures.pop_all() if pictures else ())]
        if heard or writer.first_ns is not None:  # a robot that says nothing is not recorded
            heard += parameters.pop_all(time.monotonic(), at_ns)
        writer.add(sorted(heard, key=attrgetter("at_ns")))
        writer.sync()
        now = time.monotonic()
        if now >= tune_at:
            tune_at = now + _TUNE_EVERY
            set_tcp_options()
        if ended:
            return "Ctrl-C or a signal"
        if writer.first_ns is None:
            waited = now
        if limits.seconds is not None and now - (began if writer.first_ns is None else waited) >= limits.seconds:
            return f"--for {limits.seconds:g}"
        if limits.size is not None and writer.size >= limits.size:
            return "--max-size"
        if not warned and writer.first_ns is None and now - began > _SILENT_AFTER:
            warned = True
            print_progress(f"giraff: {not_found_text(robot, monitor.names)}; waiting for it")


class RecordedParameters:
    """Asks each process of the robot once, as soon as it is there. What is set later each service tells by itself."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        """`session`: of the recorder alone."""
        self._session, self._robot = session, robot
        self._news: deque[tuple[Token, bool]] = deque()  # of Zenoh's threads
        self._asking: dict[Token, QueryClient[ParamDescribe, ParamAnswer]] = {}
        self._tokens: Any = watch_tokens(session, robot, lambda *news: self._news.append(news))

    def pop_all(self, now: float, at_ns: int) -> list[RawSample]:
        """Ask further, and return the answers since the last call. `now`: s; `at_ns`: the same moment."""
        for _ in range(len(self._news)):
            token, present = self._news.popleft()
            if not present:
                self._asking.pop(token, None)
            elif token.service in ANSWERING and len(self._asking) < _MOST:
                self._asking[token] = QueryClient(
                    self._session,
                    self._robot,
                    PARAM_DESCRIBE.at(token.service),
                    ParamDescribe(),
                    partial(_is_of, token.instance),
                )
        answers = {token: answer for token, asking in self._asking.items() if (answer := asking.poll(now)) is not None}
        for token in answers:
            del self._asking[token]
        encoding = encoding_of(ParamAnswer)
        return [
            RawSample(at_ns, key_of(self._robot, PARAM_DESCRIBE.at(token.service)), encode(answer), encoding)
            for token, answer in answers.items()
        ]


def _is_of(instance: str, answer: ParamAnswer) -> bool:
    return answer.instance == instance
