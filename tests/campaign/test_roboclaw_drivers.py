"""Drivers that others have written for the RoboClaw judge its model, which is that of the simulated world.

Each comes from PyPI into an environment that is thrown away afterwards.
"""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import pytest

from tests.support.report import report
from tests.support.roboclaw import PATIENCE, Terminal
from tests.support.waiting import wait

OPENS: Final = {
    "tcr-roboclaw==0.1.5": "import tcr_roboclaw.roboclaw as of; it = of.Roboclaw(sys.argv[1], 115200); it.open()",
    "basicmicro==2.0.10": "from basicmicro.controller import Basicmicro as Of; it = Of(sys.argv[1], 115200); it.Open()",
}
PROGRAM: Final = """
import json, sys
{}
for line in sys.stdin:
    name, *values = json.loads(line)
    print(json.dumps(getattr(it, name)(*values)), flush=True)
"""
DIFFERENCES: Final[dict[str, Any]] = {
    "tcr-roboclaw==0.1.5": ((), "SetSerialTimeout", "ReadSerialTimeout", 5, "GetEncoderCounters"),
    "basicmicro==2.0.10": ((0x80,), "SetTimeout", "GetTimeout", 0.5, "GetEncoders"),
}
"""By package: first values of each call, methods that set and read a time-out, half a second there, and counters."""

Call = Callable[..., Any]


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Terminal]:
    with Terminal(tmp_path) as terminal:
        yield terminal


@pytest.fixture
def call(package: str, terminal: Terminal, tmp_path: Path) -> Iterator[Call]:
    """Call a method of the driver, which has an interpreter of its own, and return what it returns."""
    uv, python = str(Path(sys.executable).with_name("uv")), tmp_path / "environment" / "bin" / "python"
    subprocess.run([uv, "venv", "-q", "-p", sys.executable, tmp_path / "environment"], check=True)
    subprocess.run([uv, "pip", "install", "-q", "-p", python, package], check=True)
    command = [str(python), "-c", PROGRAM.format(OPENS[package]), str(terminal.link)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        out, back = process.stdin, process.stdout
        assert out is not None
        assert back is not None

        def ask(name: str, *values: float) -> Any:
            print(json.dumps([name, *DIFFERENCES[package][0], *values]), file=out, flush=True)
            return json.loads(back.readline())

        yield ask
        process.kill()


@pytest.mark.parametrize("package", OPENS)
def test_a_driver_of_others_drives_the_model(package: str, call: Call, terminal: Terminal) -> None:
    def wait_for(*duty: int) -> None:
        wait(lambda: terminal.duties(0.0, float("inf"))[-1][1] == list(duty), PATIENCE, what=f"not {duty}")

    _, set_timeout, get_timeout, half, counters = DIFFERENCES[package]
    done, version = call("ReadVersion")
    assert (done, version.strip("\n\0")) == (True, "USB Roboclaw 2x15a v4.2.4")
    assert call("ReadMainBatteryVoltage") == [True, 240]
    assert call(set_timeout, half)
    assert call(get_timeout) == [True, half]
    assert call("DutyM1M2", 3000, -3000)
    wait_for(3000, -3000)
    wait_for(0, 0)  # by the time-out, as nothing is sent
    assert call(set_timeout, 0)
    assert call("DutyAccelM1M2", 655359, 4000, 6000, -4000)
    wait_for(4000, -4000)
    assert call("DutyAccelM1M2", 655359, 0, 655359, 0)
    wait(lambda: terminal.truth()["speed"] == [0, 0], PATIENCE)
    _, *counts = call(counters)
    metres = terminal.truth()["position"]
    assert metres[0] > 0 > metres[1]
    assert [(count + 2**31) % 2**32 - 2**31 for count in counts] == [pytest.approx(8000 * at, abs=2) for at in metres]
    assert call("SetEncM1", 70000)
    assert call("ReadEncM1")[:2] == [True, 70000]
    for event, status in (("free", 0), ("press", 1)):
        terminal.tell(event)
        assert call("ReadError") == [True, status]
    figures = {name: terminal.truth()[name] for name in ("packets", "damaged")}
    assert figures["damaged"] == 0
    report(f"campaign/{package}", figures)
