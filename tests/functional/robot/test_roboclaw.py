"""A base board that is a process, in front of a RoboClaw: what breaks between a script and the wheels.

Base, guard and board are processes, and so is the RoboClaw, which judges: by its record of what its motors got.
"""

import math
import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from typing import Final

import pytest

from giraff_cli.run.processes import ProcessGroup
from giraff_client import Robot, RobotError
from giraff_core.estop.latch import RELEASED
from giraff_node.network.query_client import QueryClient
from giraff_node.process.state import write_latch
from giraff_schemas.requests import EStopReset
from giraff_schemas.topics import ESTOP, ESTOP_RESET, TICK
from giraff_sim.board import BUILD, ROOT
from giraff_sim.bodies.wheels.body import KNOWN
from giraff_tools.network.ports import free_port
from tests.support.observer import Observer
from tests.support.roboclaw import PATIENCE, Terminal
from tests.support.waiting import wait

NAME: Final = "sim-roboclaw"
SPEED: Final = 0.1  # m/s
CONTROLLER: Final = 0.2
"""s without a byte, after which the controller gives no power."""
BASE_IS_SILENT: Final = 0.3 + CONTROLLER
"""s: a board that stands still at the end of its own time-out has the controller's behind it."""
STUCK: Final = 0.5 + CONTROLLER
"""s, as a board judges a wheel that does not turn."""
AIR: Final = 0.1  # s


class Rig:
    """The processes, and a script that drives forward whenever it can."""

    def __init__(self, directory: Path, environment: dict[str, str], end: ExitStack) -> None:
        self.directory, self.environment = directory, environment
        self.terminal = end.enter_context(Terminal(directory))
        self.armed: list[float] = []
        """When the script was allowed to drive, s."""
        self.losses = 0
        """Number of times that the leave to drive was taken away again."""
        (directory / "eeprom").write_bytes(b"torn")
        self.start_board()
        end.callback(lambda: self.end_board(signal.SIGKILL))
        self.processes = ProcessGroup(directory)
        end.callback(lambda: self.processes.stop_all(PATIENCE))
        for service in ("base", "guard"):
            self.start(service)
        self.observer = Observer(environment)
        end.callback(self.observer.close)
        for topic in (ESTOP, TICK):
            self.observer.follow(topic)
        ended = threading.Event()
        script = threading.Thread(target=self._drive_on, args=(ended,))
        script.start()
        end.callback(script.join)
        end.callback(ended.set)

    def start(self, service: str) -> None:
        self.processes.start(service, "giraff_node", (service,), self.environment)

    def start_board(self) -> None:
        words = ("--line", self.terminal.link, "--port", self.directory / "port", "--eeprom", self.directory / "eeprom")
        with (self.directory / "board.log").open("ab") as log:
            self.board = subprocess.Popen([BUILD / "firmware" / "roboclaw", *words], stderr=log)
        with suppress(PermissionError):
            os.setpriority(os.PRIO_PROCESS, self.board.pid, -11)

    def signal_board(self, number: signal.Signals) -> None:
        self.board.send_signal(number)

    def end_board(self, number: signal.Signals) -> int:
        self.signal_board(number)
        return self.board.wait()

    def kill_base(self) -> None:
        os.kill(self.processes.pid("base"), signal.SIGKILL)
        wait(self.processes.reap, PATIENCE)

    def drives(self) -> bool:
        return bool(self.terminal.truth()["speed"][0] > SPEED / 2)

    def is_stopped(self) -> bool:
        estop = self.observer.newest(ESTOP)
        return estop is not None and estop.engaged

    def has_recovered(self, broken: float) -> bool:
        """It drives by a new permission. An emergency stop is reset, as often as there is one."""
        if self.is_stopped():
            estop, tick = self.observer.newest(ESTOP), self.observer.newest(TICK)
            assert estop is not None
            assert tick is not None
            request = EStopReset(by="test", id=estop.id, tick=tick.time)
            asking = QueryClient(self.observer.door, NAME, ESTOP_RESET, request)
            wait(lambda: asking.poll(time.monotonic()) is not None, PATIENCE)
        return max(self.armed, default=0.0) > broken and self.drives()

    def power(self, since: float, until: float) -> list[tuple[float, list[int]]]:
        """Return the duties but zero in this time and after some air, as the controller has recorded them."""
        since += AIR + self.terminal.truth()["late"]
        return [(at, duty) for at, duty in self.terminal.duties(since, until) if any(duty)]

    def last_words(self) -> str:
        return "".join(f"\n{log.name}: {log.read_text()[-800:]}" for log in self.directory.glob("*.log"))

    def _drive_on(self, ended: threading.Event) -> None:
        while not ended.is_set():
            with suppress(RobotError), Robot(NAME, patience=10.0) as robot:
                while not ended.is_set():
                    with suppress(RobotError):
                        robot.arm()
                        self.armed.append(time.monotonic())
                        while not ended.is_set():
                            robot.drive(SPEED, 0.0)
                    self.losses += 1


