"""An hour of a robot in a viewer that may keep little: at twenty times its speed, what it takes of memory."""

from __future__ import annotations

import math
import subprocess
import time
from collections.abc import Iterator
from typing import Any, Final

import msgspec
import psutil

from giraff_cli.watcher import free_port
from giraff_schemas import topics
from giraff_schemas.messages import Battery, Sample, Tick, Tilt
from giraff_schemas.topics import Topic
from giraff_sim.board import ROOT
from giraff_viewer.scene import stock
from giraff_viewer.show import Show
from giraff_viewer.window import Window
from tests.campaign.records import write_record
from tests.unit.cli.samples import SENSORS, at, base, command, estop, guard, lease, odometry, reading, verdict, wheels

HOUR: Final = 3600  # s
SPEED: Final = 20
LIMIT: Final = "100MB"
MOST_GROWTH: Final = 30e6  # bytes in the second half: of an hour, whose data would be hundreds
SECOND_NS: Final = 1_000_000_000


def samples_of(second: int) -> Iterator[tuple[Topic[Any], Sample, int]]:
    """What a robot that drives a circle says within a second, and when, in ns."""
    for hundredth in range(100):
        now = (second * 100 + hundredth) * 10_000_000
        turned = 0.2 * now * 1e-9
        x, y = 2.0 * math.sin(turned), 2.0 * (1.0 - math.cos(turned))
        yaw = math.remainder(turned, math.tau)
        yield topics.ODOM, odometry(now, x, y, yaw), now
        yield topics.WHEELS, msgspec.structs.replace(wheels(now), left_pwm_counts=hundredth % 70), now
        if hundredth % 2 == 0:
            yield topics.TICK, Tick(epoch=at(now).epoch, robot_ns=now), now
            yield topics.CMD_VEL, command(now), now
            yield topics.TILT, Tilt(x=5.0 * math.sin(turned), y=1.0, z=9.0, status="running", tick=at(now)), now
        if hundredth % 6 == 0:
            sensor = SENSORS[hundredth // 6 % 3]
            yield topics.RANGE, reading(sensor, 1.2 + math.sin(3.0 * turned)), now
        if hundredth % 10 == 0:
            blocked = verdict(0.0, "blocked", "front_left", f"front_left sees something at 0.{hundredth} m")
            yield topics.GUARD, guard(blocked if second % 10 < 2 else verdict()), now
            yield topics.BASE, base(), now
            yield topics.LEASE, lease(), now
        if hundredth % 50 == 0:
            yield topics.BATTERY, Battery(voltage=24.0 + 0.2 * math.sin(turned)), now
            yield topics.ESTOP, estop(), now


def test_an_hour_stays_within_its_memory() -> None:
    subprocess.run([ROOT / "tests" / "desk" / "prepare"], check=True)
    heard = 0
    viewer_bytes, own_bytes = [], []
    with Window(free_port(), LIMIT, headless=True) as window:
        show = Show(stock("sim-hour"), live=True)
        show.to_window(window.url)
        viewer, own = psutil.Process(window.pid), psutil.Process()
        began, wall_ns = time.monotonic(), time.time_ns()
        for second in range(HOUR):
            for topic, sample, now_ns in samples_of(second):
                show.hear(topic, sample, wall_ns + now_ns)
                heard += 1
            time.sleep(max(0.0, began + (second + 1) / SPEED - time.monotonic()))
            if second % 60 == 59:
                viewer_bytes.append(viewer.memory_info().rss)
                own_bytes.append(own.memory_info().rss)
        took = time.monotonic() - began
        show.close()
        deadline = time.monotonic() + 60.0
        while (behind := show.newest - window.newest()) > 1.0 and time.monotonic() < deadline:
            time.sleep(0.1)
        assert window.is_open()
    halves = max(viewer_bytes[10:30]), max(viewer_bytes[30:])
    path = write_record(
        "viewer",
        {
            "limit": LIMIT,
            "seconds_of_data": HOUR,
            "seconds": round(took, 1),
            "samples": heard,
            "viewer_megabytes_each_minute": [round(size / 1e6) for size in viewer_bytes],
            "own_megabytes_first_last": [round(own_bytes[0] / 1e6), round(own_bytes[-1] / 1e6)],
            "newest_behind_at_the_end_s": round(behind, 2),
        },
    )
    print(path.read_text())
    assert behind < 1.0, "not everything arrived"
    assert halves[1] - halves[0] < MOST_GROWTH
    assert own_bytes[-1] - own_bytes[10] < MOST_GROWTH
