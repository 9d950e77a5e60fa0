"""A robot that is not as its file says: what the world makes of it, and what services are told."""

import math
import statistics

import msgspec
import pytest

from giraff_core.kinematics.calibration import Calibration
from giraff_core.senses import Camera
from giraff_sim.bodies.wheels.plant import Plant
from giraff_sim.truth import Level, TrueWheel, Truth, TruthRanges, draw_truth
from giraff_sim.world.room import Room
from giraff_sim.world.sonar import Sonar, SonarFault
from tests.sim.robots import EXACT, ORIGIN, empty_room, room_with_wall, world_in
from tests.support.robots import DRIVE, ROBOT, ULTRASONIC

STEP = 0.001
COUNTS_PER_METRE = ROBOT.ticks_per_metre * 2  # of the encoder's quadrature states


def plant_of(truth: Truth, room: Room | None = None) -> Plant:
    return Plant(ROBOT, DRIVE, EXACT, room or empty_room(), truth)


def drive(plant: Plant, seconds: float, left: float, right: float) -> None:
    for _ in range(round(seconds / STEP)):
        plant.step(STEP, left, right)


def believed(plant: Plant) -> tuple[float, float]:
    """m and rad that the robot file makes of the encoders."""
    left, right = plant.left.states / COUNTS_PER_METRE, plant.right.states / COUNTS_PER_METRE
    return (left + right) / 2.0, (right - left) / ROBOT.track_width


def test_larger_wheels_roll_farther_than_the_counts_say() -> None:
    wheel = TrueWheel(scale=1.02)
    plant = plant_of(Truth(left=wheel, right=wheel))
    drive(plant, 5.0, 70, 70)
    assert believed(plant)[0] > 2.5
    assert plant.pose.x == pytest.approx(1.02 * believed(plant)[0], abs=1e-3)
    assert plant.left.speed == pytest.approx(1.02 * 0.6)


def test_unlike_wheels_turn_a_robot_that_believes_it_goes_straight() -> None:
    plant = plant_of(Truth(left=TrueWheel(scale=0.9975), right=TrueWheel(scale=1.0025)))
    drive(plant, 30.0, 35, 35)
    way, turn = believed(plant)
    assert turn == pytest.approx(0.0, abs=1e-9)
    assert plant.pose.yaw == pytest.approx(0.005 * way / ROBOT.track_width, rel=1e-3)


@pytest.mark.parametrize(
    ("truth", "share"), [(Truth(track_scale=1.03), 1 / 1.03), (Truth(turn_slip=0.02), 0.98), (Truth(), 1.0)]
)
def test_a_wider_track_and_slip_turn_less_than_the_counts_say(truth: Truth, share: float) -> None:
    plant = plant_of(truth)
    drive(plant, 1.5, -35, 35)
    assert plant.pose.yaw == pytest.approx(share * believed(plant)[1], abs=2e-3)
    assert plant.turn == pytest.approx(share * 0.6 / ROBOT.track_width, rel=1e-3)
    straight = plant_of(truth)
    drive(straight, 3.0, 70, 70)
    assert straight.pose.x == pytest.approx(believed(straight)[0], abs=1e-3)


def test_a_weak_motor_is_slower_and_its_encoder_says_so() -> None:
    plant = plant_of(Truth(right=TrueWheel(strength=0.85)))
    drive(plant, 3.0, 70, 70)
    assert [plant.left.speed, plant.right.speed] == pytest.approx([0.6, 0.51])
    assert plant.pose.yaw < -0.3
    assert math.remainder(believed(plant)[1] - plant.pose.yaw, math.tau) == pytest.approx(0.0, abs=2e-3)


def test_the_phase_shifts_the_counts_by_less_than_one() -> None:
    plant = plant_of(Truth(left=TrueWheel(phase=0.75)))
    assert (plant.left.states, plant.right.states) == (1.5, 0.0)
    drive(plant, 1.0, 70, 70)
    assert plant.left.states - plant.right.states == pytest.approx(1.5)


