"""The stacks that are compared: bare Zenoh, bare Zenoh that decodes, and a Node as a service gets it.

Each sends its moment and a number, and passes both to a callback where a program of its kind would get them. Imports
are inside the classes: what a process imports is part of what is measured.
"""

import os
import struct
import threading
from collections.abc import Callable
from importlib import import_module
from typing import Any, Final, Protocol

Send = Callable[[int, float], None]
"""Sends a number and a moment (monotonic, s)."""
SAMPLE: Final[dict[str, Any]] = {
    "yaw": 0.7,
    "linear_x": 0.3,
    "angular_z": -0.2,
    "covariance": (1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6),
    "path": 1.25,
    "board_us": 123_456_789,
    "boot_id": 4_000_000_000,
}
"""Fields of the odometry that is sent. `x` carries the moment and `y` the number."""


class Stack(Protocol):
    """One end of a pair of processes."""

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        """`blocks`: wait for a full link instead of dropping."""
        ...

    def subscribe(self, key: str, callback: Send) -> None: ...

    def run(self, ended: threading.Event, /) -> None:
        """Do what the main thread of such a program does, until the event is set."""
        ...


class Waiting:
    """A stack whose callbacks come in threads of its own."""

    def run(self, ended: threading.Event, /) -> None:
        ended.wait()


class Raw(Waiting):
    """Zenoh alone: `put` of bytes and the default callback. It decodes nothing but moment and number."""

    def __init__(self, size: int) -> None:
        """`size`: bytes of a sample."""
        import zenoh  # noqa: PLC0415

        self._zenoh = zenoh
        self._session = zenoh.open(zenoh.Config.from_json5(os.environ["BENCH_SESSION"]))
        self._head, self._rest = struct.Struct("<qd"), bytes(size - 16)
        self._declared: list[Any] = []

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        put, pack, rest = self._put(key, blocks=blocks), self._head.pack, self._rest
        return lambda number, moment: put(pack(number, moment) + rest)

    def subscribe(self, key: str, callback: Send) -> None:
        unpack = self._head.unpack_from

        def on_sample(received: Any) -> None:
            number, moment = unpack(bytes(received.payload))
            callback(number, moment)

        self._declared.append(self._session.declare_subscriber(f"giraff/bench/{key}", on_sample))

    def _put(self, key: str, *, blocks: bool) -> Callable[[bytes], None]:
        """With the priority that a Node gives to odometry."""
        congestion = self._zenoh.CongestionControl
        put: Callable[[bytes], None] = self._session.declare_publisher(
            f"giraff/bench/{key}",
            congestion_control=congestion.BLOCK if blocks else congestion.DROP,
            priority=self._zenoh.Priority.DATA_HIGH,
        ).put
        return put


class Floor(Raw):
    """The same, with the encoder and decoder of msgspec for our message."""

    def __init__(self, size: int) -> None:
        import msgspec  # noqa: PLC0415

        from giraff_schemas.messages import Odometry, RobotTime  # noqa: PLC0415

        super().__init__(size)
        self._type, self._tick = Odometry, RobotTime(epoch=7, robot_ns=5_000_000_000)
        self._encode = msgspec.msgpack.Encoder().encode
        self._decode = msgspec.msgpack.Decoder(Odometry).decode

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        put, made, encode, tick = self._put(key, blocks=blocks), self._type, self._encode, self._tick

        def send(number: int, moment: float) -> None:
            put(encode(made(instance="0123456789abcdef", x=moment, y=float(number), tick=tick, **SAMPLE)))

        return send

    def subscribe(self, key: str, callback: Send) -> None:
        decode = self._decode

        def on_sample(received: Any) -> None:
            sample = decode(bytes(received.payload))
            callback(int(sample.y), sample.x)

        self._declared.append(self._session.declare_subscriber(f"giraff/bench/{key}", on_sample))


class Ours:
    """A `Node`: `Publisher.put`, `inbox`, and a turn that `node.run` makes."""

    timers = ()
    link = None

    def __init__(self, _: int) -> None:
        from giraff_node.node import Node  # noqa: PLC0415
        from giraff_schemas import codec, messages, topics  # noqa: PLC0415

        self._codec, self._topic = codec, topics.Topic
        self._type, self._tick = messages.Odometry, messages.RobotTime(epoch=7, robot_ns=5_000_000_000)
        service = os.environ["BENCH_SERVICE"]
        config = getattr(import_module(f"giraff_{service}.config"), f"{service.capitalize()}Config")
        self._node: Any = Node(service, config)
        self._node.__enter__()
        self._heard: list[tuple[Any, Send]] = []

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        made, tick = self._type, self._tick
        put: Callable[[Any], None] = self._blocking(key) if blocks else self._node.publisher(self._row(key)).put

        def send(number: int, moment: float) -> None:
            put(made(x=moment, y=float(number), tick=tick, **SAMPLE))

        return send

    def subscribe(self, key: str, callback: Send) -> None:
        self._heard.append((self._node.inbox(self._row(key), 1_000_000), callback))

    def turn(self, _: float) -> None:
        for inbox, callback in self._heard:
            for sample in inbox.take():
                callback(int(sample.y), sample.x)

    def end(self) -> None:
        """Nothing is left to say."""

    def run(self, _: threading.Event) -> None:
        self._node.run(self, prompt=True)

    def _row(self, key: str) -> Any:
        return self._topic(key, self._type, 100, "state")

    def _blocking(self, key: str) -> Callable[[Any], None]:
        """What a Node's publisher does, but waiting for a full link."""
        import zenoh  # noqa: PLC0415

        codec, instance, seq = self._codec, self._node.instance, 0
        put = self._node.session.declare_publisher(
            f"giraff/{self._node.robot.name}/{key}",
            encoding=codec.encoding_of(self._type),
            congestion_control=zenoh.CongestionControl.BLOCK,
            priority=zenoh.Priority.DATA_HIGH,
        ).put

        def send(sample: Any) -> None:
            nonlocal seq
            put(codec.encode(codec.stamped(sample, seq, seq, instance)))
            seq += 1

        return send


STACKS: Final[dict[str, Callable[[int], Stack]]] = {"raw": Raw, "floor": Floor, "node": Ours}
"""By name; those of other projects are in peers.py."""


def payload_size() -> int:
    """Bytes of a sample as a Node sends it."""
    from giraff_schemas.codec import encode, stamped  # noqa: PLC0415
    from giraff_schemas.messages import Odometry, RobotTime  # noqa: PLC0415

    sample = Odometry(x=1234.5678, y=7.0, tick=RobotTime(epoch=7, robot_ns=5_000_000_000), **SAMPLE)
    return len(encode(stamped(sample, 1000, 1_700_000_000_000_000_000, "0123456789abcdef")))
