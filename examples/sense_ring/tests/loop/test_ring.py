"""A robot with an infrared ring keeps from walls, by the world's truth."""

import math
import struct
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

import msgspec
import pytest

from giraff_core.senses.ring import IrRing
from giraff_ring.config import RingConfig
from giraff_ring.policy import distances, packet_length
from giraff_ring.service import Ring
from giraff_schemas.framing import crc16
from giraff_schemas.ring import RingLook
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.hosts.cable import Cable
from giraff_sim.hosts.process import Observer, Process
from giraff_sim.world.sonar import SonarFault
from tests.loop.loops import FULL_TILT, SETTINGS, arm, closed_loop, hold
from tests.sim.robots import room_with_wall
from tests.support.robots import ROBOT, ULTRASONIC

MOUNT: Final = IrRing(x=0.05, radius=0.1)
MARGIN: Final = SETTINGS.guard.margin
PERIOD_US: Final = 50_000


def packet(mm: list[int]) -> bytes:
    body = struct.pack("<B16H", 0xA5, *mm)
    return body + struct.pack("<H", crc16(body))


class Arduino:
    """Asks the room what each sensor sees, and sends it 20 ms later; each tenth packet lacks a byte."""

    def __init__(self, loop: ClosedLoop) -> None:
        self.is_blind, self._loop, self._looks = False, loop, 0
        self._sent: deque[tuple[int, bytes]] = deque()

    def bytes_until(self, now_us: int) -> bytes:
        if now_us >= self._looks * PERIOD_US:
            self._looks += 1
            whole = packet([0 if self.is_blind else self._mm(math.tau * n / 16) for n in range(16)])
            self._sent.append((now_us + 20_000, whole[: -1 if self._looks % 10 == 0 else None]))
        return self._sent.popleft()[1] if self._sent and self._sent[0][0] <= now_us else b""

    def receive(self, data: bytes) -> int:
        return len(data)

    def _mm(self, bearing: float) -> int:
        world = self._loop.simulation.world
        x, y, yaw = world.plant.pose
        x += MOUNT.x * math.cos(yaw) + MOUNT.radius * math.cos(yaw + bearing)
        y += MOUNT.x * math.sin(yaw) + MOUNT.radius * math.sin(yaw + bearing)
        hit = world.room.ray(x, y, yaw + bearing, MOUNT.reach)
        return 0 if hit is None else round(max(0.1, hit.distance) * 1000)


class Looks(Observer):
    """Keeps all looks that are published."""

    def __init__(self) -> None:
        self.said_looks: list[RingLook] = []

    def said(self, process: Process, sample: Any) -> None:
        del process
        if isinstance(sample, RingLook):
            self.said_looks.append(sample)


@contextmanager
def ringed(wall: float, sensors: dict[str, Any]) -> Iterator[tuple[ClosedLoop, Arduino, list[RingLook]]]:
    """A robot that is armed, with a ring and these sensors beside it."""
    robot, heard = msgspec.structs.replace(ROBOT, sensors={"ring": MOUNT} | sensors), Looks()
    settings, config = msgspec.structs.replace(SETTINGS, robot=robot), RingConfig(port="ring")
    with closed_loop(room_with_wall(wall), settings, observer=heard) as loop:
        arduino = Arduino(loop)
        loop.cables["ring"] = Cable(arduino, loop.simulation)
        loop.launch("ring", lambda io: Ring(io, config, robot), loop.hosts["robot"])
        arm(loop)
        yield loop, arduino, heard.said_looks


def drive(loop: ClosedLoop, seconds: float) -> tuple[float, float]:
    """Ask for full speed forward; return the highest speed, m/s, and what is free at the end, m."""
    world, fastest = loop.simulation.world, 0.0
    hold(loop, x=FULL_TILT)
    for _ in range(round(seconds / 0.1)):
        before = world.plant.pose.x
        loop.run(0.1)
        fastest = max(fastest, (world.plant.pose.x - before) / 0.1)
    return fastest, world.room.clearance(*world.plant.pose[:2]) - ROBOT.footprint_radius