def doorway(y: float = 10.0) -> Room:
    room = empty_room()
    room.add_threshold("sill", (0.5, -y), (0.5, y))
    return room


def test_a_wheel_slips_on_each_threshold_once() -> None:
    slips = Truth(left=TrueWheel(threshold_slip=0.02), right=TrueWheel(threshold_slip=0.005))
    plant = plant_of(slips, doorway())
    drive(plant, 3.0, 70, 70)
    assert plant.left.travel == plant.right.travel
    assert plant.pose.yaw == pytest.approx(0.015 / ROBOT.track_width, abs=1e-3)
    drive(plant, 0.5, 0.0, 0.0)
    lost = believed(plant)[0] - plant.path_length
    assert lost == pytest.approx(0.0125, abs=1e-3)
    drive(plant, 4.0, -70, -70)
    assert plant.pose.x < 0.0
    drive(plant, 0.5, 0.0, 0.0)
    assert plant.left.travel - plant.right.travel == pytest.approx(0.0, abs=1e-9)
    assert plant.pose.yaw == pytest.approx(0.0, abs=2e-3), "and back, as much"


def test_a_wheel_beside_a_threshold_does_not_slip() -> None:
    room = empty_room()
    room.add_threshold("edge", (0.5, 0.1), (0.5, 1.0))
    plant = plant_of(Truth(left=TrueWheel(threshold_slip=0.02), right=TrueWheel(threshold_slip=0.02)), room)
    drive(plant, 3.0, 70, 70)
    assert plant.pose.yaw == pytest.approx(0.02 / ROBOT.track_width, abs=1e-3)


def test_a_sensor_looks_along_its_true_axis() -> None:
    room = empty_room()
    room.add_post("pole", 2.0, 0.15 + 1.75 * math.tan(math.radians(9.0)), 0.02)
    assert world_in(room).sonars[0].heard(ORIGIN) is None
    turned = world_in(room, truth=Truth(sensor_yaws=(math.radians(3.0), 0.0, 0.0)))
    assert turned.sonars[0].heard(ORIGIN) == pytest.approx(1.75, abs=0.05)
    assert turned.sonars[1].heard(ORIGIN) is None


def test_a_sensor_sits_where_it_truly_does_and_its_echo_has_its_own_scale() -> None:
    truth = draw_truth("uncalibrated", TruthRanges(sensor_x=0.03, sonar_scale=0.04, sonar_noise=0.0, sensor_yaw=0.0), 4)
    assert 0.0 < abs(truth.sensor_xs[0]) < 0.03
    assert 0.0 < abs(truth.sonar_scales[0] - 1.0) < 0.04
    told = world_in(room_with_wall(2.0), truth=truth).echo_us(0) / 5800.0
    assert told * truth.sonar_scales[0] == pytest.approx(1.75 - truth.sensor_xs[0])
    ignored = {"sensor_xs": (0.0,) * 3, "sonar_scales": (1.0,) * 3, "sonar_noise": 0.01, "sensor_yaws": ()}
    same = msgspec.structs.replace(drawn("uncalibrated", 4), sensor_yaws=())
    assert msgspec.structs.replace(truth, **ignored) == same, "a seed is the robot that it was"


def test_ranges_are_as_noisy_as_is_true() -> None:
    world = world_in(room_with_wall(2.0), truth=Truth(sonar_noise=0.01))
    ranges = [world.echo_us(0) / 5800.0 for _ in range(2000)]
    assert statistics.mean(ranges) == pytest.approx(1.75, abs=1e-3)
    assert statistics.stdev(ranges) == pytest.approx(0.01, rel=0.1)
    assert world.sonars[0].heard(ORIGIN) == pytest.approx(1.75)


