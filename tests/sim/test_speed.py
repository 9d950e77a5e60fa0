"""The base board's speed control on the simulated robot: what it holds, and that it holds no healthy robot."""

import math
import random
from collections.abc import Iterator
from contextlib import contextmanager

import msgspec
import pytest

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_schemas.wire import BoardKind, DriveState, Latch, SpeedFlag
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.bodies.wheels.body import LEFT, RIGHT
from giraff_sim.bodies.wheels.plant import Plant
from giraff_sim.config import SimConfig
from giraff_sim.simulation import Simulation, simulation
from giraff_sim.truth import EXACT, TrueWheel, Truth, TruthRanges, draw_truth
from giraff_sim.world.hand import StillHand
from tests.sim.line import BaseLine
from tests.sim.robots import empty_room
from tests.support.robots import BY_SPEED, ROBOT
from tests.support.wheels import wheels_of

DRIVES = {"known voltage": BY_SPEED, "unknown voltage": msgspec.structs.replace(BY_SPEED, battery_volts_per_count=0.0)}
LOW = SimConfig(tilt_noise=0.0, battery_volts=0.85 * 24.0)
BATTERIES = {"full": SimConfig(tilt_noise=0.0), "low": LOW}
RAMP = 0.6
"""m/s², by which this host speeds up."""
UNEVEN = Truth(left=TrueWheel(strength=1.0), right=TrueWheel(strength=0.85))
AVR, HOST = Implementation.AVR, Implementation.HOST


class Driver(BaseLine):
    """A host that speeds up by RAMP, and looks at each millisecond."""

    def __init__(self, running: Simulation) -> None:
        super().__init__(running)
        self.asked = [0.0, 0.0]

    @property
    def plant(self) -> Plant:
        return wheels_of(self.simulation.world).plant

    @property
    def is_held(self) -> bool:
        return self.wheels.drive_state == DriveState.HELD or self.wheels.latch != Latch.NONE

    def towards(self, left: float, right: float, seconds: float) -> None:
        """Ask for these speeds, m/s, in steps of 20 ms that RAMP allows."""
        for _ in range(round(seconds * 50)):
            for wheel, aim in enumerate((left, right)):
                step = RAMP * 0.02
                self.asked[wheel] += min(step, max(-step, aim - self.asked[wheel]))
            self.go(self.asked[0], self.asked[1], 0.02)


@contextmanager
def driver(
    implementation: Implementation = HOST,
    truth: Truth = EXACT,
    sim: SimConfig = BATTERIES["full"],
    drive: WheelsConfig = BY_SPEED,
) -> Iterator[Driver]:
    """A robot whose board is asked for speeds."""
    world = world_of(empty_room(), ROBOT, drive, sim, StillHand(), 1, truth=truth)
    with simulation(world, (BoardKind.BASE,), implementation) as running:
        line = Driver(running)
        line.boot()
        line.begin_session(drive.board_settings(ROBOT, 1.2))
        line.go(0.0, 0.0, 0.1)
        yield line


CASES = [
    *((HOST, speed, drive, battery) for speed in (0.05, 0.2, 0.5) for drive in DRIVES for battery in BATTERIES),
    (AVR, 0.3, "known voltage", "low"),
]


@pytest.mark.parametrize(("implementation", "speed", "drive", "battery"), CASES)
def test_both_wheels_hold_their_speed(implementation: Implementation, speed: float, drive: str, battery: str) -> None:
    with driver(implementation, UNEVEN, BATTERIES[battery], DRIVES[drive]) as line:
        told: list[tuple[int, int]] = []
        line.towards(speed, speed, speed / RAMP + 0.5)
        began = line.wheels
        for _ in range(50):
            line.go(speed, speed, 0.02)
            told.append((line.wheels.left_um_s, line.wheels.right_um_s))
        ended = line.wheels
        seconds = (ended.board_us - began.board_us) * 1e-6
        for ticks in (ended.left_ticks - began.left_ticks, ended.right_ticks - began.right_ticks):
            resolution = 1.0 / ROBOT.ticks_per_metre / seconds
            assert ticks / ROBOT.ticks_per_metre / seconds == pytest.approx(speed, abs=0.03 * speed + resolution)
        for one in (um_s for pair in told for um_s in pair):
            assert one == pytest.approx(speed * 1e6, rel=0.03)
        assert not line.is_held
        assert ended.speed_flags == 0


