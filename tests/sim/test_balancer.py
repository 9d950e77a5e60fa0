"""A robot that balances stands, is pushed, sits down and stops. tests/campaign/test_balancer.py has the drawn ones."""

import msgspec
import pytest

from giraff_schemas.wires.balancer import BalanceCause, BalancePosture
from tests.support.balancer import Balancer
from tests.support.balancer_file import DRIVE
from tests.support.balancing import prototype_pushed, pushed, sensor_at, side_of, stopped, then


@pytest.mark.parametrize("seed", [0, 1])
def test_it_stands_comes_back_a_little_from_a_push_and_sits_down(seed: int) -> None:
    robot, side = Balancer(seed), side_of(seed)
    robot.stand(3.5)  # 5 s with those in which it is held
    stands = then(robot, 5.0, lambda _: None, side)
    assert stands["sd"] < 1.1
    assert stands["span"] < 0.08
    push = pushed(robot, 5.0, 4.0, side)
    assert push["lean"] < 6.5
    assert 0.05 < push["away"] < 0.32
    assert push["back"] < 0.10
    assert push["back_speed"] < 0.14
    assert robot.stands
    sits = then(robot, 2.0, lambda each: each.sit(side), side)
    assert sits["off"] < 0.7
    assert sits["span"] < 0.10
    assert sits["right_side"] == 1.0
    assert robot.posture is BalancePosture.OFF
    assert robot.plant.falls == 1
    assert sits["top"] < 1.2
    assert robot.late == 0
    robot.close()


def test_an_emergency_stop_ends_driving_and_it_stands() -> None:
    stop = stopped(0.3, by_silence=False, settle=1.2, after=2.3)(1)
    assert stop["up"] == 1.0
    assert 0.10 < stop["away"] < 0.26
    assert stop["back"] < 0.09
    assert stop["back_speed"] < 0.11
    assert stop["last_speed"] < 0.02, "it is asked to drive and must not"
    assert stop["active_before"] > 0.0
    assert stop["active"] == 0.0, "it is in its safe state 3 s later"


def test_a_stop_of_the_guard_in_the_middle_of_a_start_takes_no_more_than_its_run_on() -> None:
    stop = stopped(0.4, by_zero=True, settle=1.2, after=0.8)(1)
    assert stop["up"] == 1.0
    assert stop["run_on"] < 0.10
    assert stop["back"] < 0.09


def test_the_prototype_without_encoders_stands_and_drifts_as_it_is_pushed() -> None:
    push = prototype_pushed(1, settle=0.6)
    assert push["up"] == 1.0
    assert push["gone"] > 0.25


def test_new_gains_leave_it_standing_and_a_gyroscope_at_its_rail_turns_it_off() -> None:
    robot = Balancer(1)
    robot.stand(2.0)
    postures: set[BalancePosture] = set()
    robot.before_each_ms = lambda: postures.add(robot.posture)
    for k1 in (1200.0, DRIVE.k1):
        robot.drive_config = msgspec.structs.replace(DRIVE, k1=k1)
        robot.session += 1
        tuned = then(robot, 0.75, lambda _: None, 1.0)
        assert tuned["span"] < 0.08
        assert robot.report is not None
        assert robot.report.session == robot.session
    assert postures == {BalancePosture.STANDS}
    robot.before_each_ms = lambda: None
    figures = then(robot, 1.0, sensor_at(0.0, 0), 1.0)
    assert figures["off"] <= 0.02
    assert robot.causes == [BalanceCause.GYROSCOPE]
    robot.close()
