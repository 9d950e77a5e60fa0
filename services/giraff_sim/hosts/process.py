"""One policy in the place of its process: it wakes when its real loop would, and hears what that one would hear."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Final, TypeVar

import msgspec

from giraff_node.board_link import BoardLink
from giraff_node.inbox import Inbox
from giraff_node.pacing import Pacer
from giraff_schemas.codec import stamped
from giraff_schemas.topics import SampleT, Topic
from giraff_schemas.wire import BoardKind, Frame
from giraff_sim.hosts.cable import CableEnd

if TYPE_CHECKING:
    from giraff_sim.closed_loop import ClosedLoop
    from giraff_sim.hosts.host import Host

_LONGEST_WAIT_US: Final = 100_000  # a node's loop comes round at least this often
_NEVER: Final = 1 << 62

MessageT = TypeVar("MessageT", bound=msgspec.Struct)


class Process(ABC):
    """A service's loop. `turn` is one round of it, with what the real one does between two waits."""

    def __init__(self, loop: ClosedLoop, host: Host, instance: str) -> None:
        self.loop = loop
        self.host = host
        self.instance = instance
        self.name = instance
        """What it is called here."""
        self.takes: dict[type[msgspec.Struct], Callable[[Any], None]] = {}
        self.paused = False
        """As by SIGSTOP: nothing runs, and what arrives waits."""
        self._waiting: list[msgspec.Struct] = []
        self._pacers: tuple[Pacer, ...] = ()
        self._sequences: dict[str, int] = defaultdict(int)
        self._wake_at_us = _NEVER
        self._entry_us = _NEVER  # of the agenda's earliest entry for this process, which may be too early by now
        self._ended = False
        self._links: list[BoardLink] = []

    @abstractmethod
    def turn(self, now: float) -> None:
        """A round of the loop. `now`: the host's monotonic clock, s."""

    @property
    def stalled(self) -> bool:
        """Whether it cannot run now."""
        return self.paused or self.host.suspended

    def receive(self, message: msgspec.Struct) -> None:
        """Take a message from the network, or leave it in the kernel's buffers while nothing runs here."""
        if self._ended:
            return
        if self.stalled:
            self._waiting.append(message)
        else:
            self.takes[type(message)](message)

    def go_on(self, spread_us: int = 0) -> None:
        """Run again after a stall: what has waited arrives as if it were new, over `spread_us`."""
        waiting, self._waiting = self._waiting, []
        now_us = self.loop.agenda.now_us
        for number, message in enumerate(waiting):
            self.loop.agenda.at(now_us + spread_us * number // len(waiting), partial(self.receive, message))
        self.wake()

    def wake(self, at_us: int | None = None) -> None:
        """Take a turn at `at_us`; None: now."""
        agenda = self.loop.agenda
        at_us = agenda.now_us if at_us is None else at_us
        if at_us < self._wake_at_us:
            self._wake_at_us = at_us
            if at_us < self._entry_us:
                self._entry_us = at_us
                agenda.at(at_us, self._awake)

    def end(self) -> None:
        """End as SIGKILL would."""
        self._ended = True
        for link in self._links:
            link.close()

    def _awake(self) -> None:
        now_us = self.loop.agenda.now_us
        if self._entry_us <= now_us:
            self._entry_us = _NEVER
        if self._ended:
            return
        if self._wake_at_us > now_us:
            if self._wake_at_us < self._entry_us:
                self._entry_us = self._wake_at_us
                self.loop.agenda.at(self._wake_at_us, self._awake)
            return
        self._wake_at_us = _NEVER
        if self.stalled:
            return
        now = self.host.monotonic()
        self.turn(now)
        wait_us = _LONGEST_WAIT_US
        for pacer in self._pacers:
            wait_us = min(wait_us, int(pacer.wait(now) * 1e6) + 1)
        self.wake(now_us + wait_us)

    def _queue(self, kind: type[MessageT], limit: int = 200) -> Inbox[MessageT]:
        """An inbox whose filling wakes nobody."""
        inbox: Inbox[MessageT] = Inbox(limit)
        self.takes[kind] = inbox.accept
        return inbox

    def _inbox(self, kind: type[MessageT], limit: int = 200) -> Inbox[MessageT]:
        """As `Node.inbox`: its arrival wakes the loop."""
        inbox: Inbox[MessageT] = Inbox(limit)

        def take_and_wake(message: MessageT) -> None:
            inbox.accept(message)
            self.wake()

        self.takes[kind] = take_and_wake
        return inbox

    def _link(self, path: str, baud: int, kind: BoardKind) -> BoardLink:
        cable = self.loop.cables.get(path)
        link = BoardLink(path, baud, kind, CableEnd(path, baud, cable, self.wake))
        self._links.append(link)
        return link

    def _say(self, topic: Topic[SampleT], sample: SampleT) -> None:
        seq = self._sequences[topic.key]
        self._sequences[topic.key] = seq + 1
        whole = stamped(sample, seq, self.host.wall_ns(), self.instance)
        self.loop.newest[topic.key] = whole
        self.loop.observer.said(self, whole)
        self.loop.network.publish(self, whole)

    def _write(self, link: BoardLink, frame: Frame) -> None:
        self.loop.observer.wrote(self, frame)
        link.send(frame)


class Observer:
    """Is told what passes through a process; never seen by a policy. This one keeps nothing."""

    def said(self, process: Process, sample: Any) -> None:
        """`process` publishes `sample`."""

    def heard(self, process: Process, sample: Any) -> None:
        """The policy of `process` is handed `sample`, a request among them."""

    def read(self, process: Process, frame: Frame) -> None:
        """The policy of `process` is handed `frame` of its board."""

    def wrote(self, process: Process, frame: Frame) -> None:
        """`process` sends `frame` to its board."""

    def opened(self, process: Process) -> None:
        """`process` has opened its board's port."""
