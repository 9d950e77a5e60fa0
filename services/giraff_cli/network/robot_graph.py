"""Who is there of one robot, what they say of themselves, and how their samples travel."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from typing import Any, Final

import msgspec
import zenoh

from giraff_cli.network.connection import Watcher
from giraff_cli.network.header_subscriber import Meter
from giraff_cli.network.statistics import Arrival, Tally
from giraff_cli.network.topic_keys import covers
from giraff_cli.terminal.signals import Stopping
from giraff_node.network.discovery import NoRobotError, robots_alive, unheard
from giraff_schemas.messages import Health, Sample
from giraff_schemas.topics import TOPICS, Topic, health_key, topic_of

FIRST_WITHIN: Final = 3.0  # s until the first word of a robot that is there
_LOOK_EVERY: Final = 0.05  # s
_ASK_EVERY: Final = 0.4  # s
_ANSWER_WITHIN: Final = 1.0  # s
_SETTLED: Final = 0.4  # s after the first word: the other processes of a robot are met within some ten ms
_MOST_WAITING: Final = 20_000  # samples
_ORDER: Final = {topic.key: number for number, topic in enumerate(TOPICS)}


class Maker(msgspec.Struct, frozen=True, order=True):
    """A process of the robot."""

    service: str
    """Empty: its samples are heard, but it has no liveliness token."""
    instance: str

    @property
    def name(self) -> str:
        return self.service or f"instance {self.instance}"


class Survey:
    """What is known. No clock, no network: both come in."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.alive: dict[str, str] = {}
        """Instance -> service."""
        self.healths: dict[str, Health] = {}
        """By instance, the newest answer."""
        self.tallies: dict[str, Tally] = {}
        """By key."""
        self.heard: deque[tuple[str, Sample, int]] = deque(maxlen=_MOST_WAITING)
        """Samples of topics that the watcher follows: key, sample, when (robot's clock, ns); for whoever takes them."""

    def hear(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """A sample of a topic that the watcher follows."""
        del topic
        self.heard.append((key, sample, at_ns))

    def announce(self, service: str, instance: str, *, present: bool) -> None:
        """A service's token on the network has come or gone."""
        if present:
            self.alive[instance] = service
        else:
            self.alive.pop(instance, None)
            self.healths.pop(instance, None)

    def count(self, arrival: Arrival) -> None:
        """A sample has come."""
        if arrival.key not in self.tallies:
            self.tallies[arrival.key] = Tally(arrival.key)
        self.tallies[arrival.key].hear(arrival)

    @property
    def empty(self) -> bool:
        return not self.alive and not self.tallies and not self.heard

    @property
    def services(self) -> list[Maker]:
        """Every process that is there."""
        return sorted(Maker(service, instance) for instance, service in self.alive.items())

    @property
    def answered(self) -> bool:
        """Whether every process has told of its health."""
        return set(self.alive) <= set(self.healths)

    @property
    def complete(self) -> bool:
        """Whether that, and whoever is heard has a token."""
        makers = {instance for tally in self.tallies.values() for instance in tally.counts}
        return self.answered and makers <= set(self.alive)

    @property
    def spoken(self) -> dict[str, list[str]]:
        """By service that is there, the keys that it publishes."""
        found: dict[str, list[str]] = {service: [] for service in self.alive.values()}
        for key in self.keys:
            for maker in self.publishers(key):
                if maker.service in found:
                    found[maker.service].append(key)
        return found

    @property
    def keys(self) -> list[str]:
        """What is published or heard, in the order of the topics table."""
        told = (key for health in self.healths.values() for key in health.publishes)
        return sorted({*told, *self.tallies}, key=_place)

    def publishers(self, key: str) -> list[Maker]:
        """Those who say that they publish it, and those of whom it is heard."""
        told = (instance for instance, health in self.healths.items() if key in health.publishes)
        heard = self.tallies[key].counts if key in self.tallies else ()
        return sorted(self.maker(instance) for instance in {*told, *heard})

    def publishers_of(self, pattern: str) -> list[Maker]:
        """Those of all keys that a `*` covers."""
        return sorted({maker for key in self.keys if covers(pattern, key) for maker in self.publishers(key)})

    def subscribers(self, key: str) -> list[Maker]:
        """Those who say that they listen to it."""
        return sorted(
            self.maker(instance)
            for instance, health in self.healths.items()
            if any(covers(pattern, key) for pattern in health.subscribes)
        )

    def maker(self, instance: str) -> Maker:
        """Of a sample."""
        return Maker(self.alive.get(instance, ""), instance)

    def instead(self, topic: Topic[Any]) -> str:
        """What to say of a topic that nobody publishes and that is not heard; empty: somebody does, or it is."""
        if any(covers(topic.key, key) for key in self.keys):
            return ""
        there = ", ".join(self.keys) or "nothing"
        return f"nobody publishes {topic.key} on {self.robot}; published there: {there}"


class Surveyor:
    """Makes a survey; from its making on it listens."""

    def __init__(self, watcher: Watcher, meters: Iterable[Meter] = ()) -> None:
        self.survey = Survey(watcher.robot)
        self._watcher = watcher
        self._meters = list(meters)
        self._answers: deque[Health] = deque()
        self._next_question = 0.0
        watcher.listen(())

    def look(self, now: float, *, again: bool = False) -> None:
        """Take in what has come; ask those who have not told of their health, or with `again` everybody."""
        self._watcher.pass_on(self.survey)
        for meter in self._meters:
            meter.take(self.survey.count)
        for _ in range(len(self._answers)):
            health = self._answers.popleft()
            if health.instance in self.survey.alive:
                self.survey.healths[health.instance] = health
        if now >= self._next_question and (again or not self.survey.answered):
            self._next_question = now + _ASK_EVERY
            self._ask()

    def go(self, seconds: float, stopping: Stopping) -> Survey:
        """Look for `seconds` from the first word on, and for those who are met late. Raises NoRobotError."""
        self.meet(stopping)
        self._until(time.monotonic() + seconds, stopping)
        self._until(time.monotonic() + _ANSWER_WITHIN, stopping, complete=True)
        return self.survey

    def inquire(self, stopping: Stopping) -> Survey:
        """Look until all have told of their health, or do not."""
        self.meet(stopping)
        now = time.monotonic()
        self._until(now + _SETTLED, stopping)
        self._until(now + _ANSWER_WITHIN, stopping, complete=True)
        return self.survey

    def wait(self, seconds: float, stopping: Stopping) -> None:
        """Look for `seconds`, whether or not there is a robot."""
        self._until(time.monotonic() + seconds, stopping)

    def meet(self, stopping: Stopping) -> None:
        """Wait for the first word of the robot. Raises NoRobotError."""
        deadline = time.monotonic() + FIRST_WITHIN
        while self.survey.empty:
            self.look(now := time.monotonic())
            if now > deadline or stopping.wait(_LOOK_EVERY):
                raise NoRobotError(unheard(self.survey.robot, robots_alive(self._watcher.session)))

    def _until(self, deadline: float, stopping: Stopping, *, complete: bool = False) -> None:
        while True:
            self.look(now := time.monotonic())
            if stopping.asked or (complete and self.survey.complete):
                return
            if now >= deadline or stopping.wait(min(_LOOK_EVERY, deadline - now)):
                return

    def _ask(self) -> None:
        def on_reply(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                with suppress(msgspec.MsgspecError):  # of another version
                    self._answers.append(msgspec.msgpack.decode(bytes(reply.ok.payload), type=Health))

        self._watcher.session.get(
            health_key(self.survey.robot),
            on_reply,
            # Two processes of one service answer to one key, and none of them waits for another.
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=_ANSWER_WITHIN,
        )


def is_listened_to(publisher: Any) -> bool:
    """Whether Zenoh knows of anybody. `publisher`: one of Zenoh's, whose own word for its type is wrong here."""
    return bool(publisher.matching_status.matching)


def _place(key: str) -> tuple[int, str]:
    """In the order of the topics table, unknown ones last."""
    row = topic_of(key)
    return (len(_ORDER) if row is None else _ORDER[row.key], key)