@pytest.mark.parametrize("speed", [0.05, 0.2, -0.5])
@pytest.mark.parametrize("battery", BATTERIES)
def test_a_ramp_overshoots_by_a_tenth_at_most(speed: float, battery: str) -> None:
    for drive in DRIVES.values():
        with driver(truth=UNEVEN, sim=BATTERIES[battery], drive=drive) as line:
            fastest = 0.0
            for _ in range(round((abs(speed) / RAMP + 1.0) * 50)):
                line.towards(speed, speed, 0.02)
                fastest = max(fastest, abs(line.plant.left.speed), abs(line.plant.right.speed))
            assert 0.97 * abs(speed) <= fastest <= 1.1 * abs(speed)


@pytest.mark.parametrize("implementation", [HOST, AVR], ids=str)
def test_nothing_moves_at_zero(implementation: Implementation) -> None:
    with driver(implementation) as line:
        began = line.wheels
        line.go(0.0, 0.0, 1.0)
        assert (line.wheels.left_ticks, line.wheels.right_ticks) == (began.left_ticks, began.right_ticks)
        line.towards(0.3, 0.3, 1.0)
        line.go(0.0, 0.0, 1.0)
        travelled = line.plant.path_length
        line.go(0.0, 0.0, 1.0)
        assert line.plant.path_length == travelled


@pytest.mark.parametrize("drive", DRIVES)
def test_unlike_motors_drive_5_m_straight(drive: str) -> None:
    with driver(truth=UNEVEN, sim=LOW, drive=DRIVES[drive]) as line:
        while line.plant.path_length < 5.0:
            line.towards(0.5, 0.5, 0.1)
        assert abs(math.degrees(line.plant.pose.yaw)) <= 1.0
        assert not line.is_held


PATHS = {"forward": (1, 1), "backward": (-1, -1), "on the spot": (-1, 1), "on one wheel": (0, 1)}


@pytest.mark.parametrize("seed", range(4))
def test_no_healthy_start_is_held(seed: int) -> None:
    start_healthily(seed)


def start_healthily(seed: int) -> None:
    """Start with a battery 15 % low, as fast as the board lets it, each way at another speed: that is not held."""
    with driver(truth=draw_truth("uncalibrated", TruthRanges(), seed), sim=LOW) as line:
        for number, (name, (left, right)) in enumerate(PATHS.items()):
            speed = (0.1, 0.2, 0.35, 0.5)[(seed + number) % 4]
            line.go(left * speed, right * speed, 0.9)
            assert not line.is_held, (name, speed)
            assert not line.wheels.speed_flags & (SpeedFlag.LEFT_HELD | SpeedFlag.RIGHT_HELD)
            line.go(0.0, 0.0, 0.4)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_asked_in_turn_no_healthy_robot_is_held(seed: int) -> None:
    ask_in_turn(seed)


