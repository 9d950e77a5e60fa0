"""Listens to one robot for a moment, and asks each of its services how it is."""

import time
from collections.abc import Iterable
from contextlib import suppress
from typing import Any, Final

import msgspec
import zenoh

from giraff_cli.doctor.inspection import Geometry, GeometryInUse, HealthReply, Rate, Robot
from giraff_core.senses import SENSED
from giraff_node import robot_now_ns
from giraff_node.network.replies import ask_all
from giraff_node.network.tcp_options import set_tcp_options
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.health import Health
from giraff_schemas.messages import Sample
from giraff_schemas.params import ParamAnswer, ParamDescribe
from giraff_schemas.services import SERVICES
from giraff_schemas.topics import (
    ATTITUDE,
    BATTERY,
    ODOM,
    OPERATOR_CMD_VEL,
    PARAM_DESCRIBE,
    WHEELS,
    Topic,
    covers,
    health_key,
    key_of,
)
from giraff_telemetry.collector import Snapshot, Telemetry
from giraff_tools.network.connection import RobotConnection

MAKERS: Final[dict[Topic[Any], str]] = {
    topic: service.name
    for service in SERVICES
    for topic in service.publishes
    if topic in SENSED.values()
    or (topic.rate_hz and topic not in (ATTITUDE, BATTERY, OPERATOR_CMD_VEL) and not service.optional)
}
"""Of what a robot says all the time: not all balance or measure their battery, and nobody need ask to drive. Only of
a simulated one the truth is known."""

_CONFIGURED: Final = frozenset(service.name for service in SERVICES if service.table)
"""Services that answer for their parameters."""
_SHARED: Final = "robot."
_LOOK_EVERY: Final = 0.02  # s
_ASK_EVERY: Final = 0.25  # s; the quickest of several answers tells the clock best
_HEAR_FIRST: Final = 3.0  # s


class CountedTelemetry(Telemetry):
    """Counts the samples of each key, too."""

    def __init__(self) -> None:
        super().__init__()
        self.counts: dict[str, int] = {}

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        super().on_sample(topic, key, sample, at_ns)
        self.counts[key] = self.counts.get(key, 0) + 1


class HealthClient:
    """Answers about health, each with what it tells of its host's clock."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self._session = session
        self._key = health_key(robot)
        self._best: dict[str, HealthReply] = {}

    def ask(self, within: float) -> None:
        """Ask all; whoever answers within so many seconds is heard."""
        asked_ns = time.time_ns()

        ask_all(
            self._session, self._key, Health, lambda health: self._on_health(health, asked_ns, time.time_ns()), within
        )

    @property
    def answers(self) -> tuple[HealthReply, ...]:
        """One a process."""
        return tuple(sorted(self._best.values(), key=lambda each: (each.health.service, each.health.instance)))

    def _on_health(self, health: Health, asked_ns: int, now_ns: int) -> None:
        half = (now_ns - asked_ns) * 0.5e-9
        ahead = (health.stamp_ns - asked_ns) * 1e-9 - half
        before = self._best.get(health.instance)
        if before is None or half <= before.uncertainty:
            self._best[health.instance] = HealthReply(health=health, ahead=ahead, uncertainty=half)


class GeometryClient:
    """Answers about what each process goes by of wheels and track."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self._session = session
        self._key = key_of(robot, PARAM_DESCRIBE)
        self._told: dict[str, GeometryInUse] = {}

    def ask(self, within: float, running: Iterable[HealthReply]) -> None:
        """Ask all until each of `running` that has parameters has told; `within`: s."""
        there = {each.health.instance for each in running if each.health.service in _CONFIGURED}
        if there and there <= self._told.keys():
            return
        request = {"payload": encode(ParamDescribe()), "encoding": encoding_of(ParamDescribe)}
        ask_all(self._session, self._key, ParamAnswer, self._on_answer, within, **request)

    @property
    def answers(self) -> tuple[GeometryInUse, ...]:
        """One a process."""
        return tuple(sorted(self._told.values(), key=lambda each: (each.service, each.host)))

    def _on_answer(self, answer: ParamAnswer) -> None:
        with suppress(msgspec.MsgspecError):  # of another version, which is told by its health
            self._told[answer.instance] = geometry_in(answer)


def geometry_in(answer: ParamAnswer) -> GeometryInUse:
    """What a service has told of wheels and track. Raises ValidationError for what cannot be."""
    told = {param.name.removeprefix(_SHARED): param.value for param in answer.params if param.name.startswith(_SHARED)}
    return GeometryInUse(service=answer.service, host=answer.host, geometry=msgspec.convert(told, Geometry))


def listen(connection: RobotConnection, seconds: float) -> Robot | None:
    """What is heard within `seconds` of the first word; None: not a word."""
    listener, health = CountedTelemetry(), HealthClient(connection.session, connection.robot)
    geometry = GeometryClient(connection.session, connection.robot)
    connection.subscribe_all()
    if not _first_word(connection, listener):
        return None
    began = time.monotonic()
    next_question = 0.0
    while (elapsed := time.monotonic() - began) < seconds:
        set_tcp_options()
        connection.dispatch(listener)
        if elapsed >= next_question:
            next_question = elapsed + _ASK_EVERY
            health.ask(max(0.1, seconds - elapsed))
            geometry.ask(max(0.1, seconds - elapsed), health.answers)
        time.sleep(_LOOK_EVERY)
    connection.dispatch(listener)
    now = listener.snapshot(robot_now_ns())
    return Robot(
        name=connection.robot,
        seconds=seconds,
        services=dict(sorted(now.services.items())),
        unused=now.unused,
        answers=health.answers,
        geometries=geometry.answers,
        rates=tuple(rates_of(listener, now)),
        base=now.base.sample if now.base and now.base.fresh else None,
        estop=now.estop.sample if now.estop and now.estop.fresh else None,
    )


def _first_word(connection: RobotConnection, listener: CountedTelemetry) -> bool:
    deadline = time.monotonic() + _HEAR_FIRST
    while time.monotonic() < deadline:
        connection.dispatch(listener)
        if listener.counts or listener.alive:
            return True
        time.sleep(_LOOK_EVERY)
    return False


def rates_of(listener: CountedTelemetry, now: Snapshot) -> Iterable[Rate]:
    """Return the rate of each key that was heard, or should have been."""
    hz, lost = listener.rates_hz, listener.lost
    wanted = {topic: topic.rate_hz for topic in MAKERS}
    if now.base is not None and now.base.fresh:
        wanted |= dict.fromkeys((WHEELS, ODOM), 1000.0 / max(1, now.base.sample.board.report_ms))
    expected = [each.key for each in now.sensed.values()]
    expected += [topic.key for topic in MAKERS if not topic.names]
    for topic, maker in MAKERS.items():
        for key in dict.fromkeys(key for key in (*listener.counts, *expected) if covers(topic, key)):
            yield Rate(
                key=key,
                maker=maker,
                wanted_hz=wanted[topic],
                hz=hz.get(key),
                heard=listener.counts.get(key, 0),
                lost=lost.get(key, 0),
            )
