"""The body: speeds, stopping, contact, and motion that agrees with exact arcs."""

import math
from itertools import pairwise

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_sim.bodies.wheels.plant import Plant
from giraff_sim.config import SimConfig
from giraff_sim.world.room import Pose
from tests.sim.robots import EXACT, ORIGIN, empty_room, room_with_wall, world_in
from tests.support.robots import DRIVE, ROBOT

STEP = 0.001


def plant_at_rest(start: Pose = ORIGIN, sim: SimConfig = EXACT) -> Plant:
    return Plant(ROBOT, DRIVE, sim, empty_room(start))


def drive(plant: Plant, seconds: float, left: float, right: float) -> None:
    for _ in range(round(seconds / STEP)):
        plant.step(STEP, left, right)


def test_level_70_is_0_6_metres_a_second_and_35_is_half_of_it() -> None:
    for level, speed in ((70, 0.6), (35, 0.3), (-70, -0.6), (10, 0.6 / 7)):
        plant = plant_at_rest()
        drive(plant, 3.0, level, level)
        assert plant.left.speed == pytest.approx(speed, rel=1e-6)
        assert plant.right.speed == plant.left.speed


def test_a_motor_below_its_dead_zone_does_not_move() -> None:
    plant = plant_at_rest()
    drive(plant, 1.0, 3.9, -3.9)
    assert plant.left.travel == plant.right.travel == 0.0


