"""The body that balances, where closed forms say what it must do."""

import math
from typing import Any

import pytest

from giraff_sim.bodies.balancer.drawn import draw
from giraff_sim.bodies.balancer.people import half_sine
from giraff_sim.bodies.balancer.plant import STEP, Plant
from giraff_sim.bodies.balancer.sensors import VOLTS_PER_COUNT, Sensors
from giraff_sim.world.room import Pose, Room
from tests.support.balancer_file import DRIVE, ROBOT

G = 9.81


def plant_of(seed: int | None = None, **fixed: Any) -> Plant:
    """Return a robot at rest: the nominal one, or a drawn one."""
    drawn = draw(DRIVE, ROBOT.track_width, seed or 0, 0.0 if seed is None else 1.0, **fixed)
    return Plant(drawn, Room("empty", Pose(0.0, 0.0, 0.0)), ROBOT.footprint_radius)


def run(plant: Plant, seconds: float, share: float = 0.0, *, is_open: bool = False) -> None:
    for _ in range(round(seconds / STEP)):
        plant.step(share, share, is_open=is_open)


def energy(plant: Plant) -> float:
    """J of motion and of height. The springs of gears, tyres and casters are left out: they only give back."""
    d, lean, rate, speed = plant.drawn, plant.lean, plant.lean_rate, plant.speed
    body_speed2 = speed**2 + 2 * speed * rate * d.centre_height * math.cos(lean) + (rate * d.centre_height) ** 2
    wheels = sum(d.wheel_inertia * w.rate**2 + d.rotor_inertia * w.rotor_rate**2 for w in (plant.left, plant.right))
    moving = d.body_mass * body_speed2 + 2 * d.wheel_mass * speed**2 + d.body_inertia * rate**2
    return (moving + wheels + d.yaw_inertia * plant.turn**2) / 2 + d.body_mass * G * d.centre_height * math.cos(lean)


def test_it_falls_as_the_linear_pendulum_does() -> None:
    plant = plant_of(friction=(0.0, 0.0), load_loss=(0.0, 0.0), play=(0.0, 0.0), rolling=0.0)
    plant.lean_to(0.002)
    run(plant, 0.8, is_open=True)
    # Lean and way: [M + 2(Jw + Jm)/r², m l - 2 Jm/r; m l - 2 Jm/r, I + m l² + 2 Jm] (x'', th'') = (0, m g l th)
    m, height, r, jm = DRIVE.body_mass, DRIVE.centre_height, DRIVE.wheel_radius, DRIVE.rotor_inertia
    across = m * height - 2 * jm / r
    total = m + 2 * DRIVE.wheel_mass + 2 * (DRIVE.wheel_inertia + jm) / r**2
    about = DRIVE.body_inertia + m * height**2 + 2 * jm
    exponent = math.sqrt(m * G * height * total / (total * about - across**2))
    assert exponent**2 == pytest.approx(13.5, rel=0.01)
    assert plant.lean == pytest.approx(0.002 * math.cosh(exponent * 0.8), rel=0.02)
    assert plant.way == pytest.approx(-across / total * (plant.lean - 0.002), rel=0.03)


@pytest.mark.parametrize("is_open", [True, False])
def test_without_power_its_energy_never_grows(is_open: bool) -> None:
    plant = plant_of(3)
    plant.lean_to(math.radians(6.0))
    before = energy(plant)
    for _ in range(3000):
        plant.step(0.0, 0.0, is_open=is_open)
        assert energy(plant) < before + 0.01
    assert plant.falls == 1
    lies = plant.lean + plant.grade
    assert plant.drawn.caster < lies < plant.drawn.caster + math.radians(2.0), "a caster holds it"
    assert abs(plant.speed) < 1e-3
    assert abs(plant.lean_rate) < 1e-3


def test_a_rotor_turns_free_within_the_play_of_its_gear() -> None:
    plant = plant_of(friction=(0.0, 0.0), load_loss=(0.0, 0.0))
    plant.left.is_blocked = plant.right.is_blocked = True
    plant.loads.grip = 0.0
    places = []
    for share in (0.1, -0.1):
        run(plant, 0.5, share)
        places.append(plant.left.rotor_angle)
    torque = 0.1 * plant.volts / DRIVE.motor_resistance * DRIVE.motor_constant
    assert places[0] - places[1] == pytest.approx(math.radians(1.5) + 2 * torque / 3000.0, abs=0.002)


def test_a_battery_sags_by_15_percent_with_both_motors_stalled() -> None:
    plant = plant_of()
    plant.left.is_blocked = plant.right.is_blocked = True
    plant.loads.grip = 0.0
    run(plant, 0.5, 1.0)
    assert plant.volts == pytest.approx(plant.open_volts * (1 - 0.15 / 1.15), rel=0.01)


def test_a_push_has_its_impulse_and_a_wall_stops_the_axle() -> None:
    assert sum(half_sine(5.0, k * STEP) for k in range(300)) * STEP == pytest.approx(5.0, rel=1e-3)
    plant = plant_of()
    plant._room.add_wall("wall", [(0.4, -1.0), (0.4, 1.0)])
    plant.loads.force, plant.loads.height = 60.0, 0.0
    run(plant, 1.0, is_open=True)
    assert plant.contacts == 1
    assert plant.pose.x == pytest.approx(0.05, abs=1e-6)
    assert plant.way == pytest.approx(plant.pose.x, abs=1e-6)


def test_both_axes_see_the_lean_and_opposite_shares_of_the_roll() -> None:
    plant = plant_of()
    sensors = Sensors(plant, 1)
    for rate, turn, lean in ((0.5, 0.0, 0.0), (0.0, 2.0, 0.1), (0.3, -1.0, -0.2)):
        counts = [0.0] * 4
        for k in range(400):
            plant.lean, plant.lean_rate, plant.turn = lean, rate, turn
            if k >= 100:
                counts = [a + (v / VOLTS_PER_COUNT - 0.5) / 300 for a, v in zip(counts, sensors.volts(), strict=True)]
            else:
                sensors.volts()
        scale, roll = math.degrees(math.sqrt(0.5)) / 1.611, -turn * math.sin(lean)
        assert counts[0] == pytest.approx(471 + scale * (rate + roll), abs=0.1)
        assert counts[1] == pytest.approx(471 + scale * (rate - roll), abs=0.1)
        turned = 0.03 / G * rate**2  # the sensor sits 30 mm above the axle
        assert counts[2] == pytest.approx(512 - 102 * math.sin(lean), abs=0.15)
        assert counts[3] == pytest.approx(512 + 102 * (math.cos(lean) - turned), abs=0.15)


def test_the_nominal_robot_is_that_of_its_file() -> None:
    drawn = plant_of().drawn
    assert (drawn.body_mass, drawn.friction, drawn.delay) == (DRIVE.body_mass, (DRIVE.friction,) * 2, 3)
