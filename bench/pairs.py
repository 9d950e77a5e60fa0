"""Pairs of processes, one of each stack: how soon samples come, what they cost, how many go, how soon it begins."""

import contextlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import psutil

from bench import peers
from bench.figures import Figures
from bench.meter import usage
from bench.stacks import payload_size
from giraff_core.network import NetworkConfig
from giraff_node.network.session import session_config
from giraff_sim.board import BUILD, ROOT
from giraff_sim.bodies.wheels.body import KNOWN
from giraff_tools.network.ports import free_port

_SERVICE: Final = {"out": "odometry", "back": "motion"}
"""By the side of a pair, the service whose name it has: one of the robot's own."""
_STARTS: Final = 3
"""Of each stack in a round."""
_TURNS: Final = 3
"""Of each stack at each measurement in a round: what else this machine does then falls on all alike."""
_MIB: Final = 1 << 20
_PATIENCE: Final = 30.0  # s


class Worker:
    """One process of a pair, at its command socket."""

    def __init__(self, connection: socket.socket, pid: int) -> None:
        self.pid = pid
        self._lines = connection.makefile("rw")

    def __call__(self, do: str, **more: object) -> dict[str, Any]:
        self._lines.write(json.dumps({"do": do, **more}) + "\n")
        self._lines.flush()
        answer: dict[str, Any] = json.loads(self._lines.readline())
        return answer


class RunningPair:
    """Both ends of a stack, and how long they took to the first sample."""

    def __init__(self, end: ExitStack, stack: str, interpreter: str, size: int) -> None:
        folder = Path(end.enter_context(TemporaryDirectory(prefix="bench")))
        orders = end.enter_context(socket.socket(socket.AF_UNIX))
        orders.bind(str(folder / "orders"))
        orders.listen()
        orders.settimeout(_PATIENCE)
        port = free_port()
        environment = {side: session_environment(folder, service, port) for side, service in _SERVICE.items()}
        words = [interpreter, "-P", "-m", "bench.worker", stack]
        commands = {side: [*words, side, str(folder / "orders"), str(size)] for side in _SERVICE}
        began = time.monotonic()
        self._started = []
        for process in peers.start(stack, commands, environment, folder):
            end.callback(_kill, process)
            self._started.append(process.pid)
        found = {}
        for _ in _SERVICE:
            try:
                connection, _ = orders.accept()
            except TimeoutError:
                logs = "".join(path.read_text(encoding="utf-8")[-2000:] for path in folder.glob("*.log"))
                raise RuntimeError(f"{stack} did not start within {_PATIENCE:g} s; it said:\n{logs}") from None
            end.enter_context(connection)
            side, pid = connection.makefile().readline().split()
            found[side] = Worker(connection, int(pid))
        self.out, self.back = found["out"], found["back"]
        until = began + _PATIENCE
        while not (first := self.back("first")["at"]) and time.monotonic() < until:
            time.sleep(0.01)
        if not first:
            raise RuntimeError(f"{stack}: no sample came within {_PATIENCE:g} s")
        self.first = first - began
        """s from the start of both processes to the first sample."""
        self.out("idle")  # ends its first samples

    def memory_beside(self) -> float:
        """Return the MiB of a master or a daemon."""
        family = {each for pid in self._started for each in _family(pid)}
        return (
            float(sum(each.memory_info().rss for each in family if each.pid not in {self.out.pid, self.back.pid}))
            / _MIB
        )


def measure(figures: Figures) -> None:
    """One round of all; each short measurement of one stack is followed by that of the next."""
    size, stacks = payload_size(), _interpreters()
    for _ in range(_STARTS):
        for stack, interpreter in stacks.items():
            with _running(stack, interpreter, size) as pair:
                figures.add("cold start", stack, pair.first * 1e3)
    with ExitStack() as end:
        pairs = {stack: end.enter_context(_running(stack, interpreter, size)) for stack, interpreter in stacks.items()}
        time.sleep(0.5)  # until each has come to rest
        for turn in range(_TURNS):
            _ways(figures, [*pairs.items()][turn % len(pairs) :] + [*pairs.items()][: turn % len(pairs)])
        for stack, pair in pairs.items():
            figures.add("memory", stack, usage(pair.back.pid).rss)  # before it keeps the times of a burst
            if beside := pair.memory_beside():
                figures.add("memory beside", stack, beside)
        for _ in range(_TURNS):
            for stack, pair in pairs.items():
                _burst(figures, stack, pair)


