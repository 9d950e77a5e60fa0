"""The robot drives on over a slow link while somebody looks through its camera. No Docker."""

from __future__ import annotations

import json
import statistics
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import msgspec
import pytest

from tests.hosts.looker import Came
from tests.hosts.process_site import NAME, NUMBERS, PYTHON, ProcessSite
from tests.support.moving_camera import MovingCamera
from tests.support.process_robot import FULL_TILT
from tests.support.waiting import wait

pytestmark = pytest.mark.timeout(180)

LAN: Final = {"mode": "lan"}
LOOKER: Final = Path(__file__).with_name("looker.py")
LATER: Final = 0.08
"""s by which ticks may be older while somebody looks."""


def nine_in_twenty(ages: list[float]) -> float:
    """The age that 95 of 100 are below."""
    return statistics.quantiles(ages, n=20)[-1]


def _while_running(process: subprocess.Popen[bytes]) -> Iterator[None]:
    """Ten times a second."""
    while process.poll() is None:
        yield
        time.sleep(0.1)
    assert process.returncode == 0


def test_over_a_link_of_one_megabit_the_robot_drives_on_while_somebody_looks(tmp_path: Path) -> None:
    with ProcessSite(tmp_path) as site, MovingCamera(tmp_path / "camera"):
        laptop = site.machines["laptop"]
        site.switch.unplug(laptop)
        site.switch.plug_badly(laptop, NUMBERS["laptop"], "slow")
        site.start(LAN, "door", "base", "guard", "ranger", "camera")
        site.start(LAN, "joystick", host="laptop")
        # A busy machine that pauses ends a drive, too, but hardly two of three.
        goes_on = [_drives_on(site), _drives_on(site)]
        if goes_on.count(True) == 1:
            goes_on.append(_drives_on(site))
        assert goes_on.count(True) == 2, site.log("guard")
        wait(lambda: "looks at head no longer" in site.log("camera"), 30.0)


def _drives_on(site: ProcessSite) -> bool:
    """Whether a drive goes on, at its full speed, while somebody looks; and ticks and pictures come."""
    simulator = site.hardware.simulator
    site.hardware.drive()
    simulator.tilt(0.0, FULL_TILT)  # it turns where it stands, which no wall ends
    since = simulator.now()
    looker = site.begin("looker", "laptop", [*PYTHON, str(LOOKER), NAME, "head", json.dumps(LAN), "3"], LAN)
    turns = [abs(simulator.state().turn) for _ in _while_running(looker)]
    site.kill("looker")  # it has ended; its standard input is closed
    until = simulator.now()
    came = msgspec.json.decode((site.directory / "looker.out").read_bytes(), type=Came)
    later = nine_in_twenty(came.ticks["looking"]) - nine_in_twenty(came.ticks["alone"])
    print(
        f"ticks {nine_in_twenty(came.ticks['looking']):.3f} s old, {later:.3f} more than alone, {len(came.pictures)} "
        f"pictures of {statistics.mean(came.bytes):.0f} bytes, {statistics.median(came.pictures):.3f} s old"
    )
    assert not came.trouble
    assert len(came.pictures) > 10
    return (
        site.hardware.drives()
        and simulator.record(since, until).driven_ms >= 0.9 * (until - since) / 1000
        and statistics.quantiles(turns, n=20)[2] >= 0.9 * max(turns)  # but for the start
        and later <= LATER
    )