@pytest.mark.parametrize("fault", SonarFault)
def test_what_a_sound_sensor_hears_is_known_whatever_the_sensor_says(fault: SonarFault) -> None:
    asked, left = (world_in(room_with_wall(2.0), seed=5, truth=Truth(sonar_noise=0.01)) for _ in range(2))
    told: list[list[float]] = [[], []]
    for world, echoes in zip((asked, left), told, strict=True):
        sonar = world.sonars[0]
        sonar.fault, sonar.wild_share = fault, 0.3
        for _ in range(20):
            echoes.append(sonar.echo_us(ORIGIN))
            if world is asked:
                assert sonar.heard(ORIGIN) == pytest.approx(1.75)
    assert told[0] == told[1], "asking draws nothing"


def test_only_what_is_heard_for_certain_counts_as_heard() -> None:
    room = room_with_wall(3.0)
    along = (math.sin(math.radians(40.0)), math.cos(math.radians(40.0)))
    room.add_wall("slanted, left of the axis", [(1.0, 0.16), (1.0 + 0.3 * along[0], 0.16 + 0.3 * along[1])])
    sonar = Sonar(ULTRASONIC["front_left"], room, EXACT, "seed")
    echo = sonar.sure_echo(ORIGIN)
    assert echo is not None
    assert echo.surface == 0
    assert echo.distance == pytest.approx(2.75)
    told = {round(sonar.echo_us(ORIGIN) / 5800.0, 2) for _ in range(200)}
    assert told == {0.76, 2.75}, "by chance, what is slanted"


def drawn(level: Level, seed: int) -> Truth:
    return draw_truth(level, TruthRanges(), seed)


def test_an_exact_robot_is_its_file() -> None:
    assert drawn("exact", 1) == drawn("exact", 2) == Truth()


def test_a_seed_is_one_robot_calibrated_or_not() -> None:
    before, after = drawn("uncalibrated", 3), drawn("calibrated", 3)
    assert before == drawn("uncalibrated", 3)
    assert before != drawn("uncalibrated", 4)
    assert after.left.scale - 1.0 == pytest.approx((before.left.scale - 1.0) / 20.0)
    assert after.track_scale - 1.0 == pytest.approx((before.track_scale - 1.0) / 10.0)
    same = {"scale": 1.0}
    for truth in (before, after):
        assert msgspec.structs.replace(truth.left, **same) == msgspec.structs.replace(before.left, **same)
    assert after.sensor_yaws == before.sensor_yaws
    assert after.accelerometer_offset == before.accelerometer_offset


FOUND = Calibration(date="2026-11-25", left_wheel_scale=1.013, right_wheel_scale=0.991, track_scale=1.026)


def test_a_camera_differs_from_its_file_by_a_chance_of_its_own() -> None:
    file, before, after = Camera(z=1.0, pitch=0.35), drawn("uncalibrated", 3).camera, drawn("calibrated", 3).camera
    assert drawn("exact", 3).camera.of(file) == file
    assert after.pitch == pytest.approx(before.pitch / 10.0)
    true = before.of(file)
    assert true.z == pytest.approx(before.height_scale)
    assert true.pitch == pytest.approx(0.35 + before.pitch)
    assert true.focal_x == true.focal_y == pytest.approx(230.0 * before.focal_scale)
    assert true.distortion == before.distortion
    cameras = [drawn("uncalibrated", seed).camera for seed in range(100)]
    assert 1.8 < max(abs(math.degrees(camera.pitch)) for camera in cameras) < 2.0
    still = draw_truth("uncalibrated", TruthRanges(camera_height=0.0, camera_pitch=0.0), 3)
    assert msgspec.structs.replace(still, camera=before) == drawn("uncalibrated", 3)  # nothing else is drawn by it


def test_a_calibration_does_not_change_the_robot_that_was_calibrated() -> None:
    assert draw_truth("uncalibrated", TruthRanges(), 7, FOUND) == drawn("uncalibrated", 7)


def measured(truth: Truth) -> Calibration:
    """What a faultless calibration finds of a robot."""
    return Calibration(
        date="2026-11-25",
        left_wheel_scale=truth.left.scale,
        right_wheel_scale=truth.right.scale,
        track_scale=truth.track_scale / (1.0 - truth.turn_slip),
    )


