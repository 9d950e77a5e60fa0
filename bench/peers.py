"""Other projects' stacks, each in its own interpreter: their adapters, and how they are had. PEERS=1 make bench.

ROS 1 is Debian's, and is never installed from here. The others come from PyPI into environments below build/bench. What
cannot be had is named and left out.
"""

import os
import shutil
import struct
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from bench.stacks import STACKS, Send, Waiting

_ROSPY: Final = (
    "apt-get install --no-install-recommends python3-rospy python3-roslaunch python3-rosmaster ros-core "
    "python3-std-msgs python3-geometry-msgs python3-nav-msgs python3-rostopic"
)
_FROM_PYPI: Final = {"rose-py": ("rose-py",), "babyros": ("babyros",), "dora": ("dora-rs", "dora-rs-cli", "pyarrow")}
_FIELDS: Final = (1.25, -2.5, 0.7, 0.3, -0.2, 12.4)
"""Beside number and moment."""


def _key(key: str) -> str:
    """Nobody else on this network has it."""
    return f"bench{os.environ['BENCH_PAIR']}/{key}"


class Rospy(Waiting):
    """ROS 1, with TwistStamped."""

    def __init__(self, _: int) -> None:
        self._rospy: Any = import_module("rospy")
        self._type: Any = import_module("geometry_msgs.msg").TwistStamped
        self._rospy.init_node(f"bench_{os.getpid()}", disable_signals=True)

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        """`blocks`: it then writes to the link itself, and waits."""
        publisher = self._rospy.Publisher(f"/bench/{key}", self._type, queue_size=None if blocks else 10)

        def send(number: int, moment: float) -> None:
            message = self._type()
            linear, angular = message.twist.linear, message.twist.angular
            linear.x, linear.y, linear.z, angular.x = _FIELDS[:4]
            angular.y, angular.z = moment, number
            publisher.publish(message)

        return send

    def subscribe(self, key: str, callback: Send) -> None:
        def on_message(message: Any) -> None:
            callback(int(message.twist.angular.z), message.twist.angular.y)

        self._rospy.Subscriber(f"/bench/{key}", self._type, on_message, tcp_nodelay=True)


class Rose(Waiting):
    """rose-py: Zenoh and msgspec."""

    def __init__(self, _: int) -> None:
        import_module("loguru").logger.remove()
        rose: Any = import_module("rose")
        names = ("n", "t", *"abcdef")
        self._type: Any = type("Odom", (rose.Message,), {"__annotations__": dict.fromkeys(names, float) | {"n": int}})
        self._node = rose.Node(f"bench_{os.getpid()}")
        self._kept: list[Any] = []

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        del blocks  # it has no such publisher
        self._kept.append(publisher := self._node.create_publisher(_key(key), self._type))
        fields = dict(zip("abcdef", _FIELDS, strict=True))
        return lambda number, moment: publisher.publish(self._type(n=number, t=moment, **fields))

    def subscribe(self, key: str, callback: Send) -> None:
        subscriber = self._node.create_subscriber(
            _key(key), self._type, lambda message, _: callback(message.n, message.t)
        )
        self._kept.append(subscriber)


class Babyros(Waiting):
    """babyros: Zenoh and dictionaries."""

    def __init__(self, _: int) -> None:
        self._node: Any = import_module("babyros").node
        self._kept: list[Any] = []

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        del blocks  # it has no such publisher
        self._kept.append(publisher := self._node.Publisher(_key(key)))
        fields = dict(zip("abcdef", _FIELDS, strict=True))
        return lambda number, moment: publisher.publish({"n": number, "t": moment, **fields})

    def subscribe(self, key: str, callback: Send) -> None:
        def on_message(message: Any) -> None:
            callback(message["n"], message["t"])

        self._kept.append(self._node.Subscriber(_key(key), on_message, history="keep_all", depth=1000))


