"""giraff_recorder: everything that the robot says -> files of the moments that matter."""

from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import closing, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from giraff_mcap.metadata import metadata_of
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.raw_subscriber import RawSubscriber, lower_priority
from giraff_mcap.writing import RecordingWriter
from giraff_node import Node, Timer
from giraff_node.network.replies import ask_all
from giraff_node.network.tokens import Token, watch_tokens
from giraff_node.process.state import state_directory
from giraff_recorder.config import RecorderConfig
from giraff_recorder.policy import Incident, IncidentDetector, IncidentFile, Memory, surplus
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.health import Health
from giraff_schemas.topics import BASE, ESTOP, health_key, key_below, key_of
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_LOOK_HZ: Final = 5.0
_AT_ONCE: Final = 2000
"""Samples that one turn writes: the loop goes on turning meanwhile."""
_MOST_WAITING: Final = 200
"""Words of services between two turns: on an open network anybody may send more."""
_ANSWER_WITHIN: Final = 2.0  # s
_FOLDER: Final = "incidents"


def main() -> None:
    lower_priority()
    with Node("recorder", RecorderConfig, records=True) as node, listening(node) as subscriber:
        incidents, memory = IncidentDetector(node.config), Memory(node.config)
        others = Others(node)
        folder = state_directory(node.robot.name) / _FOLDER
        pace, health_timer = Timer(_LOOK_HZ), Timer(1.0 / node.config.health_period)
        writing: Iterator[None] | None = None
        for now in node.turns(pace):
            if not pace.due(now):
                continue
            heard = subscriber.pop_all()
            memory.add(heard)
            for sample in heard:
                tell_of(sample, node.robot.name, incidents)
            others.dispatch(incidents, now, ask=health_timer.due(now))
            if writing is None and (incident := incidents.due(now)) is not None:
                writing = write(node, folder, incident, memory.since(incident.since_ns))
            if writing is not None:
                writing = advanced(node, writing)


def listening(node: Node[RecorderConfig]) -> closing[RawSubscriber]:
    """To all that the robot says; no longer once Python ends, which Zenoh's thread must not enter then."""
    return closing(RawSubscriber(node.session, [key_below(node.robot.name, "**")]))


class Others:
    """The robot's other services: who goes, and how they are."""

    def __init__(self, node: Node[RecorderConfig]) -> None:
        self._node = node
        self._gone: deque[str] = deque(maxlen=_MOST_WAITING)
        self._healths: deque[Health] = deque(maxlen=_MOST_WAITING)
        self._tokens = watch_tokens(node.session, node.robot.name, self._on_token, node.log.warning, history=False)

    def dispatch(self, incidents: IncidentDetector, now: float, *, ask: bool) -> None:
        """Pass on what has come."""
        for _ in range(len(self._gone)):
            incidents.on_gone(self._gone.popleft(), now)
        for _ in range(len(self._healths)):
            incidents.on_health(self._healths.popleft(), now)
        if ask:
            ask_all(self._node.session, health_key(self._node.robot.name), Health, self._healths.append, _ANSWER_WITHIN)

    def _on_token(self, token: Token, present: bool) -> None:
        if not present:
            self._gone.append(token.service)


def tell_of(sample: RawSample, robot: str, incidents: IncidentDetector) -> None:
    """Let `incidents` know of a sample that may be one."""
    at = sample.at_ns * 1e-9
    with suppress(DecodeError):  # of somebody else; base's own next word comes in a moment
        if sample.key == key_of(robot, ESTOP):
            incidents.on_estop(decode(ESTOP, sample.key, sample.payload), at)
        elif sample.key == key_of(robot, BASE):
            incidents.on_base(decode(BASE, sample.key, sample.payload), at)


def write(node: Node[RecorderConfig], folder: Path, incident: Incident, samples: Sequence[RawSample]) -> Iterator[None]:
    """Write a file, a part with each step. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{datetime.now(UTC):%Y%m%d-%H%M%S}-{incident.kind}.mcap"
    node.log.warning("%s: writing %s", incident.text, path)
    with RecordingWriter(path, metadata_of(node.robot.name) | {"incident": incident.text}) as writer:
        for begin in range(0, len(samples), _AT_ONCE):
            writer.add(samples[begin : begin + _AT_ONCE])
            writer.sync()
            yield
        writer.close(incident.text)
    # Last comes this one, whatever the clock said: a boot without one is in 1970.
    files = [(file.name, file.stat()) for file in sorted(folder.glob("*.mcap"), key=lambda file: (file == path, file))]
    for name in surplus([IncidentFile(name, stat.st_size, stat.st_mtime) for name, stat in files], node.config):
        (folder / name).unlink(missing_ok=True)
        node.log.info("%s went, to keep the limits of [recorder]", folder / name)
    node.log.info("wrote %s: %.0f s", path, writer.seconds)


def advanced(node: Node[RecorderConfig], writing: Iterator[None]) -> Iterator[None] | None:
    """One step further; None: it has ended."""
    try:
        next(writing)
    except StopIteration:
        node.set_fault("disk", NO_TROUBLE)
        return None
    except OSError as error:
        full = f"{error.filename or 'incidents'}: {error.strerror}"
        node.set_fault("disk", Trouble(full, "make room, or correct its rights"))
        return None
    return writing