def _ways(figures: Figures, order: Sequence[tuple[str, RunningPair]]) -> None:
    for rate, count in ((100, 80), (1000, 800)):
        for stack, pair in order:
            _one_way(figures, stack, pair, rate, count)
    for stack, pair in order:
        _start(pair, returns=True)
        pair.out("round_trips", count=400)
        figures.add("round trip p50", stack, pair.out("result")["p50"])


@cache
def _interpreters() -> dict[str, str]:
    """Of each stack that is compared."""
    others = peers.interpreters(BUILD / "bench") if os.environ.get("PEERS", "") not in ("", "0") else {}
    return dict.fromkeys(("raw", "floor", "node"), sys.executable) | others


def _one_way(figures: Figures, stack: str, pair: RunningPair, rate: int, count: int) -> None:
    _start(pair, returns=False)
    before = pair.back("worked")["worked"]
    sent = pair.out("pace", rate=rate, count=count)
    worked = pair.back("worked")["worked"] - before
    result = pair.back("result")
    figures.add(f"one way {rate} Hz p50", stack, result["p50"])
    figures.add(f"one way {rate} Hz p90", stack, result["p90"])
    figures.add(f"publisher {rate} Hz", stack, sent["worked"] / count * 1e6)
    figures.add(f"subscriber {rate} Hz", stack, worked / count * 1e6)


def _burst(figures: Figures, stack: str, pair: RunningPair) -> None:
    _start(pair, returns=False)
    sent = pair.out("burst", seconds=0.3)
    heard = pair.back("result")
    figures.add("burst", stack, heard["count"] / heard["seconds"])
    figures.add("burst lost", stack, sent["sent"] - heard["count"])


def _start(pair: RunningPair, *, returns: bool) -> None:
    pair.back("start", returns=returns)
    pair.out("start", returns=False)


@contextmanager
def _running(stack: str, interpreter: str, size: int) -> Iterator[RunningPair]:
    with ExitStack() as end:
        yield RunningPair(end, stack, interpreter, size)


def session_environment(folder: Path, service: str, port: int) -> dict[str, str]:
    """What a service of the robot's own is given, on a network of its own; for bare Zenoh the same as its JSON."""
    rendezvous = f"127.0.0.1:{port}"
    network = NetworkConfig(local=True, sockets=str(folder), rendezvous=rendezvous)
    given = {name: value for name, value in os.environ.items() if not name.startswith(("GIRAFF_", "PYTHON"))}
    return {
        **given,
        **KNOWN,
        "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
        "GIRAFF_ROBOT_NAME": "bench",
        "GIRAFF_NETWORK_LOCAL": "true",
        "GIRAFF_NETWORK_SOCKETS": str(folder),
        "GIRAFF_NETWORK_RENDEZVOUS": rendezvous,
        "PYTHONPATH": str(ROOT),
        "BENCH_SERVICE": service,
        "BENCH_SESSION": json.dumps(session_config(network, "bench", "inside", name=service)),
        "BENCH_PAIR": str(port),
        "ROS_MASTER_URI": f"http://{rendezvous}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(folder),
    }


def _family(pid: int) -> list[psutil.Process]:
    """Return a process and all below it: a master starts some in sessions of their own."""
    process = psutil.Process(pid)
    return [process, *process.children(recursive=True)]


def _kill(process: subprocess.Popen[bytes]) -> None:
    for each in _family(process.pid):
        with contextlib.suppress(psutil.NoSuchProcess):
            each.kill()
    process.wait()