@pytest.mark.parametrize(
    ("level", "calibration"),
    [("exact", FOUND), ("uncalibrated", measured(draw_truth("uncalibrated", TruthRanges(), 7)))],
)
def test_odometry_is_right_of_a_robot_that_is_as_its_calibration_says(level: Level, calibration: Calibration) -> None:
    robot = msgspec.structs.replace(ROBOT, calibration=calibration)
    plant = Plant(robot, DRIVE, EXACT, empty_room(), draw_truth(level, TruthRanges(), 7, calibration))
    before = plant.left.states, plant.right.states
    drive(plant, 3.0, 40, 70)
    left = (plant.left.states - before[0]) / 2.0 / robot.left_ticks_per_metre
    right = (plant.right.states - before[1]) / 2.0 / robot.right_ticks_per_metre
    way, turn = robot.kinematics.twist(left, right)
    assert turn > 1.0
    assert plant.path_length == pytest.approx(way, abs=1e-3)
    assert plant.pose.yaw == pytest.approx(turn, abs=1e-3)


@pytest.mark.parametrize("seed", range(20))
def test_a_calibrated_robot_is_near_what_its_calibration_says(seed: int) -> None:
    near, plain = draw_truth("calibrated", TruthRanges(), seed, FOUND), drawn("calibrated", seed)
    assert near.left.scale == pytest.approx(FOUND.left_wheel_scale, rel=0.001)
    assert near.right.scale == pytest.approx(FOUND.right_wheel_scale, rel=0.001)
    turns_as = near.track_scale / (1.0 - near.turn_slip)
    assert turns_as == pytest.approx(FOUND.track_scale, rel=0.003), "what slips was measured with the track"
    geometry = {"left": plain.left, "right": plain.right, "track_scale": plain.track_scale}
    assert msgspec.structs.replace(near, **geometry) == plain, "motors, sensors and the rest are the seed's"
    for one, other in ((near.left, plain.left), (near.right, plain.right)):
        assert msgspec.structs.replace(one, scale=other.scale) == other


@pytest.mark.parametrize(("level", "wheels", "track"), [("uncalibrated", 0.02, 0.03), ("calibrated", 0.001, 0.003)])
def test_seeds_fill_the_ranges_and_no_more(level: Level, wheels: float, track: float) -> None:
    truths = [drawn(level, seed) for seed in range(400)]
    columns = {
        "wheels": ([wheel.scale for truth in truths for wheel in (truth.left, truth.right)], 1 - wheels, 1 + wheels),
        "track": ([truth.track_scale for truth in truths], 1 - track, 1 + track),
        "motors": ([wheel.strength for truth in truths for wheel in (truth.left, truth.right)], 0.85, 1.0),
        "phases": ([wheel.phase for truth in truths for wheel in (truth.left, truth.right)], 0.0, 1.0),
        "slip": ([truth.turn_slip for truth in truths], 0.0, 0.01),
        "thresholds": ([wheel.threshold_slip for truth in truths for wheel in (truth.left, truth.right)], 0.0, 0.02),
        "tilt": ([axis for truth in truths for axis in truth.accelerometer_offset], -0.3, 0.3),
        "axes": ([yaw for truth in truths for yaw in truth.sensor_yaws], -0.05236, 0.05236),
    }
    for name, (values, least, most) in columns.items():
        margin = (most - least) * 0.02
        assert least <= min(values) <= least + margin, name
        assert most - margin <= max(values) <= most, name
    assert {truth.sonar_noise for truth in truths} == {0.01}
    assert {len(truth.sensor_yaws) for truth in truths} == {3}


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("wheel_scale", 0.31),
        ("track_scale", -0.01),
        ("calibrated_wheel_scale", 0.03),
        ("calibrated_track_scale", 0.04),
        ("motor_weakness", 1.0),
        ("turn_slip", math.nan),
        ("threshold_slip", -0.001),
        ("accelerometer_offset", math.inf),
        ("sonar_noise", -1.0),
        ("sensor_yaw", 3.0),
    ],
)
def test_ranges_of_no_robot_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        TruthRanges(**{field: value})