class Dora:
    """dora: Arrow arrays through its daemon. Its node belongs to one thread, which both hears and sends."""

    def __init__(self, _: int) -> None:
        self._node: Any = import_module("dora").Node()
        self._arrow: Any = import_module("pyarrow")
        self._heard: dict[str, Send] = {}

    def publisher(self, key: str, *, blocks: bool = False) -> Send:
        del blocks  # it has no such output
        node, arrow = self._node, self._arrow
        fields = struct.Struct("<6d").pack(*_FIELDS)

        def send(number: int, moment: float) -> None:
            node.send_output(key, arrow.array(fields), {"n": number, "t": moment})

        return send

    def subscribe(self, key: str, callback: Send) -> None:
        self._heard[key] = callback

    def run(self, ended: threading.Event, /) -> None:
        while not ended.is_set():
            event = self._node.next(timeout=1.0)
            if event is not None and event["type"] == "INPUT" and event["id"] in self._heard:
                event["value"].to_pylist()
                self._heard[event["id"]](event["metadata"]["n"], event["metadata"]["t"])


STACKS.update({"rospy": Rospy, "rose-py": Rose, "babyros": Babyros, "dora": Dora})


def interpreters(folder: Path) -> dict[str, str]:
    """Return the interpreter of each stack that can be had here, and name those that cannot."""
    found = {}
    if subprocess.run(["/usr/bin/python3", "-c", "import rospy"], capture_output=True, check=False).returncode == 0:
        found["rospy"] = "/usr/bin/python3"
    else:
        print(f"rospy is left out: it is not installed; run: {_ROSPY}")
    for name, packages in _FROM_PYPI.items():
        python = folder / name / "bin" / "python"
        if not python.exists():
            uv = str(Path(sys.executable).with_name("uv"))
            for words in (
                [uv, "venv", "-q", "-p", sys.executable, str(folder / name)],
                [uv, "pip", "install", "-q", "-p", str(python), *packages],
            ):
                done = subprocess.run(words, capture_output=True, text=True, check=False)
                if done.returncode:
                    shutil.rmtree(folder / name, ignore_errors=True)
                    print(f"{name} is left out: {done.stderr.strip().splitlines()[-1]}")
                    break
        if python.exists():
            found[name] = str(python)
    return found


def start(
    stack: str, commands: Mapping[str, Sequence[str]], environment: Mapping[str, Mapping[str, str]], folder: Path
) -> Iterator[subprocess.Popen[bytes]]:
    """Start both sides, and what the stack needs beside them."""
    if stack == "dora":
        flow = ["nodes:"]
        for side, out, back in (("out", "a", "back/b"), ("back", "b", "out/a")):
            script = folder / f"{side}.sh"  # dora makes a folder `out`
            variables = " ".join(f"{name}={value}" for name, value in environment[side].items() if name == "PYTHONPATH")
            script.write_text(f"#!/bin/sh\nexec env {variables} {' '.join(commands[side])}\n", encoding="utf-8")
            script.chmod(0o755)
            flow += [f"  - id: {side}", f"    path: {script}", f"    outputs: [{out}]", "    inputs:"]
            flow += [f"      {back[-1]}:", f"        source: {back}", "        queue_size: 1000"]
        (folder / "flow.yml").write_text("\n".join([*flow, ""]), encoding="utf-8")
        dora = str(Path(commands["out"][0]).with_name("dora"))
        yield _popen([dora, "run", str(folder / "flow.yml")], environment["out"], folder / "dora.log")
        return
    if stack == "rospy":
        yield _popen(["roscore", "-p", environment["out"]["BENCH_PAIR"]], environment["out"], folder / "roscore.log")
    for side in ("back", "out"):
        yield _popen(commands[side], environment[side], folder / f"{side}.log")


def _popen(words: Sequence[str], environment: Mapping[str, str], log: Path) -> subprocess.Popen[bytes]:
    with log.open("wb") as out:
        return subprocess.Popen(words, env=environment, stdout=out, stderr=out, start_new_session=True)