def ask_in_turn(seed: int) -> None:
    """Ask a healthy robot for speeds in turn: it is not held. Four seeds have each battery with each robot."""
    chance = random.Random(seed)
    sim, drive = [*BATTERIES.values()][seed % 2], [*DRIVES.values()][seed // 2 % 2]
    with driver(truth=draw_truth("uncalibrated", TruthRanges(), seed), sim=sim, drive=drive) as line:
        for _ in range(25):
            if chance.random() < 0.5:
                asked = (chance.uniform(-0.55, 0.55), chance.uniform(-0.55, 0.55))
            else:
                asked = (chance.choice((-0.5, -0.1, 0.0, 0.1, 0.5)),) * 2
            line.go(asked[0], asked[1], 0.02 * chance.choice((1, 2, 5, 20, 50)))
            assert not line.is_held, asked


def duties(line: Driver) -> tuple[float, float]:
    motors = line.simulation.boards[BoardKind.BASE].model.motor
    return motors[0].drive, motors[1].drive


def ms_until_stopped(line: Driver, left: float, right: float) -> int:
    """How long the motors still get something, while these speeds are asked for."""
    began_us = line.simulation.now_us
    while duties(line) != (0, 0):
        line.go(left, right, 0.02 if line.simulation.now_us % 20_000 == 0 else 0.001)
        assert line.simulation.now_us - began_us < 3_000_000
    return (line.simulation.now_us - began_us) // 1000


def test_a_wheel_that_is_held_stops_both_and_is_latched_the_third_time(implementation: Implementation) -> None:
    with driver(implementation) as line:
        for time in range(3):
            line.go(0.4, 0.4, 0.8)
            wheels_of(line.simulation.world).block_wheel(RIGHT, is_blocked=True)
            assert ms_until_stopped(line, 0.4, 0.4) <= 100
            line.run(0.02)
            assert line.wheels.drive_state == (DriveState.HELD if time < 2 else DriveState.LATCHED)
            assert line.wheels.speed_flags & SpeedFlag.RIGHT_HELD
            wheels_of(line.simulation.world).block_wheel(RIGHT, is_blocked=False)
            line.go(0.4, 0.4, 0.1)
            assert duties(line) == (0, 0), "not before a zero"
            line.go(0.0, 0.0, 0.1)
        assert line.wheels.latch == Latch.RIGHT_STUCK


def test_a_wheel_that_never_turned_is_stuck(implementation: Implementation) -> None:
    with driver(implementation) as line:
        wheels_of(line.simulation.world).block_wheel(LEFT, is_blocked=True)
        line.go(0.4, 0.4, 0.2)
        assert 0 < duties(line)[0] <= BY_SPEED.speed_control.stall_pwm + 0.5
        line.go(0.4, 0.4, 0.6)
        assert line.wheels.latch == Latch.LEFT_STUCK


def test_an_overdue_edge_takes_the_loop_away(implementation: Implementation) -> None:
    with driver(implementation) as line:
        line.go(0.09, 0.09, 1.0)
        wheels_of(line.simulation.world).block_wheel(LEFT, is_blocked=True)
        line.go(0.09, 0.09, 0.1)
        assert line.wheels.speed_flags == SpeedFlag.LEFT_OVERDUE
        given = duties(line)[0]
        line.go(0.09, 0.09, 1.0)
        assert duties(line)[0] == pytest.approx(given, abs=1), "it gathers nothing"
        assert not line.is_held


def test_a_wheel_without_edges_is_held(implementation: Implementation) -> None:
    """It had only crept: a cut encoder."""
    with driver(implementation) as line:
        line.go(0.11, 0.11, 0.12)
        while line.wheels.left_ticks < 3:
            line.go(0.11, 0.11, 0.02)
        wheels_of(line.simulation.world).cut_encoder(LEFT, is_cut=True)
        assert ms_until_stopped(line, 0.11, 0.11) <= 230
        line.run(0.02)
        assert line.wheels.drive_state == DriveState.HELD
        assert line.wheels.speed_flags & SpeedFlag.LEFT_HELD


def test_the_curve_stays_at_the_limit_of_the_weaker_motor() -> None:
    weak = Truth(left=TrueWheel(strength=0.85), right=TrueWheel(strength=1.0))
    drive = msgspec.structs.replace(
        BY_SPEED, speed_control=msgspec.structs.replace(BY_SPEED.speed_control, max_pwm=70, motor_time=0.0)
    )
    with driver(truth=weak, sim=LOW, drive=drive) as line:
        line.towards(0.55, 0.44, 4.0)
        assert line.wheels.speed_flags == SpeedFlag.AT_LIMIT
        left, right = line.plant.left.speed, line.plant.right.speed
        assert left < 0.5
        assert left / right == pytest.approx(0.55 / 0.44, rel=0.03)
        line.plant.open_volts = 29.0
        line.towards(0.55, 0.44, 4.0)
        assert line.wheels.speed_flags == 0
        assert line.plant.left.speed == pytest.approx(0.55, rel=0.03)
        assert line.plant.right.speed == pytest.approx(0.44, rel=0.03)


@pytest.mark.parametrize("level", [130, 200])
def test_motors_that_take_most_of_the_pwm_reach_their_speed(level: int) -> None:
    strong = msgspec.structs.replace(
        BY_SPEED,
        max_level=level,
        speed_control=msgspec.structs.replace(BY_SPEED.speed_control, max_pwm=255, stall_pwm=100),
    )
    with driver(drive=strong) as line:
        line.towards(0.6, 0.6, 3.0)
        assert line.wheels.speed_flags == 0
        assert line.plant.left.speed == pytest.approx(0.6, rel=0.01)
