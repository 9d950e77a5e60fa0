"""The network between processes: here an ideal one, which carries everything at once and loses nothing."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import msgspec

from giraff_sim.hosts.host import Host


class Member(Protocol):
    """Who sends and takes messages: a process."""

    @property
    def host(self) -> Host: ...

    def receive(self, subscription: "Subscription", message: "Message") -> None:
        """A message of this subscription has arrived."""


class Message(NamedTuple):
    """What one process says: a sample, a request, or the answer to one."""

    key: str
    """As the topics table has it, with a name in the place of `*`."""
    body: msgspec.Struct
    answers_to: "Subscription | None" = None
    """Who waits for the answer of a request."""


class Subscription(NamedTuple):
    """One process's door for the messages of a key."""

    process: Member
    key: str
    """With `*` for any one chunk."""
    accept: Callable[[Message], None]

    def deliver(self, message: Message) -> None:
        """A message has arrived at the process."""
        self.process.receive(self, message)


class Network:
    """Carries messages to whoever has subscribed to their key."""

    def __init__(self) -> None:
        self._subscriptions: list[Subscription] = []
        self._by_key: dict[str, tuple[Subscription, ...]] = {}

    def join(self, subscription: Subscription) -> None:
        self._subscriptions.append(subscription)
        self._by_key.clear()

    def leave(self, process: Member) -> None:
        self._subscriptions = [each for each in self._subscriptions if each.process is not process]
        self._by_key.clear()

    def takers(self, key: str) -> tuple[Subscription, ...]:
        """Who takes messages of this key now."""
        if key not in self._by_key:
            self._by_key[key] = tuple(each for each in self._subscriptions if _matches(each.key, key))
        return self._by_key[key]

    def publish(self, sender: Member, message: Message) -> None:
        """Carry `message` to each process that takes its key."""
        for taker in self.takers(message.key):
            self.carry(sender, taker, message)

    def answer(self, sender: Member, message: Message, answer: msgspec.Struct) -> None:
        """Carry the answer to a request back to whoever asked."""
        if message.answers_to is not None:
            self.carry(sender, message.answers_to, Message(message.key, answer))

    def carry(self, sender: Member, taker: Subscription, message: Message) -> None:
        """Carry one message from one process to another."""
        del sender
        taker.deliver(message)


def _matches(pattern: str, key: str) -> bool:
    """Whether a concrete key is one of those that `pattern` stands for."""
    if pattern == key:
        return True
    wanted, chunks = pattern.split("/"), key.split("/")
    return len(wanted) == len(chunks) and all(a in ("*", b) for a, b in zip(wanted, chunks, strict=True))
