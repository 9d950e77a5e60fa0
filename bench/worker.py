"""One process of a pair, in the interpreter of its stack: python -m bench.worker STACK SIDE SOCKET SIZE.

It takes commands from the benchmark at SOCKET, a JSON line each, and answers each with a line. SIDE is `out`, which
sends on `a` and hears `b`, or `back`, the other way round.
"""

import json
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from bench.meter import quantiles_us
from bench.stacks import STACKS, Send, Stack

now = time.monotonic
_PATIENCE = 20.0  # s for all round trips of a measurement
_LOOKS = 0.05  # s between two looks at whether samples still arrive


class Pair:
    """What one process sends and hears, and how soon."""

    def __init__(self, stack: Stack, side: str) -> None:
        out, back = ("a", "b") if side == "out" else ("b", "a")
        self.first = 0.0
        """s, monotonic. When the first sample came; 0: none has."""
        self._came: list[tuple[float, float]] = []
        """Of each sample, when it was sent and when it came."""
        self._returns = False
        """Whether each sample is sent back."""
        self._awaited, self._left, self._done = -1, 0, threading.Event()
        self._send = stack.publisher(out)
        self._blocking: Send | None = stack.publisher(out, blocks=True) if side == "out" else None
        self._warm = side == "out"
        stack.subscribe(back, self._take)

    def warm_up(self) -> None:
        """Send until the first command."""
        while self._warm:
            self._send(-2, now())
            time.sleep(0.005)

    def _take(self, number: int, moment: float) -> None:
        if not self.first:
            self.first = now()
        if number < 0:
            return
        if self._awaited < 0:
            self._came.append((moment, now()))
            if self._returns:
                self._send(number, moment)
        elif number == self._awaited:
            self._came.append((moment, now()))
            self._left -= 1
            if self._left:
                self._awaited = number + 1
                self._send(number + 1, now())
            else:
                self._done.set()

    def start(self, *, returns: bool) -> None:
        """Count from here on."""
        self._warm, self._returns, self._came = False, returns, []

    def heard(self) -> int:
        """Return how many have come, once no more do."""
        before = -1
        while before != (before := len(self._came)):
            time.sleep(_LOOKS)
        return before

    def pace(self, rate: float, count: int) -> None:
        due = now()
        for number in range(count):
            due += 1.0 / rate
            if (left := due - now()) > 0.0:
                time.sleep(left)
            self._send(number, now())

    def burst(self, seconds: float) -> int:
        """Send as fast as sending returns; how many."""
        assert self._blocking is not None  # noqa: S101  only this side is told to
        end, number = now() + seconds, 0
        while (moment := now()) < end:
            self._blocking(number, moment)
            number += 1
        return number

    def round_trips(self, count: int) -> None:
        """Send the next when the last has come back."""
        self._left, self._awaited = count, 0
        self._done.clear()
        self._send(0, now())
        self._done.wait(_PATIENCE)
        self._awaited = -1

    def result(self) -> dict[str, float]:
        """Return how many came, within how many s, and how long samples or round trips took in us."""
        count, came = self.heard(), self._came
        seconds = came[-1][1] - came[0][1] if came else 0.0
        return {"count": count, "seconds": seconds, **quantiles_us([end - begin for begin, end in came])}


def _answer(pair: Pair, order: dict[str, Any]) -> dict[str, Any]:
    match order.pop("do"):
        case "start":
            pair.start(**order)
            return {}
        case "first":
            return {"at": pair.first}
        case "result":
            return pair.result()
        case "pace" | "burst" | "round_trips" as do:
            began, worked = now(), time.process_time()
            sent = getattr(pair, do)(**order)
            return {"sent": sent, "seconds": now() - began, "worked": time.process_time() - worked}
        case _:
            return {"worked": time.process_time()}


def serve(pair: Pair, orders: socket.socket) -> None:
    """Do what is ordered, until the benchmark hangs up."""
    threading.Thread(target=pair.warm_up, daemon=True).start()
    with orders.makefile("rw") as lines:
        for line in lines:
            lines.write(json.dumps(_answer(pair, json.loads(line))) + "\n")
            lines.flush()
    os.kill(os.getpid(), signal.SIGKILL)  # how a process of a stack ends is not what is measured


def main(words: Sequence[str]) -> None:
    name, side, path, size = words
    if name not in STACKS:
        import_module("bench.peers")
    stack = STACKS[name](int(size))
    pair = Pair(stack, side)
    orders = socket.socket(socket.AF_UNIX)
    orders.connect(path)
    orders.sendall(f"{side} {os.getpid()}\n".encode())
    threading.Thread(target=serve, args=(pair, orders), daemon=True).start()
    stack.run(threading.Event())


if __name__ == "__main__":
    main(sys.argv[1:])