def test_an_encoder_that_flickers_counts_to_and_fro_at_rest_alone() -> None:
    wheel = (plant := plant_at_rest()).left
    wheel.flickers = True
    states = []
    for duty in (70.0, 0.0):
        drive(plant, 1.0, duty, duty)
        moment = []
        for _ in range(100):
            plant.step(STEP, duty, duty)
            moment.append(math.floor(wheel.states))
        states.append(moment)
    assert states[0] == sorted(states[0])
    assert {state // 2 for state in states[1]} == {states[1][0] // 2}, "the edge of A is between the two"
    assert sum(one != other for one, other in pairwise(states[1])) in (4, 5)


def test_stop_from_full_speed_takes_0_29_seconds() -> None:
    plant = plant_at_rest()
    drive(plant, 3.0, 70, 70)
    before = plant.pose.x
    steps = 0
    while plant.left.speed >= 0.01:
        plant.step(STEP, 0.0, 0.0)
        steps += 1
    assert steps * STEP == pytest.approx(0.29, abs=0.002)
    drive(plant, 0.5, 0.0, 0.0)
    assert plant.left.speed == 0.0
    # A mean of 2.9 m/s^2, about twice what the guard reckons with.
    assert 0.6**2 / 2 / (plant.pose.x - before) == pytest.approx(2.9, abs=0.05)


@pytest.mark.parametrize(
    ("slope_deg", "yaw", "wall", "rolls"),
    [
        (8.0, 0.0, -9.0, -0.69),
        (8.0, math.pi, -9.0, 0.69),
        (8.0, math.pi / 2, -9.0, 0.0),
        (3.0, 0.0, -9.0, 0.0),
        (8.0, 0.0, -0.5, -0.2),
        (8.0, 0.0, 0.299, -0.69),
    ],
)
def test_a_robot_without_power_rolls_down_a_slope_that_friction_does_not_hold(
    slope_deg: float, yaw: float, wall: float, rolls: float
) -> None:
    """A wall below holds it, and one above does not."""
    sloping = msgspec.structs.replace(EXACT, slope_deg=slope_deg)
    plant = Plant(ROBOT, DRIVE, sloping, room_with_wall(wall, Pose(0.0, 0.0, yaw)))
    drive(plant, 6.0, 0.0, 0.0)
    assert plant.left.travel == plant.right.travel == pytest.approx(rolls, abs=0.02)


def test_a_wheel_comes_to_rest_and_does_not_swing_back() -> None:
    plant = plant_at_rest()
    drive(plant, 1.0, 70, 70)
    drive(plant, 1.0, 0.0, 0.0)
    travel = plant.left.travel
    drive(plant, 1.0, 0.0, 0.0)
    assert plant.left.travel == travel


def test_a_blocked_wheel_stands_and_the_robot_turns_about_it() -> None:
    plant = plant_at_rest()
    drive(plant, 1.0, 70, 70)
    plant.right.is_blocked = True
    travel = plant.right.travel
    yaw = plant.pose.yaw
    drive(plant, 1.0, 70, 70)
    assert (plant.right.travel, plant.right.speed) == (travel, 0.0)
    assert plant.pose.yaw < yaw - 1.0
    plant.right.is_blocked = False
    drive(plant, 1.0, 70, 70)
    assert plant.right.travel > travel + 0.4


def test_the_battery_sags_under_load_and_takes_speed_with_it() -> None:
    plant = plant_at_rest(sim=SimConfig(battery_volts=24.0, battery_sag_volts=8.0))
    drive(plant, 3.0, 128, 128)
    assert plant.volts == pytest.approx(20.0, abs=0.02)
    assert plant.left.speed == pytest.approx(0.6 * 128 / 70 * plant.volts / 24.0, rel=1e-3)
    drive(plant, 0.001, 0.0, 0.0)
    assert plant.volts == 24.0


def test_the_battery_loses_a_fifth_of_its_volts_in_its_hours() -> None:
    world = world_in(empty_room(), SimConfig(battery_volts=25.0, battery_hours=1.0 / 3600.0))
    for millisecond in range(1, 2001):
        world.step(None)
        if millisecond in {500, 1000}:
            assert world.plant.volts == pytest.approx(25.0 - millisecond * 0.005)
    assert world.plant.volts == pytest.approx(15.0)


def test_axes_are_rep_103() -> None:
    plant = plant_at_rest()
    drive(plant, 1.0, -35, 35)
    assert plant.pose.yaw > 0.5
    assert math.hypot(plant.pose.x, plant.pose.y) < 1e-9
    plant = plant_at_rest(Pose(0.0, 0.0, math.pi / 2))
    drive(plant, 1.0, 35, 35)
    assert plant.pose.y > 0.1
    assert abs(plant.pose.x) < 1e-9


@given(st.floats(-70, 70), st.floats(-70, 70), st.floats(-3, 3))
def test_steady_wheels_make_an_exact_arc(left: float, right: float, yaw: float) -> None:
    plant = plant_at_rest(Pose(1.0, -2.0, yaw))
    plant.left.speed, plant.right.speed = left / 70 * 0.6, right / 70 * 0.6
    travels = []
    for _ in range(400):
        plant.step(STEP, left, right)
        travels.append((plant.left.travel, plant.right.travel))
    # The same travels, summed by the exact arc of each step.
    x, y, heading, before = 1.0, -2.0, yaw, (0.0, 0.0)
    for travel in travels:
        ahead, turn = (sum(travel) - sum(before)) / 2, (travel[1] - before[1] - travel[0] + before[0]) / 0.47
        chord = ahead if abs(turn) < 1e-9 else 2 * ahead / turn * math.sin(turn / 2)
        x, y = x + chord * math.cos(heading + turn / 2), y + chord * math.sin(heading + turn / 2)
        heading, before = heading + turn, travel
    # Half a step of acceleration apart: the wheels' travel is the speed's integral, the body takes its end.
    assert plant.pose.x == pytest.approx(x, abs=5e-4)
    assert plant.pose.y == pytest.approx(y, abs=5e-4)
    assert math.remainder(plant.pose.yaw - heading, math.tau) == pytest.approx(0.0, abs=2e-3)


def test_encoders_count_two_quadrature_states_a_tick() -> None:
    plant = plant_at_rest()
    drive(plant, 2.0, 70, -70)
    assert plant.left.states == pytest.approx(plant.left.travel * 4004.1188)
    assert plant.right.states == -plant.left.states


def test_a_wall_stops_the_body_counts_once_and_lets_it_back_away() -> None:
    plant = Plant(ROBOT, DRIVE, EXACT, room_with_wall(1.0))
    drive(plant, 4.0, 70, 70)
    assert plant.pose.x == pytest.approx(0.7, abs=1e-9)
    assert plant.contacts == 1
    assert plant.closest == 0.0
    assert plant.path_length == pytest.approx(0.7, abs=1e-6)
    assert plant.left.travel > 2.0  # the wheels slip
    drive(plant, 2.0, -70, -70)
    assert plant.pose.x < 0.0
    drive(plant, 4.0, 70, 70)
    assert plant.contacts == 2


def test_a_slanting_wall_is_slid_along() -> None:
    room = empty_room()
    room.add_wall("slant", [(0.0, 1.0), (12.0, -1.0)])
    plant = Plant(ROBOT, DRIVE, EXACT, room)
    drive(plant, 10.0, 70, 70)
    assert plant.contacts == 1
    assert plant.pose.y < -0.05
    assert room.clearance(plant.pose.x, plant.pose.y) >= 0.3 - 1e-9


def test_a_corner_holds_the_body_on_both_sides() -> None:
    room = empty_room()
    room.add_wall("corner", [(2.0, -2.0), (2.0, 0.5), (-2.0, 0.5)])
    plant = Plant(ROBOT, DRIVE, EXACT, room)
    plant.place(Pose(0.0, 0.0, math.radians(20)))
    drive(plant, 8.0, 70, 70)
    assert plant.pose.x == pytest.approx(1.7, abs=1e-3)
    assert plant.pose.y == pytest.approx(0.2, abs=1e-3)


def test_the_closest_approach_is_the_smallest_clearance_there_was() -> None:
    plant = Plant(ROBOT, DRIVE, EXACT, room_with_wall(2.0))
    smallest = plant.clearance
    for level in (70, -70, 40, -20):
        for _ in range(1500):
            plant.step(STEP, level, level)
            smallest = min(smallest, plant.clearance)
    assert smallest > 0.1
    assert plant.closest == pytest.approx(smallest, abs=1e-12)


def test_placing_starts_a_new_closest_approach_at_rest() -> None:
    plant = Plant(ROBOT, DRIVE, EXACT, room_with_wall(1.0))
    drive(plant, 4.0, 70, 70)
    plant.place(Pose(-1.0, 0.0, 0.0))
    assert plant.closest == pytest.approx(1.7)
    assert plant.left.speed == 0.0
    with pytest.raises(ValueError, match="cannot be at"):
        plant.place(Pose(math.nan, 0.0, 0.0))


def test_a_wall_put_up_on_the_robot_is_a_contact() -> None:
    room = empty_room()
    plant = Plant(ROBOT, DRIVE, EXACT, room)
    room.add_wall("sudden", [(0.2, -1.0), (0.2, 1.0)])
    drive(plant, 0.002, 0.0, 0.0)
    assert plant.contacts == 1
    assert plant.pose.x == pytest.approx(-0.1)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("motor_time_constant", 0.0),
        ("wheel_friction", -1.0),
        ("sonar_crosstalk", 1.5),
        ("battery_volts", math.nan),
    ],
)
def test_values_no_robot_has_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        msgspec.structs.replace(SimConfig(), **{field: value})
