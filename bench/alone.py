"""What needs no network: the codec, a serial line, and a seed of the deterministic simulation."""

import json
import os
import pty
import subprocess
import sys
import time
import timeit
import tty
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import msgspec

from bench.figures import Figures
from bench.meter import quantiles_us
from giraff_node.boards.board_link import BoardLink
from giraff_node.process.selector import wait_for
from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.codec import decode, encode, encoding_of, stamped
from giraff_schemas.framing import Decoder
from giraff_schemas.framing import encode as framed
from giraff_schemas.topics import CMD_VEL, ODOM, TICK, Topic
from giraff_schemas.wire import BoardKind, Frame, HelloFrame, WheelsFrame
from giraff_sim.board import ROOT
from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import SECONDS, known_settings, play
from tests.unit.schemas.samples import an_example

_CALLS: Final = 1000
_TURNS: Final = 5
_FRAMES: Final = 200
_HZ: Final = 100.0
_WRAP: Final = 1 << 32
_PAUSE: Final = 0.3  # s, until a reader waits


def measure_codec(figures: Figures) -> None:
    """One round: each sample to bytes and back, with and without what a Node does beside msgspec."""
    for _ in range(_TURNS):
        for topic in (TICK, CMD_VEL, ODOM):
            sample = msgspec.convert(an_example(topic.schema), topic.schema)
            for name, call in (("msgspec alone", _alone(topic, sample)), ("a Node", _in_node(topic, sample))):
                figures.add("codec", f"{topic.key}, {name}", timeit.timeit(call, number=_CALLS) / _CALLS * 1e9)


def _alone(topic: Topic[Any], sample: Any) -> Callable[[], object]:
    encoder, decoder = msgspec.msgpack.Encoder(), msgspec.msgpack.Decoder(topic.schema)
    return lambda: decoder.decode(encoder.encode(sample))


def _in_node(topic: Topic[Any], sample: Any) -> Callable[[], object]:
    encoding = encoding_of(topic.schema)
    return lambda: decode(topic, topic.key, encode(stamped(sample, 1, 2, "0123456789abcdef")), encoding)


def measure_simulation(figures: Figures) -> None:
    """One round: a seed, with the turns of all services."""
    began = time.process_time()
    play(draw(1), known_settings())
    figures.add("simulation", "seed 1", (time.process_time() - began) / SECONDS)


def measure_serial(figures: Figures) -> None:
    """One round: frames of a base board through a pty, to a bare reader and to a board link."""
    for name in ("raw", "node"):
        with TemporaryDirectory(prefix="bench") as folder:
            ours, theirs = pty.openpty()
            tty.setraw(ours)
            tty.setraw(theirs)
            out = Path(folder) / "result"
            words = [sys.executable, "-P", "-m", "bench.alone", name, os.ttyname(theirs), str(out)]
            reader = subprocess.Popen(words, cwd=ROOT, env=dict(os.environ, PYTHONPATH=str(ROOT)))
            try:
                _write(ours, out)
                reader.wait(timeout=10.0)
            finally:
                reader.kill()
                reader.wait()
                os.close(ours)
                os.close(theirs)
            found = json.loads(out.read_text(encoding="utf-8"))
        figures.add("serial p50", name, found["p50"])
        figures.add("serial processor", name, found["worked"])


def _write(ours: int, started: Path) -> None:
    while not started.exists():
        time.sleep(0.01)
    time.sleep(_PAUSE)
    hello = HelloFrame(*[0] * len(HelloFrame.__struct_fields__))
    fields = {"board": BoardKind.BASE, "protocol_hash": BASE_BOARD.protocol_hash, "boot_id": 1}
    os.write(ours, framed(msgspec.structs.replace(hello, **fields).pack()))
    report = WheelsFrame(*[0] * len(WheelsFrame.__struct_fields__))
    due = time.monotonic()
    for _ in range(_FRAMES):
        due += 1.0 / _HZ
        time.sleep(max(0.0, due - time.monotonic()))
        os.write(ours, framed(msgspec.structs.replace(report, board_us=_now_us()).pack()))


def read(kind: str, path: str, out: Path) -> None:
    """Take all frames, and leave how soon they came and what that took."""
    waits: list[float] = []

    def take(frame: Frame) -> None:
        if isinstance(frame, WheelsFrame):
            waits.append(((_now_us() - frame.board_us) % _WRAP) * 1e-6)

    if kind == "raw":
        descriptor, decoder = os.open(path, os.O_RDWR | os.O_NOCTTY), Decoder(BASE_BOARD.frames)
        out.touch()
        worked = time.process_time()
        while len(waits) < _FRAMES:
            for frame in decoder.feed(os.read(descriptor, 4096)):
                take(frame)
    else:
        link = BoardLink(path, BASE_BOARD)
        link.poll(time.monotonic())
        out.touch()
        worked = time.process_time()
        while len(waits) < _FRAMES:
            readable = wait_for((link,), min(link.wait(time.monotonic()), 0.1))
            now = time.monotonic()
            if (readable or link.wait(now) <= 0.0) and link.ready(now):
                for frame in link.poll(now):
                    take(frame)
    took = (time.process_time() - worked) / _FRAMES * 1e6
    out.write_text(json.dumps({"worked": took, **quantiles_us(waits)}), encoding="utf-8")


def _now_us() -> int:
    return (time.monotonic_ns() // 1000) % _WRAP


if __name__ == "__main__":
    read(sys.argv[1], sys.argv[2], Path(sys.argv[3]))
