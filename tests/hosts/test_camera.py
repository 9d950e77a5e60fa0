"""The robot drives on over a slow link while somebody looks through its camera. No Docker."""

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
DRIVES: Final = 4
"""Number of drives that may be tried. One must go on."""


class _Drive(msgspec.Struct):
    """A drive while somebody looks. Ages are in s."""

    drives: bool
    """Whether the robot still drives at the end."""
    driven: float
    """Share of the time in which the motors turned."""
    full_speed_alone: float
    """Share of the samples at full speed while nobody looks. A busy machine makes the robot slower, too."""
    full_speed: float
    """Share while somebody looks."""
    tick_age: float
    later: float
    """How much older the ticks are than while nobody looks."""
    pictures: int
    picture_bytes: float
    picture_age: float

    @property
    def went_on(self) -> bool:
        """The robot drove from its start to the end, and at full speed as much as while nobody looked."""
        return self.drives and self.driven >= 0.9 and self.full_speed >= 0.85 * self.full_speed_alone


def percentile_95(ages: list[float]) -> float:
    """Return the age that 95 of 100 ages are below."""
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
        # A busy machine that pauses ends a drive, too. A link that the pictures fill ends each of them.
        drives: list[_Drive] = []
        while len(drives) < DRIVES and not any(drive.went_on for drive in drives):
            drives.append(_drive(site))
        print(*drives, sep="\n")
        assert any(drive.went_on for drive in drives), site.log("guard")
        assert min(drive.later for drive in drives) <= LATER
        wait(lambda: "looks at head no longer" in site.log("camera"), 30.0)


def _drive(site: ProcessSite) -> _Drive:
    """Turn at full tilt while somebody looks, and require that ticks and pictures come."""
    simulator = site.hardware.simulator
    site.hardware.drive()
    simulator.tilt(0.0, FULL_TILT)  # it turns where it stands, which no wall ends
    since = simulator.now()
    looker = site.begin("looker", "laptop", [*PYTHON, str(LOOKER), NAME, "head", json.dumps(LAN), "3"], LAN)
    turns = [(time.monotonic(), abs(simulator.state().turn)) for _ in _while_running(looker)]
    site.kill("looker")  # it has ended; its standard input is closed
    until = simulator.now()
    came = msgspec.json.decode((site.directory / "looker.out").read_bytes(), type=Came)
    assert not came.trouble
    assert len(came.pictures) > 10
    full_speed = 0.9 * max(turn for _, turn in turns)
    alone = [turn >= full_speed for at, turn in turns if at < came.looks_at]
    looking = [turn >= full_speed for at, turn in turns if at >= came.looks_at]
    return _Drive(
        drives=site.hardware.drives(),
        driven=simulator.record(since, until).driven_ms * 1000 / (until - since),
        full_speed_alone=statistics.mean(alone),
        full_speed=statistics.mean(looking),
        tick_age=percentile_95(came.ticks["looking"]),
        later=percentile_95(came.ticks["looking"]) - percentile_95(came.ticks["alone"]),
        pictures=len(came.pictures),
        picture_bytes=statistics.mean(came.bytes),
        picture_age=statistics.median(came.pictures),
    )
