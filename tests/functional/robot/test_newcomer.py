"""Somebody who has just typed `giraff run`, and pastes what it prints and what README says, in another folder."""

import os
import re
import shlex
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from giraff_core.estop.request import BY_WORD
from giraff_sim.board import ROOT
from tests.support.elsewhere import GIRAFF
from tests.support.keyboard_user import hold, take
from tests.support.process_robot import PATIENCE
from tests.support.sites import Sites
from tests.support.terminals import Screen, screen
from tests.support.waiting import wait

HOME = "home"
_UP = b"\x1b[A"
_PATH = re.compile(r"path +(\d+\.\d+) m")
_README = re.compile(r"## Stop it, and ask it why\n.*?```sh\n(.*?)```", re.DOTALL)


class Newcomer:
    """A run in one terminal, on a network where nobody else is, and a folder without any file for the other one."""

    def __init__(self, home: Sites, folder: Path) -> None:
        self._home = home
        self.folder = folder
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")}
        self.environment |= {"TERM": "xterm", "PATH": f"{GIRAFF.parent}:{self.environment['PATH']}"}
        self.environment.pop("VIRTUAL_ENV", None)
        self._said = folder.with_name("said")

    @contextmanager
    def runs(self) -> Iterator[None]:
        """Type `giraff run`; Ctrl-C at the end."""
        # A terminal that has not activated anything: what is printed there has to work in another one as it is.
        bare = self.environment | {"PATH": "/usr/bin:/bin"}
        with self._said.open("wb") as output:
            run = subprocess.Popen(self._at_home(str(GIRAFF), "run"), cwd=ROOT, env=bare, stdout=output, stderr=output)
        try:
            yield
            run.send_signal(signal.SIGINT)
            assert run.wait(PATIENCE) == 0, self.said
        finally:
            run.kill()
            run.wait()

    @property
    def said(self) -> str:
        """All that the run has printed."""
        return self._said.read_text()

    @property
    def printed(self) -> dict[str, str]:
        """The commands that it has printed, by their first word after `giraff`."""
        lines = [line.strip() for line in self.said.splitlines() if line.startswith("    /")]
        return {shlex.split(line)[1]: line for line in lines}

    @property
    def paths(self) -> list[float]:
        """m that the robot has driven, by the world's truth, second by second."""
        return [float(path) for path in _PATH.findall(self.said)]

    def pastes(self, line: str) -> tuple[int, str]:
        """Exit code, and what it said. What goes on is ended by Ctrl-C."""
        command = self._at_home("sh", "-c", f"exec {line}")
        with subprocess.Popen(
            command,
            cwd=self.folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        ) as process:
            try:
                assert process.stdout is not None
                begins = ""
                if line.endswith("watch"):
                    begins = next(process.stdout) + next(process.stdout)
                    process.send_signal(signal.SIGINT)
                if line.endswith("record"):
                    begins = next(process.stdout)
                    wait(self._has_record, PATIENCE, what="nothing is recorded")
                    process.send_signal(signal.SIGINT)
                rest, _ = process.communicate(timeout=PATIENCE)
            finally:
                process.kill()
        return process.returncode, begins + rest

    @contextmanager
    def opens(self, line: str) -> Iterator[Screen]:
        """The same in a terminal, with a person in it."""
        command = self._at_home("sh", "-c", f"cd {shlex.quote(str(self.folder))} && exec {line}")
        with screen(["/usr/bin/env", *command], self.folder.with_name("errors"), self.environment) as shown:
            yield shown

    def _has_record(self) -> bool:
        return any(file.stat().st_size > 10_000 for file in self.folder.glob("*.mcap"))

    def _at_home(self, *words: str) -> list[str]:
        return self._home.command(HOME, *words)


@pytest.fixture
def newcomer(tmp_path: Path) -> Iterator[Newcomer]:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    with Sites(HOME) as home:
        made = Newcomer(home, folder)
        with made.runs():
            wait(lambda: "base driving" in made.said, PATIENCE, what=lambda: made.said)
            yield made


def drive(newcomer: Newcomer, shown: Screen, metres: float) -> None:
    """Hold a key down until the robot has driven so far; let go and take it again where it was late, and stands."""
    begins = newcomer.paths[-1]

    def has_driven() -> bool:
        before = newcomer.paths[-1]
        hold(shown, _UP, 2.0)
        if newcomer.paths[-1] == before:
            take(shown, _UP)
        return newcomer.paths[-1] - begins >= metres

    wait(has_driven, PATIENCE, what=lambda: f"{metres} m: {shown.read()[-3000:]}")


def test_a_newcomer_drives_stops_asks_and_watches_with_what_is_printed(newcomer: Newcomer) -> None:
    printed = newcomer.printed
    assert list(printed) == ["drive", "stop", "why", "watch"]

    with newcomer.opens(printed["drive"]) as shown:
        shown.wait_for("not yours: demo drives", PATIENCE)
        take(shown, _UP)
        drive(newcomer, shown, 0.5)
        wait(lambda: newcomer.paths[-1] == newcomer.paths[-2], PATIENCE, what="it drives on with no key held")
        stands, seconds = newcomer.paths[-1], len(newcomer.paths)
        wait(lambda: len(newcomer.paths) > seconds, PATIENCE, what="another second")
        assert newcomer.paths[-1] == stands
        shown.type(b"\x03")
        assert shown.ended(PATIENCE) == 0
        assert shown.is_restored()
    assert "the demonstration waits for 30 s of quiet" in newcomer.said

    code, told = newcomer.pastes(printed["stop"])
    assert code == 0, told
    # On a busy machine base may not prove in time that it is of this host.
    assert re.search(rf": STOPPED(, {BY_WORD})?, latch ", told)
    answers: list[str] = []

    def names_the_stop() -> bool:
        code, told = newcomer.pastes(printed["why"])
        answers.append(told)
        assert code == 1, told
        return "e-stop: engaged by" in told

    # On a busy machine a range may come late just now: the guard then blocks, and is named before the e-stop.
    wait(names_the_stop, PATIENCE, what=lambda: answers[-1])
    code, told = newcomer.pastes(printed["watch"])
    assert code == 0, told

    [listed] = _README.findall((ROOT / "README.md").read_text())
    lines = [line.partition("#")[0].strip() for line in listed.splitlines()]
    assert lines[0] == "giraff stop"
    for line in lines:
        code, told = newcomer.pastes(line)
        assert code == 0, f"{line}: {told}"
    assert newcomer.paths[-1] == stands, "what only asks, stops or releases has moved it"
