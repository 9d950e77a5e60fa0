"""The network of a home: late, lossy, cut on one side or both, and full of what was said before."""

import random
from functools import partial
from typing import Final, NamedTuple

import msgspec

from giraff_sim.hosts.event_queue import EventQueue
from giraff_sim.hosts.host import Host
from giraff_sim.hosts.network import Member, Message, Network, Subscription

_BURST_US: Final = 20_000  # over which TCP hands over what it has held


class Said(NamedTuple):
    """A message as it was published."""

    at_us: int
    message: Message
    to: tuple[Subscription, ...] = ()
    """Of an answer: who had asked. Empty: whoever takes the key."""

    @property
    def body(self) -> msgspec.Struct:
        return self.message.body


class Link:
    """One way between two machines."""

    def __init__(self, delay_us: int, jitter_us: int) -> None:
        self.delay_us = delay_us
        self.jitter_us = jitter_us
        self.loss = 0.0
        """Share of the messages that get lost."""
        self.duplicates = 0.0
        """Share that arrives twice, the second time up to 0.5 s later."""
        self.overtakes = 0.0
        """Share that is held up for up to 0.2 s, while what was said later goes on."""
        self.cut: str = ""
        """`loses` or `holds` (TCP: all of it arrives when the link is back); empty: it carries."""
        self.held: list[tuple[Subscription, Message]] = []
        self.newest_us = 0  # arrival of the newest message that was not held up


class FaultyNetwork(Network):
    """Ideal within a machine, and what its links make of it between two."""

    def __init__(self, agenda: EventQueue, chance: random.Random) -> None:
        super().__init__()
        self.history: list[Said] = []
        """Everything that went from one machine to another, or to base."""
        self._agenda = agenda
        self._chance = chance
        self._links: dict[tuple[str, str], Link] = {}
        self._delay_us = chance.randint(200, 15_000)

    def link(self, sender: Host, taker: Host) -> Link:
        """The way from one machine to the other."""
        key = (sender.name, taker.name)
        if key not in self._links:
            self._links[key] = Link(self._delay_us, self._delay_us // 3)
        return self._links[key]

    def publish(self, sender: Member, message: Message) -> None:
        self.history.append(Said(self._agenda.now_us, message))
        super().publish(sender, message)

    def answer(self, sender: Member, message: Message, answer: msgspec.Struct) -> None:
        if message.answers_to is not None:
            self.history.append(Said(self._agenda.now_us, Message(message.key, answer), (message.answers_to,)))
        super().answer(sender, message, answer)

    def carry(self, sender: Member, taker: Subscription, message: Message) -> None:
        if sender.host is taker.process.host:
            taker.deliver(message)
            return
        link = self.link(sender.host, taker.process.host)
        if link.cut == "holds":
            link.held.append((taker, message))
        elif not link.cut:
            self._send(link, taker, message)

    def mend(self, link: Link) -> None:
        """Let a cut link carry again. What it has held arrives at once, in order and as if it were new."""
        link.cut = ""
        now_us = self._agenda.now_us
        for number, (taker, message) in enumerate(link.held):
            at_us = now_us + _BURST_US * number // len(link.held)
            self._arrive(taker, message, at_us)
            link.newest_us = max(link.newest_us, at_us)
        link.held.clear()

    def replay(self, said: list[Said], spread_us: int) -> None:
        """Carry old messages again, verbatim, to whoever takes them now."""
        for number, (_, message, to) in enumerate(said):
            at_us = self._agenda.now_us + spread_us * number // max(1, len(said))
            for taker in to or self.takers(message.key):
                self._arrive(taker, message, at_us)

    def _send(self, link: Link, taker: Subscription, message: Message) -> None:
        chance = self._chance
        if link.loss and chance.random() < link.loss:
            return
        at_us = self._agenda.now_us + link.delay_us + (chance.randint(0, link.jitter_us) if link.jitter_us else 0)
        if link.overtakes and chance.random() < link.overtakes:
            at_us += chance.randint(0, 200_000)
        else:
            at_us = link.newest_us = max(at_us, link.newest_us)
        self._arrive(taker, message, at_us)
        if link.duplicates and chance.random() < link.duplicates:
            self._arrive(taker, message, at_us + chance.randint(0, 500_000))

    def _arrive(self, taker: Subscription, message: Message, at_us: int) -> None:
        self._agenda.at(at_us, partial(taker.deliver, message))
