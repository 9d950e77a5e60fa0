"""`giraff` forked from a process that has imported it already, which saves four fifths of what a call costs.

A forked command has what a fresh one has: its words, folder, environment, streams, exit code, and the end of an
interpreter. Only its start is another. That each verb starts by its entry point is shown where a test needs more of a
process than that, such as a terminal, a signal or a pipe, and for the others by
tests/functional/one_robot/test_any_command.py. Services are never forked.

Run as a program, this module is the zygote. Then it imports nothing of the tests.
"""

import atexit
import ctypes
import gc
import importlib
import json
import os
import pkgutil
import selectors
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import Final, NamedTuple

_GIRAFF: Final = str(Path(sys.executable).with_name("giraff"))
_VERBS: Final = ("doctor", "estop", "frames", "graph", "node", "odom", "param", "play", "record", "top", "topic", "why")
"""Verbs that are imported before the fork. Any other one imports what it needs when it is called."""
_LONGEST_REQUEST: Final = 1 << 18
"""bytes. The kernel sends no longer packet."""
_PR_SET_PDEATHSIG: Final = 1

_starting: Final = threading.Lock()
_zygotes: Final[list[socket.socket]] = []
"""The way to the zygote of this process, once it is started."""


def run_giraff(
    words: tuple[str, ...], cwd: Path, environment: Mapping[str, str], timeout: float
) -> subprocess.CompletedProcess[str]:
    """Return what `giraff` with these words said, once it has ended. Several threads may call it at a time."""
    from tests.support.counting import count  # noqa: PLC0415  the zygote imports nothing of the tests

    count("forks")
    command = [_GIRAFF, *words]
    request = json.dumps([command, str(cwd), dict(environment)]).encode()
    answer, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with answer, TemporaryFile() as out, TemporaryFile() as err:
        with theirs:
            socket.send_fds(_zygote(), [request], [theirs.fileno(), out.fileno(), err.fileno()])
        answer.settimeout(timeout)
        try:
            status = answer.recv(16)
        except TimeoutError:
            raise subprocess.TimeoutExpired(command, timeout) from None  # closing `answer` kills the command
        assert status, "the zygote has ended"
        out.seek(0)
        err.seek(0)
        return subprocess.CompletedProcess(command, int(status), out.read().decode(), err.read().decode())


def _zygote() -> socket.socket:
    """Return the way to the zygote, and start it at the first call."""
    with _starting:
        if not _zygotes:
            ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            with theirs:
                process = subprocess.Popen(
                    [sys.executable, "-P", __file__, str(theirs.fileno())],
                    env={name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    pass_fds=[theirs.fileno()],
                    start_new_session=True,  # Ctrl-C is for pytest alone
                )
            atexit.register(process.wait)
            atexit.register(ours.close)  # comes first, and ends the zygote
            _zygotes.append(ours)
        return _zygotes[0]


class _Command(NamedTuple):
    """A forked command that has not been reaped."""

    pid: int
    ended: int
    """A descriptor that is readable when the process has ended."""
    answer: socket.socket
    """The test waits at the other end, and closes that when it gives up."""


def _serve(requests: socket.socket) -> None:
    """Fork a process for each request, and return in each of them. End when nobody can ask any more."""
    _import_giraff()
    looks = selectors.DefaultSelector()
    looks.register(requests, selectors.EVENT_READ)
    while True:
        key, _ = looks.select()[0]
        command: _Command | None = key.data
        if command is not None:
            if key.fileobj is command.answer:
                os.kill(command.pid, signal.SIGKILL)
            looks.unregister(command.ended)
            looks.unregister(command.answer)
            _reap(command)
            continue
        request, descriptors, _, _ = socket.recv_fds(requests, _LONGEST_REQUEST, 3)
        if not request:
            sys.exit()  # and the kernel kills each command that goes on
        [_] = Path("/proc/self/task").iterdir()  # only a process with one thread may fork
        zygote, pid = os.getpid(), os.fork()
        if pid == 0:
            _become(request, descriptors, zygote)
            return
        answer, *streams = descriptors
        for stream in streams:
            os.close(stream)
        command = _Command(pid, os.pidfd_open(pid), socket.socket(fileno=answer))
        looks.register(command.ended, selectors.EVENT_READ, command)
        looks.register(command.answer, selectors.EVENT_READ, command)


def _import_giraff() -> None:
    """Import what the verbs use. Nothing is opened and no thread started: that is left to what is forked."""
    import giraff_cli  # noqa: PLC0415  the tests' side of this module needs none of it

    for module in pkgutil.walk_packages(giraff_cli.__path__, "giraff_cli."):
        if module.name.split(".")[1] in _VERBS:
            importlib.import_module(module.name)
    from giraff_cli.main import app  # noqa: PLC0415
    from giraff_cli.usage import run_app  # noqa: PLC0415

    sys.argv = ["giraff", "why", "--help"]
    run_app(app)  # Typer imports most of itself at a call
    gc.collect()
    gc.freeze()  # a collection in what is forked would copy all of this memory


def _reap(command: _Command) -> None:
    """Answer with the exit code."""
    _, status = os.waitpid(command.pid, 0)
    os.close(command.ended)
    with command.answer, suppress(BrokenPipeError):
        command.answer.send(str(os.waitstatus_to_exitcode(status)).encode())


def _become(request: bytes, descriptors: list[int], zygote: int) -> None:
    """Make this process one that was started with a command, a folder and an environment."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != zygote:
        sys.exit("the zygote has ended")
    _, out, err = descriptors
    os.dup2(out, 1)
    os.dup2(err, 2)
    for descriptor in descriptors:
        os.close(descriptor)
    command, cwd, environment = json.loads(request)
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = command
    sys.orig_argv = [sys.executable, *command]


if __name__ == "__main__":
    with socket.socket(fileno=int(sys.argv[1])) as way:
        way.set_inheritable(False)
        _serve(way)
    importlib.import_module("giraff_cli.start").main()
