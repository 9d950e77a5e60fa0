"""A slow, long and lossy cable between two machines: python bad_cable.py KIND PID NAME PID NAME.

KIND: of CABLES, each way. PID: a process in each machine's network. NAME: of the cable's end there, a TAP device. It
ends with its standard input. This machine's kernel may have no `netem`, which would do it.
"""

import contextlib
import ctypes
import fcntl
import os
import random
import select
import struct
import sys
import time
from collections import deque
from pathlib import Path
from typing import Final, NamedTuple

_NEW_NETWORK: Final = 0x40000000  # linux/sched.h, CLONE_NEWNET
_SET_UP: Final = 0x400454CA  # linux/if_tun.h, TUNSETIFF
_TAP_WITHOUT_HEADER: Final = 0x0002 | 0x1000
_LONGEST: Final = 65536  # bytes
_AT_ONCE: Final = 32
"""Packets read from one end before the other one has its turn."""


class Cable(NamedTuple):
    """What a cable does to packets, each way."""

    rate: float
    """bit/s."""
    delay: float
    """s."""
    loss: float
    """Of all packets."""
    queue: float
    """Bytes that wait to be sent; what is more is dropped, as a home's access point does."""


BAD: Final = Cable(rate=10e6, delay=0.020, loss=0.02, queue=64e3)
CABLES: Final = {"bad": BAD, "slow": Cable(rate=1e6, delay=0.020, loss=0.0, queue=64e3)}


class Direction:
    """Packets on their way to one end. Times are monotonic, s."""

    def __init__(self, cable: Cable, chance: random.Random) -> None:
        self._cable = cable
        self._chance = chance
        self._free_at = 0.0
        self._under_way: deque[tuple[float, bytes]] = deque()

    def send(self, packet: bytes, now: float) -> None:
        """Take one in at the far end."""
        if self._chance.random() < self._cable.loss:
            return
        self._free_at = max(self._free_at, now)
        if (self._free_at - now) * self._cable.rate / 8 + len(packet) > self._cable.queue:
            return
        self._free_at += len(packet) * 8 / self._cable.rate
        self._under_way.append((self._free_at + self._cable.delay, packet))

    def arrived(self, now: float) -> list[bytes]:
        """What comes out at the near end."""
        arrived = []
        while self._under_way and self._under_way[0][0] <= now:
            arrived.append(self._under_way.popleft()[1])
        return arrived

    def next_arrival(self) -> float | None:
        return self._under_way[0][0] if self._under_way else None


def open_end(pid: int, name: str) -> int:
    """A TAP device in the network of a process; its descriptor. It is gone when that is closed."""
    with Path(f"/proc/{pid}/ns/net").open(encoding="utf-8") as network:
        if ctypes.CDLL(None, use_errno=True).setns(network.fileno(), _NEW_NETWORK):
            raise OSError(ctypes.get_errno(), f"the network of process {pid}")
    end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(end, _SET_UP, struct.pack("16sH22x", name.encode(), _TAP_WITHOUT_HEADER))
    return end


def carry(ends: tuple[int, int], cable: Cable, stop: int) -> None:
    """Until `stop` is readable."""
    chance = random.Random(1)
    to = {ends[0]: Direction(cable, chance), ends[1]: Direction(cable, chance)}
    other = {ends[0]: ends[1], ends[1]: ends[0]}
    while True:
        now = time.monotonic()
        due = [at for at in (direction.next_arrival() for direction in to.values()) if at is not None]
        readable, _, _ = select.select([*ends, stop], [], [], max(0.0, min(due) - now) if due else 1.0)
        if stop in readable:
            return
        now = time.monotonic()
        for end in ends:
            if end in readable:
                for packet in _packets(end):
                    to[other[end]].send(packet, now)
            for packet in to[end].arrived(now):
                _put(end, packet)


def _packets(end: int) -> list[bytes]:
    packets: list[bytes] = []
    with contextlib.suppress(BlockingIOError):
        packets.extend(os.read(end, _LONGEST) for _ in range(_AT_ONCE))
    return packets


def _put(end: int, packet: bytes) -> None:
    with contextlib.suppress(OSError):  # that end is down: who is not there receives nothing
        os.write(end, packet)


def main(cable: Cable, ends: tuple[tuple[str, str], tuple[str, str]]) -> None:
    opened = tuple(open_end(int(pid), name) for pid, name in ends)
    print("ready", flush=True)
    carry((opened[0], opened[1]), cable, sys.stdin.fileno())


if __name__ == "__main__":
    main(CABLES[sys.argv[1]], ((sys.argv[2], sys.argv[3]), (sys.argv[4], sys.argv[5])))