def blocked(loop: ClosedLoop) -> list[str]:
    """Return why the robot may not drive, each way."""
    guard = loop.newest["guard"]
    return [str(way.reason) for way in (guard.forward, guard.backward) if way.clearance == "blocked"]


def test_a_torn_packet_is_no_packet_and_the_fourth_sensor_looks_left() -> None:
    whole = packet([0] * 4 + [500] + [0] * 11)
    assert [packet_length(bytearray(each)) for each in (b"", whole[:34], whole, whole[:-2] + b"ab")] == [0, 0, 35, 1]
    found = distances(whole)
    assert found == (*[None] * 4, 0.5, *[None] * 11)
    [[place]] = MOUNT.evidence(RingLook(sensor="ring", tick=None, distances=found), 0.3).seen
    assert place == pytest.approx((MOUNT.x, MOUNT.radius + 0.5))


def test_it_stops_at_the_margin_before_a_wall_after_full_speed_by_the_ring_alone() -> None:
    with ringed(1.75, {}) as (loop, arduino, looks):
        fastest, free = drive(loop, 3.4)
        assert fastest > 0.97 * ROBOT.max_wheel_speed
        assert MARGIN - 0.02 <= free < MARGIN + 0.06
        assert "ring sees something" in blocked(loop)[0]
        [ahead] = MOUNT.evidence(looks[-1], ROBOT.footprint_radius).seen[0]
        assert ahead == pytest.approx((ROBOT.footprint_radius + free, 0.0), abs=0.01)
        assert MOUNT.summary(looks[-1]).nearest == looks[-1].distances[0]
        arduino.is_blind = True
        while looks[-1].distances[0]:
            loop.step()
        arduino.is_blind = False
        assert drive(loop, 0.2) == (0.0, free), "one wild look opens the way"


def test_the_stricter_of_ring_and_sonars_holds() -> None:
    for is_blind, name in ((False, "ring"), (True, "front")):
        with ringed(0.8, ULTRASONIC) as (loop, arduino, _):
            arduino.is_blind = is_blind
            for sonar in () if is_blind else loop.simulation.world.sonars.values():
                sonar.fault = SonarFault.DEAF
            assert MARGIN - 0.02 <= drive(loop, 2.0)[1] < MARGIN + 0.1
            assert blocked(loop)[0].startswith(name)


def test_silence_blocks_both_ways_and_nothing_from_before_a_stall_counts_after_it() -> None:
    with ringed(9.0, {}) as (loop, arduino, looks):
        world, process, cable = loop.simulation.world, loop.processes["ring"], loop.cables["ring"]
        assert blocked(loop) == []
        cable.unplug()
        loop.run(0.6)
        assert [why.startswith("ring is stale") for why in blocked(loop)] == [True, True]
        world.room.add_wall("door", [(0.5, -1.0), (0.5, 1.0)])
        hold(loop, x=FULL_TILT)
        arduino.is_blind, said = True, len(looks)
        cable.plug()
        while len(looks) == said:
            loop.step()
        arduino.is_blind = False
        loop.run(0.3)
        assert [each.distances[0] for each in (looks[said], looks[-1])] == [None, pytest.approx(0.35)]
        while loop.simulation.now_us % PERIOD_US > 5000:
            loop.step()  # until a look has just been measured, whose packet waits for the process
        begun_ns, said, process.paused = loop.robot_ns, len(looks), True
        world.room.add_wall("a nearer door", [(0.4, -1.0), (0.4, 1.0)])
        loop.run(0.3)
        process.paused = False
        process.go_on()
        loop.run(0.4)
        newer = [look for look in looks[said:] if look.tick is not None and look.tick.robot_ns >= begun_ns]
        assert [look.distances[0] for look in newer] == [pytest.approx(0.25)] * max(3, len(newer))
        assert blocked(loop)[0].startswith("ring sees something")
        assert world.plant.pose.x == 0.0
