"""Whose samples count: one base, one ranger a sensor, and nothing that a dead one said."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_guard.config import GuardConfig
from giraff_guard.identity import Identity
from giraff_schemas.messages import Range, RobotTime, Tick, Wheels
from tests.support import robots

SENSOR = "front_left"


class Air:
    """What is said on the network, in robot time."""

    def __init__(self) -> None:
        self.identity = Identity(GuardConfig(), robots.ROBOT)
        self.robot_ns = 10**12
        self._seq = 0

    def wait(self, seconds: float) -> None:
        self.robot_ns += round(seconds * 1e9)

    def ago(self, seconds: float, epoch: int = 1) -> RobotTime:
        return RobotTime(epoch=epoch, robot_ns=self.robot_ns - round(seconds * 1e9))

    def tick(self, number: int = 1, age: float = 0.0, seq: int | None = None) -> bool:
        """A tick of the base `number`, in its epoch of the same number."""
        time = self.ago(age, number)
        tick = Tick(seq=self._next(seq), instance=f"base-{number}", epoch=number, robot_ns=time.robot_ns)
        return self.identity.on_tick(tick, self.robot_ns)

    def echo(
        self, number: int = 1, age: float = 0.05, seq: int | None = None, sensor: str = SENSOR, epoch: int = 1
    ) -> bool:
        """A reading of the ranger `number`."""
        reading = Range(
            seq=self._next(seq),
            instance=f"ranger-{number}",
            sensor=sensor,
            state="clear",
            range=None,
            echo_us=0,
            tick=self.ago(age, epoch) if age >= 0.0 else None,
        )
        return self.identity.admits_sensed(reading, self.robot_ns)

    def wheels(self, number: int = 1, age: float = 0.0, seq: int | None = None, epoch: int = 1) -> bool:
        """A report of the wheels of the base `number`."""
        report = Wheels(
            seq=self._next(seq),
            instance=f"base-{number}",
            left_ticks=0,
            right_ticks=0,
            left_velocity=0.0,
            right_velocity=0.0,
            left_pwm_counts=0,
            right_pwm_counts=0,
            board_us=0,
            boot_id=1,
            tick=self.ago(age, epoch),
        )
        return self.identity.admits_report(report, self.robot_ns)

    @property
    def fault(self) -> str:
        return str(self.identity.fault(self.robot_ns))

    @property
    def base_fault(self) -> str:
        return str(self.identity.base_fault(self.robot_ns))

    def _next(self, seq: int | None) -> int:
        self._seq += 1
        return self._seq if seq is None else seq


@pytest.fixture
def air() -> Air:
    """Base 1 and ranger 1 have been heard."""
    air = Air()
    assert air.tick()
    assert air.echo()
    return air


def test_before_base_is_heard_there_is_no_moment() -> None:
    air = Air()
    assert air.identity.tick is None
    assert air.identity.now(air.robot_ns).epoch == 0
    assert "start giraff_base" in air.base_fault
    assert not air.echo()
    assert not air.wheels()


def test_a_base_of_another_machines_clock_is_named() -> None:
    for age in (-5.0, 5.0):
        air = Air()
        assert not air.tick(age=age)
        assert air.identity.tick is None
        assert "run giraff_guard on base's machine" in air.base_fault
        assert air.fault == ""


def test_a_second_base_is_named_and_not_listened_to(air: Air) -> None:
    for _ in range(100):
        air.wait(0.02)
        air.tick(1)
        assert not air.tick(2)
        assert air.fault == "a second base, base-2/2, speaks beside base-1/1; end one of the two"
        assert air.identity.tick == air.ago(0.0)
        assert air.base_fault == ""


def test_the_fault_of_a_second_base_ends_when_it_is_gone(air: Air) -> None:
    air.tick(2)
    for _ in range(26):
        assert air.fault
        air.wait(0.02)
        air.tick(1)
    assert air.fault == ""


@pytest.mark.parametrize(("silence", "bound"), [(0.3, False), (0.5, False), (0.5 + 1e-9, True), (3.0, True)])
def test_a_restarted_base_is_bound_once_the_old_one_is_silent(air: Air, silence: float, bound: bool) -> None:
    assert air.wheels(seq=100)
    air.wait(silence)
    assert air.tick(2) is bound
    assert air.identity.now(air.robot_ns).epoch == (2 if bound else 1)
    assert ("took the place of" if bound else "a second base") in air.fault
    if bound:
        assert air.wheels(2, epoch=2, seq=0)
        assert not air.wheels(1)
        assert not air.echo()  # of the old epoch
        air.wait(0.51)
        air.tick(2)
        assert air.fault == ""


@pytest.mark.parametrize("age", [0.51, 1.0, 8.0, 60.0, -1.0])
def test_a_late_tick_of_a_dead_base_does_nothing(air: Air, age: float) -> None:
    assert not air.tick(2, age=age)
    assert air.fault == ""
    air.wait(0.6)  # and it does not take the place of a silent one
    assert not air.tick(2, age=age)
    assert air.identity.now(air.robot_ns).epoch == 1


def test_late_ticks_do_not_keep_a_dead_base_alive(air: Air) -> None:
    for _ in range(30):
        air.wait(0.02)
        air.tick(1, age=0.6)
    assert air.tick(2)


@pytest.mark.parametrize("age", [0.1, -0.1, 1.0])
def test_a_tick_that_jumps_makes_nothing_fresher(air: Air, age: float) -> None:
    air.wait(0.02)
    air.tick()
    held = air.identity.tick
    air.tick(age=age)
    assert air.identity.tick == held


def test_a_repeated_or_reordered_tick_is_not_taken(air: Air) -> None:
    air.tick(seq=100)
    held = air.identity.tick
    air.wait(0.02)
    for seq in (100, 99, 0):
        air.tick(seq=seq)
        assert air.identity.tick == held
    air.tick(seq=101)
    assert air.identity.tick == air.ago(0.0)


def test_a_base_that_falls_silent_is_not_believed_to_be_there(air: Air) -> None:
    air.wait(0.5)
    assert air.base_fault == ""
    air.wait(1e-9)
    assert "base is not heard" in air.base_fault


def test_wheels_are_the_bound_bases_and_newer(air: Air) -> None:
    assert air.wheels(seq=10)
    assert not air.wheels(seq=10)
    assert not air.wheels(seq=9)
    assert not air.wheels(2, seq=11)
    assert not air.wheels(seq=11, age=0.6)
    assert not air.wheels(seq=11, epoch=2)
    assert air.wheels(seq=11)


def test_a_second_ranger_is_named_and_not_listened_to(air: Air) -> None:
    for _ in range(20):
        air.wait(0.18)
        assert air.echo(1)
        assert not air.echo(2)
        assert air.fault == "a second ranger for front_left, ranger-2, speaks beside ranger-1; end one of the two"
        assert str(air.identity.sensor_faults(air.robot_ns)[SENSOR]) == air.fault
    for _ in range(3):
        air.wait(0.18)
        air.tick()
        air.echo(1)
    assert air.fault == ""


@pytest.mark.parametrize(("silence", "bound"), [(0.3, False), (0.5, False), (0.5 + 1e-9, True)])
def test_a_restarted_ranger_is_bound_once_the_old_one_is_silent_and_disarms(
    air: Air, silence: float, bound: bool
) -> None:
    air.wait(silence)
    air.tick()
    assert air.echo(2) is bound
    assert ("took the place of ranger-1; hold the hand level" if bound else "a second ranger") in air.fault
    air.wait(0.1)
    assert air.echo(1) is not bound
    air.wait(0.1)
    assert air.echo(2) is bound


@pytest.mark.parametrize("age", [0.51, 1.0, 8.0, 60.0, -1.0])
def test_a_late_reading_of_a_dead_ranger_does_nothing(air: Air, age: float) -> None:
    assert not air.echo(2, age=age)
    assert air.fault == ""


def test_late_readings_do_not_keep_a_dead_ranger_alive(air: Air) -> None:
    for _ in range(6):
        air.wait(0.1)
        air.tick()
        assert not air.echo(1, age=0.6)
    assert air.echo(2)


@pytest.mark.parametrize("seq", [9, 10, 0])
def test_an_older_reading_does_not_count(air: Air, seq: int) -> None:
    assert air.echo(seq=10)
    assert not air.echo(seq=seq)
    assert air.echo(seq=11)


def test_a_late_reading_with_a_high_number_does_not_shut_out_the_next(air: Air) -> None:
    assert not air.echo(seq=10_000, age=2.0)
    assert air.echo(seq=11)


def test_a_sensor_that_the_robot_file_does_not_know_is_nobodys(air: Air) -> None:
    for number in range(1000):
        assert not air.echo(number, sensor=f"invented-{number}")
    assert air.fault == ""
    assert air.identity.sensor_faults(air.robot_ns) == {}


def test_readings_without_a_fresh_moment_are_named(air: Air) -> None:
    assert air.identity.sensor_faults(air.robot_ns) == {}
    air.echo(age=-1.0)  # beside one that is fresh
    assert air.identity.sensor_faults(air.robot_ns) == {}
    for _ in range(6):
        air.wait(0.1)
        air.tick()
        air.echo(age=-1.0)
    assert "check that it hears base" in str(air.identity.sensor_faults(air.robot_ns)[SENSOR])


@given(
    story=st.lists(
        st.tuples(
            st.integers(1, 3),
            st.sampled_from([0.0, 0.02, 0.3, 0.499, 0.6, 8.0, -0.2]),
            st.integers(0, 30),
            st.sampled_from([0.0, 0.02, 0.1, 0.4, 0.6]),
        ),
        max_size=40,
    )
)
def test_the_moment_never_runs_ahead_nor_back_within_an_epoch(story: list[tuple[int, float, int, float]]) -> None:
    air = Air()
    for number, age, seq, pause in story:
        air.wait(pause)
        before = air.identity.tick
        another = air.tick(number, age=age, seq=seq)
        after = air.identity.tick
        if after is None:
            continue
        assert after.robot_ns <= air.robot_ns
        if before is None or after.epoch != before.epoch:
            assert another
        else:
            assert after.robot_ns >= before.robot_ns
