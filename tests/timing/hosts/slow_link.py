"""The robot at the end of a bad cable, with a bulk stream in its way, driven in circles."""

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, NamedTuple

from tests.hosts.bad_cable import BAD
from tests.hosts.lab import NAME, NUMBERS, Lab
from tests.hosts.machine import kill
from tests.support.waiting import wait
from tests.timing.sleepers import Stalls, stalls_seen
from tests.timing.stalled import STALL

BULK: Final = Path(__file__).with_name("bulk.py")
CIRCLE: Final = (4.0, 3.0)
"""The hand's tilt for a circle that the room has space for, m/s²."""
_BEFORE, _AFTER = 0.2, 0.5
"""s around a stop in which base, ten times a second, says why."""
_AGE: Final = 0.6  # s; no command or range that is older counts
_BY_ITSELF: Final = 1.5  # s; until then it drives on by itself, or not at all


class Stop(NamedTuple):
    """The wheels stood while the joystick was tilted."""

    at: float
    """s since the ride began."""
    least_left: float
    """Of the age that a command may have, as base told it; below zero: s that it was too old."""
    reasons: list[str]
    """Base's, around that moment."""
    stalled: bool
    """This machine itself had stood still for over 50 ms just before."""


class Ride(NamedTuple):
    """What became of one."""

    stops: list[Stop]
    stalls: int
    """Stops of this machine's own making."""
    share: float
    """Of the cable's rate, taken by the stream."""

    def require_reasons(self) -> None:
        """Each stop is one of a command's or a range's age, and there was a stream."""
        assert all(stop.least_left < 0.0 for stop in self.stops), "a stop for another reason than a command's age"
        # TCP takes no more where 2 % are lost (Mathis et al. 1997: some 1.2 MSS / (RTT sqrt(p))).
        assert self.share > 0.05, "there was no stream"


class Bulk:
    """A stream of large samples from one machine to another, in sessions of its own."""

    def __init__(self, lab: Lab, source: str, sink: str) -> None:
        self._counted = lab.directory / "bulk"
        self._processes = []
        for host, does in ((sink, "count"), (source, "send")):
            with self._counted.with_suffix(f".{does}").open("wb") as output:
                command = [sys.executable, str(BULK), does, NAME]
                self._processes.append(lab.machines[host].start(command, stdout=output, stderr=subprocess.STDOUT))

    def come(self) -> int:
        """Bytes so far."""
        return int((self._counted.with_suffix(".count").read_bytes().split() or [b"0"])[-1])

    def close(self) -> None:
        for process in self._processes:
            kill(process)


@contextmanager
def slow_link(lab: Lab) -> Iterator[Bulk]:
    """The robot's cable is exchanged for a bad one, which the stream fills."""
    robot = lab.machines["robot"]
    lab.down(*NUMBERS)
    for host in NUMBERS:
        lab.write_env(host)
    lab.switch.unplug(robot)
    lab.switch.plug_badly(robot, NUMBERS["robot"])
    lab.on_each(("robot", "laptop"), lab.up)
    lab.wait_until_healthy("robot", "laptop")
    lab.reset_emergency_stop()
    bulk = Bulk(lab, "robot", "desk")
    wait(lambda: bulk.come() > 0, 20.0, what="the stream on the desk")
    yield bulk
    bulk.close()
    lab.down("robot")
    lab.switch.unplug(robot)
    lab.switch.plug(robot, NUMBERS["robot"])


def ride(lab: Lab, bulk: Bulk, seconds: float) -> Ride:
    """In circles, with the joystick tilted all the time."""
    stood: list[float] = []
    with lab.listen("robot", "base") as base, stalls_seen(lab.directory, STALL) as stalls:
        drive_in_circles(lab)
        began, carried = time.monotonic(), bulk.come()
        while time.monotonic() < began + seconds:
            time.sleep(0.03)
            if not lab.hardware.drives():
                stood.append(time.monotonic())
                time.sleep(_BY_ITSELF)
                if not lab.hardware.drives():  # a command so old has disarmed it
                    drive_in_circles(lab)
        share = (bulk.come() - carried) * 8 / (time.monotonic() - began) / BAD.rate
        stops = [_stop(at - began, base.said(at - _BEFORE, at + _AFTER), _stalled(at, stalls)) for at in stood]
    return Ride([stop for stop in stops if not stop.stalled], sum(stop.stalled for stop in stops), share)


def drive_in_circles(lab: Lab) -> None:
    """In the middle of the room."""
    lab.hardware.drive()
    lab.hardware.simulator.place(0.0, 0.0)
    lab.hardware.simulator.tilt(*CIRCLE)
    time.sleep(1.0)


def _stop(at: float, said: list[dict[str, Any]], stalled: bool) -> Stop:
    left = [-1.0 if state["budget_left"] is None else state["budget_left"] for state in said]
    return Stop(at, min(left), list(dict.fromkeys(state["reason"]["what"] for state in said)), stalled)


def _stalled(at: float, stalls: Stalls) -> bool:
    return stalls.longest(round((at - _AGE) * 1e9), round(at * 1e9)) > STALL
