"""What can be wrong with a robot or its machines, made real, and what `giraff doctor` says of it."""

import os
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec

from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import PROTOCOL_HASH, BoardKind, HelloFrame, HelloRequestFrame
from giraff_sim.board import ROOT
from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import ProcessRobot
from tests.support.zygote import run_giraff
from tests.unit.node.ports import FakePort

Told = tuple[int, list[dict[str, str]]]
"""Exit code and findings."""


def doctor(environment: Mapping[str, str], *words: str, before: tuple[str, ...] = (), cwd: Path | None = None) -> Told:
    """What it says to programs. `before`: a command that runs it elsewhere."""
    asked = ("doctor", "--json", *words)
    if before:
        streams: dict[str, Any] = {"capture_output": True, "text": True}
        command = [*before, str(GIRAFF), *asked]
        done = subprocess.run(command, check=False, env=environment, cwd=cwd, timeout=60.0, **streams)
    else:
        done = run_giraff(asked, cwd or Path.cwd(), environment, 60.0)
    assert done.stderr == "", done.stderr
    return done.returncode, msgspec.json.decode(done.stdout)["findings"]


def faults(told: Told) -> list[str]:
    return [f"{each['about']}: {each['what']} -> {each['fix']}" for each in told[1] if each["severity"] == "fault"]


def until(robot: ProcessRobot, look: Callable[[], Told], holds: Callable[[Told], bool]) -> Told:
    """Look until that is so: what follows from a change takes its time."""
    seen: list[Told] = []

    def again() -> bool:
        seen.append(look())
        return holds(seen[-1])

    try:
        robot.wait("it", again, 60.0)
    except AssertionError:
        raise AssertionError(f"not in {seen[-1]}") from None
    return seen[-1]


@contextmanager
def board_of_other_protocol(link: Path, kind: BoardKind) -> Iterator[FakePort]:
    """A board that was flashed from other sources: it says so in its hello, and reports unasked, as each board does."""
    port, ended = FakePort(link), threading.Event()
    hello = HelloFrame(seq=0, board_us=0, board=kind, protocol_hash=PROTOCOL_HASH ^ 1, boot_id=1, reset_cause=0)

    def answer() -> None:
        decoder = Decoder()
        while not ended.wait(0.02):
            port.say(b"\0")
            for frame in decoder.feed(port.heard()):
                if isinstance(frame, HelloRequestFrame):
                    port.say(encode(hello.pack()))

    thread = threading.Thread(target=answer)
    thread.start()
    try:
        yield port
    finally:
        ended.set()
        thread.join()
        port.close()


def with_clock(environment: dict[str, str], folder: Path, ahead: float) -> dict[str, str]:
    """As on a host whose wall clock is wrong by so many s."""
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(
        f"import time\n_true = time.time_ns\ntime.time_ns = lambda: _true() + {round(ahead * 1e9)}\n"
    )
    return environment | {"PYTHONPATH": str(folder)}


def with_other_sources(environment: dict[str, str], folder: Path) -> dict[str, str]:
    """As on a host that was not updated with the others."""
    shutil.copytree(ROOT / "schemas", folder, ignore=shutil.ignore_patterns("__pycache__"))
    with (folder / "giraff_schemas" / "messages.py").open("a") as source:
        source.write("\n# as it was last month\n")
    return environment | {"PYTHONPATH": str(folder)}


@contextmanager
def instead(robot: ProcessRobot, service: str, environment: dict[str, str]) -> Iterator[None]:
    """A service that was started with another environment; then the right one again."""
    robot.kill(service)
    rightly, robot.environment = robot.environment, environment
    robot.start(service)
    robot.environment = rightly
    try:
        yield
    finally:
        robot.kill(service)
        robot.start(service)


@contextmanager
def as_nobody(robot: ProcessRobot, service: str, port: str) -> Iterator[None]:
    """A service that may not open its port, whoever runs this test."""
    robot.kill(service)
    device = Path(os.path.realpath(robot.ports / service))
    mode = device.stat().st_mode
    device.chmod(0o600 if os.geteuid() == 0 else 0)
    plain = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
    command = [*plain, sys.executable, "-P", "-m", "giraff_node", service]
    with tempfile.TemporaryDirectory() as state:  # of its own: the robot's is none that nobody may look into
        Path(state).chmod(0o777)
        environment = robot.environment | {port: str(device), "STATE_DIRECTORY": state}
        with (robot.directory / "nobody.log").open("wb") as log:
            process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        try:
            yield
        finally:
            process.kill()
            process.wait()
            device.chmod(mode)
            robot.start(service)