@pytest.fixture
def rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Rig]:
    mine = {
        **KNOWN,
        "GIRAFF_CONFIG": str(ROOT / "deploy" / "robots" / "roboclaw.toml"),
        "GIRAFF_ROBOT_NAME": NAME,
        "GIRAFF_ROBOT_SENSORS": "{ }",
        "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}",
        "GIRAFF_NETWORK_LOCAL": "true",
        "GIRAFF_BASE_PORT": str(tmp_path / "port"),
        "GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT": "0.1",
        "GIRAFF_BASE_DRIVE__WHEEL_CONTROL": "level",
        "STATE_DIRECTORY": str(tmp_path / "state"),
    }
    for name in [name for name in os.environ if name.startswith("GIRAFF_")]:
        monkeypatch.delenv(name)
    for name, value in mine.items():
        monkeypatch.setenv(name, value)
    write_latch(tmp_path / "state", RELEASED)
    with ExitStack() as end:
        yield Rig(tmp_path, dict(os.environ), end)


def most(duties: list[tuple[float, list[int]]]) -> int:
    return max(abs(each) for _, duty in duties for each in duty)


def test_no_power_after_what_breaks_and_none_before_the_script_arms_again(rig: Rig) -> None:
    """Each row: what breaks, within which time no motor has power any more, and what mends it."""
    tell, duties = rig.terminal.tell, rig.terminal.duties
    rows: dict[str, tuple[Callable[[], object], float, Callable[[], object]]] = {
        "base is killed": (rig.kill_base, BASE_IS_SILENT, lambda: rig.start("base")),
        "the board is killed": (lambda: rig.end_board(signal.SIGKILL), CONTROLLER, rig.start_board),
        "the board is suspended": (
            partial(rig.signal_board, signal.SIGSTOP),
            CONTROLLER,
            partial(rig.signal_board, signal.SIGCONT),
        ),
        "the plug is pulled": (lambda: tell("cut"), CONTROLLER, lambda: tell("plug")),
        "the wires are off": (lambda: tell("mute"), CONTROLLER, lambda: tell("pass")),
        "an adapter holds all bytes": (lambda: tell("hold"), CONTROLLER, lambda: tell("pass")),
        "the controller loses its power": (lambda: (tell("off"), tell("on")), CONTROLLER, lambda: None),
        "its emergency input is pressed": (lambda: tell("press"), 0.0, lambda: tell("free")),
        "a wheel is blocked": (lambda: tell("block 0"), STUCK, lambda: tell("free 0")),
    }
    wait(rig.is_stopped, PATIENCE, what="nobody knows what the board held, but it is not latched")
    assert not rig.armed
    wait(partial(rig.has_recovered, 0.0), PATIENCE, what=rig.last_words, every=0.1)
    for name, (breaks, within, mends) in rows.items():
        losses, asked = rig.losses, most(duties(time.monotonic() - 1.0, time.monotonic()))
        breaks()
        broken = time.monotonic()
        wait(lambda: rig.losses > losses, PATIENCE, what=f"{name}: the script is not told")  # noqa: B023
        wait(lambda: [0, 0] in dict(duties(broken, math.inf)).values(), PATIENCE, what=f"{name}: power")  # noqa: B023
        mends()
        again = partial(rig.has_recovered, broken)
        wait(again, PATIENCE, what=lambda: f"{name}: it does not drive again{rig.last_words()}", every=0.1)  # noqa: B023
        armed = min(at for at in rig.armed if at > broken)
        assert not rig.power(broken + within, armed), f"{name}; armed at {armed}{rig.last_words()}"
        assert most(duties(broken, armed)) <= asked + 1, f"{name}: it pushes more than was asked"
    assert rig.end_board(signal.SIGTERM) == 0
    ended = time.monotonic()  # its last bytes are a stop, so that nobody waits for a time-out
    wait(lambda: tell("truth")["t"] > ended + CONTROLLER, PATIENCE)
    assert not rig.power(ended, time.monotonic()), rig.last_words()
