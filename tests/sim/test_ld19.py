"""The simulated laser scanner: its packets tell what a ray meets from where the robot then truly was."""

import math
from itertools import pairwise
from typing import Final

import pytest

from giraff_core.senses import LaserScanner
from giraff_scan.clock import DeviceClock
from giraff_scan.ld19 import POINTS, SIZE, Packet, packet_length, packet_of
from giraff_sim.world.ld19 import DELAY_US, PACKET_US, Ld19, Ld19Fault
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.world import World
from tests.sim.robots import world_in

SPEED: Final = 0.6
TURN: Final = 1.5


def room() -> Room:
    """Return walls all round, and a post."""
    found = Room("room", Pose(0.0, 0.0, 3.0))
    found.add_wall("walls", [(3.0, 2.0), (-3.0, 2.5), (-3.0, -2.0), (2.5, -2.0)], closed=True)
    found.add_post("post", 1.0, 1.0, 0.05)
    return found


def at(us: float) -> Pose:
    """Return a pose on a circle, on which the yaw passes a half turn."""
    yaw = math.remainder(3.0 + TURN * us * 1e-6, math.tau)
    radius = SPEED / TURN
    return Pose(radius * (math.sin(yaw) - math.sin(3.0)), radius * (math.cos(3.0) - math.cos(yaw)), yaw)


def told(world: World, laser: Ld19, seconds: float, since_us: int = 0) -> list[Packet | None]:
    """Drive and return what the scanner says."""
    data = b""
    for now_us in range(since_us, since_us + round(seconds * 1e6), 4000):
        world.plant.pose = at(now_us)
        data += laser.bytes_until(now_us)
    assert len(data) % SIZE == 0
    said = [data[first : first + SIZE] for first in range(0, len(data), SIZE)]
    return [packet_of(each) if packet_length(bytearray(each)) == SIZE else None for each in said]


@pytest.mark.parametrize("upside_down", [False, True])
def test_each_point_is_what_its_ray_met_from_where_the_robot_then_was(upside_down: bool) -> None:
    mount = LaserScanner(x=0.1, y=0.05, yaw=0.3, upside_down=upside_down)
    world = world_in(room())
    said = told(world, Ld19(mount, world, "1", noise=0.0), 1.0)
    packets = [packet for packet in said if packet is not None]
    assert len(packets) == int((996_000 - DELAY_US) // PACKET_US)
    steps = {(later.ms - earlier.ms) % 30_000 for earlier, later in pairwise(packets)}
    assert steps == {2, 3}
    errors = []
    for number, packet in enumerate(packets):
        for point, mm in enumerate(packet.ranges):
            angle = math.radians(packet.start + packet.spread * point / (POINTS - 1))
            bearing = mount.yaw + (angle if upside_down else -angle)
            robot = at((number + point / POINTS) * PACKET_US)
            cos, sin = math.cos(robot.yaw), math.sin(robot.yaw)
            x, y = robot.x + mount.x * cos - mount.y * sin, robot.y + mount.x * sin + mount.y * cos
            hit = world.room.ray(x, y, robot.yaw + bearing, mount.reach)
            assert hit is not None
            errors.append(abs(hit.distance * 1000.0 - mm))
    errors.sort()
    assert errors[round(0.9 * len(errors))] < 2.0


def test_its_clock_goes_on_while_a_slow_machine_holds_the_world_up() -> None:
    world, clock = world_in(room()), DeviceClock()
    laser = Ld19(LaserScanner(x=0.0, y=0.0, yaw=0.0), world, "1")
    fresh = 0
    for now_us in range(0, 4_000_000, 4000):
        if now_us == 2_000_000:
            world.skew = 0.4
        data = laser.bytes_until(now_us)
        for first in range(0, len(data), SIZE):
            packet = packet_of(data[first : first + SIZE])
            assert packet is not None
            fresh += clock.measured_ns(packet.ms, now_us * 1000 + round(world.skew * 1e9)) is not None
    assert (clock.late <= 2, clock.repeated) == (True, 0), clock.late  # these were measured before
    assert fresh > 2.9 * 1e6 / PACKET_US


def test_a_fault_shows_in_its_packets() -> None:
    world = world_in(room())
    laser = Ld19(LaserScanner(x=0.0, y=0.0, yaw=0.0), world, "1")
    told(world, laser, 0.3)
    found = {}
    for number, fault in enumerate(Ld19Fault, start=1):
        laser.fault = fault
        told(world, laser, 0.6, number * 2_000_000)
        found[fault] = told(world, laser, 0.4, number * 2_000_000 + 600_000)
    whole = {fault: [packet for packet in packets if packet is not None] for fault, packets in found.items()}
    assert {packet.speed for packet in whole[Ld19Fault.NONE]} == {3600.0}
    for fault in (Ld19Fault.HELD, Ld19Fault.COASTS):
        assert {(packet.speed, packet.spread) for packet in whole[fault]} == {(0.0, 0.0)}
    assert len({*whole[Ld19Fault.REPEATS]}) == 10
    assert len(whole[Ld19Fault.BROKEN]) < 0.2 * len(found[Ld19Fault.BROKEN])
    share = {
        fault: sum(mm > 0 for packet in packets for mm in packet.ranges) / POINTS / len(packets)
        for fault, packets in whole.items()
    }
    assert share[Ld19Fault.NONE] > 0.95
    assert share[Ld19Fault.NO_ECHO] == 0.0
    assert share[Ld19Fault.THIRD] == pytest.approx(2.0 / 3.0, abs=0.05)
    assert max(mm for packet in whole[Ld19Fault.LID] for mm in packet.ranges) < 80
