"""What is heard and seen becomes rates, losses, ages and errors."""

import math
from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_cli.run.announcer import Announcer
from giraff_cli.run.telemetry import Comparison, RunTelemetry
from giraff_core.kinematics.pose import Pose
from giraff_schemas import topics
from giraff_schemas.codec import stamped
from giraff_schemas.messages import Tick, TruePose
from giraff_telemetry.rate import RateEstimator
from giraff_tools.network.statistics import AgeHistogram
from tests.unit.cli.samples import (
    EPOCH,
    MS,
    START,
    TYPES,
    Network,
    command,
    drive_ten_seconds,
    odometry,
    ten_seconds,
    truth,
    wheels,
)

SECOND = 1000 * MS


def quiet() -> tuple[RunTelemetry, Network]:
    telemetry = RunTelemetry(TYPES, truth(0))
    return telemetry, Network(telemetry)


def test_rates_are_counted_by_sequence_and_a_loss_does_not_lower_them() -> None:
    telemetry, network = quiet()
    for count in range(101):
        network.send(topics.CMD_VEL, command(None), count * 100 * MS, lose=count % 10 == 5)
    assert telemetry.rates_hz == {topics.CMD_VEL.key: pytest.approx(10.0)}
    assert telemetry.lost == {topics.CMD_VEL.key: 10}
    assert telemetry.snapshot(10 * SECOND).rates[topics.CMD_VEL.key].hz == pytest.approx(10.0)


def test_what_boards_pace_is_judged_in_simulated_time_and_the_rest_by_the_clock() -> None:
    telemetry, network = quiet()
    for count in range(1001):  # the simulation runs at 0.8 of the wall's pace
        now = count * 10 * MS
        if count % 20 == 0:
            telemetry.see(truth(now, simulated_us=round(now / 1000 * 0.8)))
        network.send(topics.WHEELS, wheels(now), now)
        network.send(topics.TICK, Tick(epoch=EPOCH, robot_ns=now), now)
    assert telemetry.rates_hz[topics.WHEELS.key] == pytest.approx(125.0, rel=0.01)
    assert telemetry.rates_hz[topics.TICK.key] == pytest.approx(100.0, rel=0.01)
    assert telemetry.skew == pytest.approx(0.2)


def test_a_run_is_judged_from_its_beginning() -> None:
    telemetry, network = quiet()
    for now in (0, 3 * SECOND, 4 * SECOND):
        network.send(topics.TICK, Tick(epoch=EPOCH, robot_ns=now), now)
    telemetry.see(truth(4 * SECOND, simulated_us=2_000_000))
    telemetry.begin()
    network.send(topics.TICK, Tick(epoch=EPOCH, robot_ns=0), 4 * SECOND + 20 * MS)
    telemetry.see(truth(5 * SECOND, simulated_us=3_000_000))
    assert telemetry.rates_hz == {topics.TICK.key: pytest.approx(50.0)}
    assert telemetry.skew == pytest.approx(0.0)


def test_a_restarted_maker_counts_from_zero_and_loses_nothing_by_it() -> None:
    telemetry, network = quiet()
    for count in range(100):
        network.send(topics.WHEELS, wheels(0), count * 10 * MS, maker="first" if count < 50 else "second")
    assert telemetry.lost == {}
    assert telemetry.rates_hz[topics.WHEELS.key] == pytest.approx(100.0)


def test_samples_before_the_first_that_was_heard_are_not_lost() -> None:
    flow = RateEstimator(500, 0.0)
    flow.on_sample(500, 0.0)
    flow.on_sample(501, 0.1)
    assert flow.lost == 0
    flow.on_sample(504, 0.4)
    assert flow.lost == 2


def test_a_rate_is_alarming_only_while_samples_are_lost() -> None:
    telemetry, network = quiet()
    for count in range(100):
        network.send(topics.CMD_VEL, command(None), count * 100 * MS, lose=count == 20)
        rate = telemetry.snapshot(count * 100 * MS).rates[topics.CMD_VEL.key]
        assert rate.lost == (1 if count > 20 else 0)
        if not 45 < count < 55:  # the last moments are three seconds, give or take a mark
            assert rate.losing == (20 < count < 50)


def test_a_loss_over_a_long_cut_is_noticed_too() -> None:
    flow = RateEstimator(0, 0.0)
    flow.on_sample(0, 0.0)
    flow.on_sample(100, 10.0)
    assert flow.loses_now(10.0)
    assert not flow.loses_now(14.0)


