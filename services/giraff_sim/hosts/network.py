"""The network between processes: here an ideal one, which carries everything at once and loses nothing."""

from __future__ import annotations

from collections import defaultdict

import msgspec

from giraff_sim.hosts.process import Process


class Network:
    """Carries samples, requests and answers to whoever takes messages of their type."""

    def __init__(self) -> None:
        self._takers: dict[type[msgspec.Struct], list[Process]] = defaultdict(list)

    def join(self, process: Process) -> None:
        for kind in process.takes:
            self._takers[kind].append(process)

    def leave(self, process: Process) -> None:
        for kind in process.takes:
            self._takers[kind].remove(process)

    def takers(self, kind: type[msgspec.Struct]) -> tuple[Process, ...]:
        """Who takes messages of this type now."""
        return tuple(self._takers[kind])

    def publish(self, sender: Process, message: msgspec.Struct) -> None:
        """Carry `message` to each process that takes its type."""
        for taker in self._takers[type(message)]:
            self.carry(sender, taker, message)

    def carry(self, sender: Process, taker: Process, message: msgspec.Struct) -> None:
        """Carry one message from one process to another."""
        del sender
        taker.receive(message)
