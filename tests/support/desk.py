"""The `giraff` command as somebody at a desk calls it: another process, which knows the network and no robot file."""

import os
import subprocess
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from giraff_tools.network.ports import free_port
from tests.support.elsewhere import GIRAFF, clean
from tests.support.waiting import wait
from tests.support.zygote import run_giraff

WordsT = TypeVar("WordsT")
EndedT = TypeVar("EndedT")

Done = subprocess.CompletedProcess[str]


class Desk:
    """Calls `giraff` on one loopback, so that no other robot of this machine is heard."""

    def __init__(self, directory: Path, rendezvous: str, robot: str = "") -> None:
        """`directory`: where the commands run. `robot`: the one that is meant; empty: nobody has named one."""
        self.directory = directory
        self.rendezvous = rendezvous
        self._robot = robot

    def unnamed(self) -> "Desk":
        """The same network, with no robot named."""
        return Desk(self.directory, self.rendezvous)

    def alone(self) -> "Desk":
        """A network on which nobody is."""
        return Desk(self.directory, f"127.0.0.1:{free_port()}")

    @property
    def environment(self) -> Mapping[str, str]:
        named = {"GIRAFF_ROBOT_NAME": self._robot} if self._robot else {}
        network = {"GIRAFF_NETWORK_LOCAL": "true", "GIRAFF_NETWORK_RENDEZVOUS": self.rendezvous}
        return clean(dict(os.environ)) | network | named

    def run(self, *words: str, timeout: float = 60.0) -> Done:
        """The command, once it has ended; forked, see `zygote`."""
        return run_giraff(words, self.directory, self.environment, timeout)

    def until(self, holds: Callable[[Done], object], *words: str) -> Done:
        """The command, called until what it says holds: on a busy machine not everybody is met at the first call."""
        done: list[Done] = []

        def it_holds() -> object:
            done.append(self.run(*words))
            return holds(done[-1])

        wait(it_holds, 60.0, what=lambda: f"{words} never says it: {done[-1]}")
        return done[-1]

    def json_until(self, holds: Callable[[Any], object], *words: str) -> Any:
        """The one document that a command with --json prints when all is well, once it holds."""
        done = self.until(lambda done: is_well(done) and holds(msgspec.json.decode(done.stdout)), *words, "--json")
        return msgspec.json.decode(done.stdout)

    def json(self, *words: str) -> Any:
        """The one document that a command with --json prints, when all is well."""
        done = self.run(*words, "--json")
        assert (done.returncode, done.stderr) == (0, ""), (words, done)
        return msgspec.json.decode(done.stdout)

    @contextmanager
    def running(self, *words: str, **environment: str) -> Iterator[subprocess.Popen[str]]:
        """The command while it runs; it ends with the block. `environment`: more of it."""
        streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        command = [str(GIRAFF), *words]
        with subprocess.Popen(
            command, cwd=self.directory, env={**self.environment, **environment}, **streams
        ) as process:
            try:
                yield process
            finally:
                process.kill()


def is_well(done: Done) -> bool:
    """All it was asked for, and no complaint."""
    return (done.returncode, done.stderr) == (0, "")


def run_beside(run: Callable[[WordsT], EndedT], all_words: Iterable[WordsT]) -> dict[WordsT, EndedT]:
    """Commands, most of whose time is patience, some beside each other."""
    all_words = list(all_words)
    with ThreadPoolExecutor(4) as runners:
        return dict(zip(all_words, runners.map(run, all_words), strict=True))