def test_a_service_that_restarts_for_days_does_not_fill_the_memory() -> None:
    telemetry, network = quiet()
    for start in range(200):
        for count in range(10):
            now = start * 5 * SECOND + count * 100 * MS
            network.send(topics.CMD_VEL, command(None), now, maker=f"maker {start}", lose=count == 5)
    assert len(telemetry._keys[topics.CMD_VEL.key].flows) == 1
    assert len(telemetry.all(topics.CMD_VEL, 0)) == 20
    assert telemetry.lost == {topics.CMD_VEL.key: 200}
    assert telemetry.rates_hz == {topics.CMD_VEL.key: pytest.approx(10.0)}


def test_a_key_that_fell_silent_has_no_rate_now() -> None:
    telemetry = ten_seconds()
    assert telemetry.snapshot(10 * SECOND).rates[topics.TICK.key].hz == pytest.approx(50.0)
    assert telemetry.snapshot(14 * SECOND).rates[topics.TICK.key].hz is None


def test_keys_are_in_the_order_of_the_table() -> None:
    # The others are of no robot by itself.
    others = (
        *(topics.CAMERA, topics.CAMERA_SMALL, topics.CAMERA_ON, topics.CAMERA_STATE, topics.VISUAL_ODOM),
        *(topics.ATTITUDE, topics.BUMPER, topics.SCAN, topics.MOTION_HOLD, topics.POSE, topics.PARTICLES, topics.MAP),
        *(topics.PLACES, topics.PLACES_HOLD, topics.ROUTE, topics.TRUE_POSE),
    )
    order = [topic.key for topic in topics.TOPICS if topic.rate_hz and topic not in others]
    heads = [key.partition("/")[0] for key in ten_seconds().rates_hz]
    assert heads == [key.partition("/")[0] for key in order for _ in range(3 if key == topics.RANGE.key else 1)]


def test_the_true_pose_is_told_in_the_frame_of_odometry_once_that_has_begun() -> None:
    telemetry, network = quiet()
    network.send(topics.TICK, Tick(epoch=EPOCH, robot_ns=0), 0)
    telemetry.see(truth(0))
    assert telemetry.true_pose is None
    told = ten_seconds().true_pose
    assert told is not None
    assert (told.tick.epoch, told.tick.robot_ns) == (EPOCH, 10 * SECOND)
    assert (told.x, told.y, told.yaw) == pytest.approx((4.0, 0.0, 0.0), abs=1e-6)


def test_the_room_is_told_in_the_frame_of_odometry_and_seldom() -> None:
    corner, session = (START.x, START.y + 1.0), MagicMock()
    telemetry = RunTelemetry(TYPES, truth(0), [[corner, (START.x + 3.0, START.y)]])
    assert telemetry.walls() == ()
    drive_ten_seconds(telemetry)
    [line] = telemetry.walls()
    assert [*map(list, line)] == [pytest.approx([0.0, 1.0]), pytest.approx([3.0, 0.0])]
    announcer = Announcer(session, "sim-test")
    for _ in range(3):
        announcer.publish(telemetry.true_pose, telemetry.walls)
    said = [decoded(call.args[0]) for call in session.declare_publisher.return_value.put.call_args_list]
    assert [sample.walls for sample in said] == [(line,), (), ()]


def decoded(payload: bytes) -> TruePose:
    return msgspec.msgpack.decode(payload, type=TruePose)


def test_the_age_of_a_command_is_from_the_operators_tick_to_its_arrival() -> None:
    telemetry, network = quiet()
    network.send(topics.TICK, Tick(epoch=EPOCH, robot_ns=0), 0)
    for count in range(1, 101):
        network.send(topics.CMD_VEL, command(SECOND), SECOND + count * MS)
    age = telemetry.age_ms
    assert age is not None
    assert (age.p50, age.p99, age.max) == (50.0, 99.0, 100.0)


def test_a_tick_of_another_epoch_or_none_has_no_age() -> None:
    telemetry, network = quiet()
    network.send(topics.CMD_VEL, command(0), 5 * MS)  # the tick is not known yet
    network.send(topics.TICK, Tick(epoch=EPOCH, robot_ns=0), 5 * MS)
    network.send(topics.CMD_VEL, command(None), 6 * MS)
    network.send(topics.CMD_VEL, command(0, epoch=EPOCH + 1), 7 * MS)
    assert telemetry.age_ms is None


