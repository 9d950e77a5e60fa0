"""An hour of a robot in a viewer that may keep little: at twenty times its speed, what it takes of memory."""

import math
import subprocess
import time
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

import msgspec
import psutil
import pytest

from giraff_schemas import topics
from giraff_schemas.messages import Battery, Sample, Tick, Tilt
from giraff_schemas.topics import Topic
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from giraff_viewer.scene import stock
from giraff_viewer.show import Show
from giraff_viewer.window import Window
from tests.support.report import report
from tests.support.waiting import wait
from tests.unit.cli.samples import SENSORS, at, base, command, estop, guard, lease, odometry, reading, verdict, wheels

HOUR: Final = 3600  # s
SPEED: Final = 20
LIMIT: Final = "100MB"
MOST_GROWTH: Final = 30.0
"""MB in the second half of the hour, of what is left when the oldest was forgotten. Between two such moments it is
more, the more the busier the machine is: the viewer forgets for 3.5 ms a picture, however long it waits for a turn."""
MOST: Final = 750.0  # MB altogether, where the processor draws
_RESERVED: Final = 2**29  # bytes; the viewer's allocator reserves 1 GiB at a time, and nothing else does


class Use(NamedTuple):
    """MB of the viewer: all that is resident, and what of it was allocated, for data above all, not for drawing."""

    all: float
    data: float


def use_of(process: psutil.Process) -> Use:
    areas = process.memory_maps(grouped=False)
    data = sum(area.rss for area in areas if _length(area.addr) >= _RESERVED)
    return Use(process.memory_info().rss / 1e6, data / 1e6)


def _length(addresses: str) -> int:
    begin, end = (int(address, 16) for address in addresses.split("-"))
    return end - begin


def samples_of(second: int) -> Iterator[tuple[Topic[Any], Sample, int]]:
    """What a robot that drives a circle says within a second, and when, in ns."""
    for hundredth in range(100):
        now = (second * 100 + hundredth) * 10_000_000
        turned = 0.2 * now * 1e-9
        x, y = 2.0 * math.sin(turned), 2.0 * (1.0 - math.cos(turned))
        yield topics.ODOM, odometry(now, x, y, math.remainder(turned, math.tau)), now
        yield topics.WHEELS, msgspec.structs.replace(wheels(now), left_pwm_counts=hundredth % 70), now
        if hundredth % 2 == 0:
            yield topics.TICK, Tick(epoch=at(now).epoch, robot_ns=now), now
            yield topics.CMD_VEL, command(now), now
            yield topics.TILT, Tilt(x=5.0 * math.sin(turned), y=1.0, z=9.0, status="running", tick=at(now)), now
        if hundredth % 6 == 0:
            yield topics.RANGE, reading(SENSORS[hundredth // 6 % 3], 1.2 + math.sin(3.0 * turned)), now
        if hundredth % 10 == 0:
            blocked = verdict(0.0, "blocked", "front_left", f"front_left sees something at 0.{hundredth} m")
            yield topics.GUARD, guard(blocked if second % 10 < 2 else verdict()), now
            yield topics.BASE, base(), now
            yield topics.LEASE, lease(), now
        if hundredth % 50 == 0:
            yield topics.BATTERY, Battery(voltage=24.0 + 0.2 * math.sin(turned)), now
            yield topics.ESTOP, estop(), now


@pytest.mark.timeout(0)
def test_an_hour_stays_within_its_memory() -> None:
    subprocess.run([ROOT / "tests" / "functional" / "desk" / "prepare"], check=True)
    uses: list[Use] = []
    own: list[float] = []
    with Window(free_port(), LIMIT, headless=True) as window:
        show = Show(stock("sim-hour"), live=True)
        show.to_window(window.url)
        viewer, this = psutil.Process(window.pid), psutil.Process()
        began, wall_ns = time.monotonic(), time.time_ns()
        for second in range(HOUR):
            for topic, sample, now_ns in samples_of(second):
                show.on_sample(topic, sample, wall_ns + now_ns)
            time.sleep(max(0.0, began + (second + 1) / SPEED - time.monotonic()))
            if second % 60 == 59:
                uses.append(use_of(viewer))
                own.append(this.memory_info().rss / 1e6)
        took = time.monotonic() - began
        show.close()
        behind = wait(lambda: window.shows(show.newest), 60.0, what="the viewer does not have everything")
    report(
        "timing/viewer",
        {
            "limit": LIMIT,
            "seconds_of_data": HOUR,
            "seconds": round(took, 1),
            "seconds_behind_at_the_end": round(behind, 2),
            "samples": show.heard,
            "megabytes_each_minute": [round(use.all) for use in uses],
            "of_these_data": [round(use.data) for use in uses],
            "megabytes_of_giraff_view": [round(size) for size in own],
        },
    )
    quarter = len(uses) // 4
    kept = min(use.data for use in uses[quarter : 2 * quarter])
    assert min(use.data for use in uses[2 * quarter :]) - kept < MOST_GROWTH, "what it has forgotten is not given back"
    assert max(own[2 * quarter :]) - max(own[: 2 * quarter]) < MOST_GROWTH
    assert max(use.all for use in uses) < MOST
