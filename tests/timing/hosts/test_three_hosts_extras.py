"""The flight recorder beside the robot's services, while a host vanishes."""

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Final

import pytest

from giraff_mcap.reading import Recording
from tests.hosts.hardware import PORTS, permit
from tests.hosts.lab import NUMBERS, Lab
from tests.hosts.machine import LabError
from tests.support.waiting import wait
from tests.unit.node.ports import FakePort

Figure = Callable[[str, float, float, str], None]

pytestmark = pytest.mark.timeout(300)

EXTRAS: Final = {"COMPOSE_PROFILES": "robot,recorder,gateway"}
SETTINGS: Final = {
    "GIRAFF_RECORDER_BEFORE": "8",
    "GIRAFF_RECORDER_AFTER": "1",
    "GIRAFF_GATEWAY_PORT": str(PORTS / "weather"),
    "GIRAFF_GATEWAY_NAME": "weather",
}

_END_OF_A_WHOLE_ONE: Final = b"\x89MCAP0\r\n"


@pytest.fixture(scope="module")
def _recorded(lab: Lab) -> Iterator[None]:
    """Recorder and gateway are up beside the robot's services."""
    lab.down(*NUMBERS)
    lab.load("robot", "recorder")
    port = FakePort(PORTS / "weather")
    permit(port.link)
    lab.write_env("robot", EXTRAS, SETTINGS)
    lab.on_each(["robot", "laptop"], lab.up)
    lab.wait_until_healthy("robot", "laptop")
    lab.reset_emergency_stop()
    yield
    lab.mend()
    lab.down(*NUMBERS)
    lab.write_env("robot")
    port.close()


@pytest.mark.usefixtures("_recorded")
def test_an_emergency_stop_leaves_a_recording(lab: Lab, tmp_path: Path, figure: Figure) -> None:
    """Also of the moment in which a host vanished, whose dead links hold up nothing."""
    [recorder] = [one.name for one in lab.containers("robot") if one.service == "recorder"]

    def kept(pattern: str) -> set[Path]:
        with suppress(LabError):  # there is no folder before the first file
            lab.machines["robot"].docker("cp", f"{recorder}:/var/lib/giraff/incidents", str(tmp_path))
        return set((tmp_path / "incidents").glob(pattern))

    before = kept("*.mcap")  # of another try
    lab.hardware.drive()
    lab.power_off("laptop")
    gone_ns = time.time_ns()
    time.sleep(6.0)
    lab.compose("desk", "run", "--rm", "giraff", "estop", "engage", "--reason", "a cat")
    files: list[Path] = []

    def written() -> bool:
        files[:] = kept("*-estop.mcap") - before
        return bool(files) and files[0].read_bytes().endswith(_END_OF_A_WHOLE_ONE)

    wait(written, 20.0, what="a recording of the emergency stop", every=0.5)
    recording = Recording(files[0])
    assert ": a cat" in recording.about["incident"]
    assert {"odom", "wheels", "estop", "guard"} <= set(recording.keys)
    # What was an incident before it is in a file of its own, which ends where this one begins.
    all_files = [Recording(path) for path in sorted(kept("*.mcap") - before)]
    assert all_files[0].about["incident"] == "joystick ended while the robot was armed"
    heard = [sample.heard_ns for one in all_files for sample in one.samples(("odom",))]
    assert heard[0] < gone_ns < heard[-1]
    longest = max(later - earlier for earlier, later in pairwise(heard)) * 1e-9
    figure("laptop's power off -> the longest gap in what the recorder has of odometry", longest, 0.5, "s")