def test_ages_do_not_grow_with_the_run() -> None:
    ages = AgeHistogram()
    for count in range(10_000):
        ages.add(20.0 + count % 10)
    assert len(ages._counts) == 10
    assert ages.quantile(0.5) == 24.0


def test_services_come_and_go() -> None:
    telemetry, _ = quiet()
    telemetry.on_liveliness("base", "one", present=True)
    telemetry.on_liveliness("base", "two", present=True)
    telemetry.on_liveliness("base", "one", present=False)
    assert telemetry.alive == {"base"}
    telemetry.on_liveliness("base", "two", present=False)
    assert telemetry.alive == frozenset()


def test_a_snapshot_knows_how_old_each_sample_is() -> None:
    snapshot = ten_seconds().snapshot(10 * SECOND + 1500 * MS)
    assert snapshot.tilt is not None
    assert snapshot.tilt.age == pytest.approx(1.5)
    assert not snapshot.tilt.fresh


def drive(comparison: Comparison, error_x: float = 0.0, error_yaw: float = 0.0, maker: str = "m") -> None:
    """Five seconds at 0.5 m/s, truth and odometry at different moments, the error growing evenly."""
    for ms in range(5001):
        if ms % 10 == 3:
            share = ms / 5000
            sample = odometry(ms * MS, 0.5e-3 * ms + error_x * share, 0.0, error_yaw * share)
            comparison.on_sample(stamped(sample, ms, 0, maker))
        if ms % 200 == 8:
            comparison.see(truth(ms * MS, x=0.5e-3 * ms))


@pytest.mark.parametrize(
    ("error", "distance", "angle"), [((0.0, 0.0), 0.0, 0.0), ((0.05, -0.02), 0.046, 0.0184)], ids=["none", "some"]
)
def test_odometry_is_compared_with_the_truth_at_the_same_moment_and_its_error_shows_as_it_is(
    error: tuple[float, float], distance: float, angle: float
) -> None:
    """The last that is compared is of 4.6 s."""
    comparison = Comparison()
    drive(comparison, *error)
    assert comparison.apart is not None
    assert comparison.apart.distance == pytest.approx(distance, abs=0.001 if distance else 1e-9)
    assert comparison.apart.angle == pytest.approx(angle, abs=0.0005 if angle else 1e-9)


@pytest.mark.parametrize(
    ("maker", "jumps", "at"), [("again", 0, (0.0, 0.0)), ("m", 1, (7.0, 3.0))], ids=["restarted", "set"]
)
def test_an_odometry_that_began_anew_or_was_set_is_compared_from_there(
    maker: str, jumps: int, at: tuple[float, float]
) -> None:
    comparison = Comparison()
    drive(comparison, error_x=0.05)
    for ms in range(5000, 6001):
        if ms % 10 == 0:
            sample = msgspec.structs.replace(odometry(ms * MS, at[0] + 0.5e-3 * (ms - 5000), at[1]), jumps=jumps)
            comparison.on_sample(stamped(sample, ms, 0, maker))
        if ms % 200 == 8:
            comparison.see(truth(ms * MS, x=0.5e-3 * ms))
    assert comparison.apart is not None
    assert comparison.apart.distance == pytest.approx(0.0, abs=1e-9)
    where = comparison.in_odom(truth(6000 * MS, x=3.0).pose)
    assert where == pytest.approx((at[0] + 0.5, at[1], 0.0), abs=0.01)


def test_an_odometry_that_fell_silent_is_not_compared() -> None:
    comparison = Comparison()
    drive(comparison)
    comparison.see(truth(6000 * MS, x=3.0))
    comparison.see(truth(6200 * MS, x=3.0))
    assert comparison.apart is None


@pytest.mark.parametrize("yaw", [0.0, 1.0, -3.0, math.pi])
def test_frames_of_poses_are_inverse_to_each_other(yaw: float) -> None:
    frame, pose = Pose(1.0, -2.0, yaw), Pose(0.3, 0.7, 2.9)
    back = pose.seen_from(frame).placed_in(frame)
    assert back == pytest.approx(pose)
    assert START.seen_from(START) == Pose(0.0, 0.0, 0.0)
