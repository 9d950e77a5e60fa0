"""A script as an operator: what it says in which order, and what makes it give up."""

import pytest

from giraff_client import (
    EmergencyStopError,
    LostRobotError,
    NoRobotError,
    NotArmedError,
    RefusedError,
    RobotError,
    TakenError,
)
from giraff_client.policy import OperatorPolicy
from giraff_core.operator import LINK_SILENCE
from giraff_schemas.messages import DriveCommand, Lease, Tick
from giraff_schemas.trouble import Trouble
from tests.unit.cli import samples

ME, EPOCH, COUNTER = "me", 7, 41


class Script:
    """A policy, its clock, and a robot that says what the test lets it say."""

    def __init__(self) -> None:
        self.policy = OperatorPolicy("script", ME)
        self.now = 100.0
        self._seq = 0
        self.tick()
        self.policy.on_sample(samples.estop(), self.now)

    def tick(self) -> None:
        self.policy.on_sample(Tick(epoch=EPOCH, robot_ns=round(self.now * 1e9)), self.now)

    def wait(self, seconds: float, *, ticks: bool = True) -> None:
        self.now += seconds
        if ticks:
            self.tick()

    def lease(self, holder: str, operator: str) -> None:
        self._seq += 1
        counter = COUNTER if holder else 0
        lease = Lease(
            seq=self._seq, holder=holder, operator=operator, counter=counter, reason=Trouble(f"held by {operator}")
        )
        self.policy.on_sample(lease, self.now)

    def base(self, *, armed: bool) -> None:
        self.policy.on_sample(samples.base(armed=armed, reason="" if armed else "not armed since a shout"), self.now)

    def step(self) -> DriveCommand | None:
        return self.policy.step(self.now)

    def arm(self) -> None:
        self.policy.begin(self.now)
        self.lease(ME, "script")
        assert self.step() is not None
        self.wait(0.4)
        self.base(armed=True)
        assert self.step() is None

    def drive(self) -> DriveCommand:
        return self.policy.drive(0.2, 0.1, self.now)


@pytest.fixture
def script() -> Script:
    return Script()


def test_it_asks_then_holds_still_then_drives(script: Script) -> None:
    script.policy.begin(script.now)
    asking = script.step()
    assert asking is not None
    assert (asking.lease_counter, asking.source, asking.neutral) == (0, "hand", False)
    script.lease(ME, "script")
    for _ in range(8):
        still = script.step()
        assert still is not None
        assert (still.lease_counter, still.source, still.neutral) == (COUNTER, "hand", True)
        script.base(armed=True)  # of the operator before: it was armed, and will not stay so under the new lease
        script.wait(1 / 30)
    script.wait(0.1)
    script.base(armed=True)
    assert script.step() is None
    command = script.drive()
    assert (command.linear_x, command.angular_z, command.lease_counter, command.operator) == (
        0.2,
        0.1,
        COUNTER,
        "script",
    )


def test_a_command_has_the_robots_time_of_its_call(script: Script) -> None:
    script.arm()
    first = script.drive()
    script.wait(0.3, ticks=False)
    assert script.drive().tick == first.tick
    script.wait(0.0)
    newest = script.drive().tick
    assert newest is not None
    assert newest.robot_ns == round(script.now * 1e9)


def test_who_drives_is_named(script: Script) -> None:
    script.lease("another", "joystick")
    script.policy.begin(script.now)
    assert script.step() is not None  # a higher priority would be given it
    script.wait(0.6)
    with pytest.raises(TakenError, match="held by joystick") as taken:
        script.step()
    assert taken.value.holder == "joystick"


def test_a_motions_lease_is_waited_for(script: Script) -> None:
    """It ends a second after the motion, and a script takes the robot from none: a script that moves drives next."""
    script.lease("motion's", "motion")
    script.policy.begin(script.now)
    script.wait(1.3)
    assert script.step() is not None
    assert isinstance(script.policy.gave_up(), TakenError)
    script.lease(ME, "script")
    assert script.step() is not None


def test_a_robot_that_another_takes_is_told_from_one_that_nobody_drives(script: Script) -> None:
    script.arm()
    script.lease("another", "joystick")
    with pytest.raises(TakenError, match=r"held by joystick; call robot\.arm") as taken:
        script.drive()
    assert taken.value.holder == "joystick"
    script.lease("", "")
    with pytest.raises(RefusedError) as ended:
        script.drive()
    assert type(ended.value) is RefusedError
    assert ended.value.holder == ""


def test_what_was_lost_is_not_taken_up_again(script: Script) -> None:
    script.arm()
    script.base(armed=False)
    with pytest.raises(NotArmedError, match=r"since a shout; call robot\.arm"):
        script.drive()
    script.base(armed=True)
    script.lease("", "")
    with pytest.raises(RefusedError, match=r"robot\.arm"):
        script.drive()


def test_an_emergency_stop_stops_it_at_each_step(script: Script) -> None:
    script.arm()
    script.policy.on_sample(samples.estop(engaged=True), script.now)
    for act in (script.drive, script.step):
        with pytest.raises(EmergencyStopError, match="giraff estop reset"):
            act()


def test_a_robot_that_is_silent_is_lost(script: Script) -> None:
    script.arm()
    script.wait(LINK_SILENCE + 0.1, ticks=False)
    for act in (script.drive, script.step):
        with pytest.raises(LostRobotError, match="no tick of the robot"):
            act()
    assert isinstance(script.policy.lost(script.now), LostRobotError)
    script.wait(0.0)
    assert script.policy.lost(script.now) is None


def test_its_last_word_disarms_and_names_why(script: Script) -> None:
    script.arm()
    last = script.policy.final_command()
    assert (last.source, last.neutral, last.lease_counter) == ("fault", True, COUNTER)
    assert "script service has ended" in str(last.reason)


def test_it_says_why_it_was_not_armed_in_time(script: Script) -> None:
    script.policy.begin(script.now)
    assert type(script.policy.gave_up()) is RefusedError
    script.lease("another", "joystick")
    assert isinstance(script.policy.gave_up(), TakenError)
    script.lease(ME, "script")
    assert "base is not heard" in str(script.policy.gave_up())
    script.base(armed=False)
    assert "not armed since a shout" in str(script.policy.gave_up())


def test_what_catches_the_older_kind_catches_the_newer() -> None:
    assert issubclass(LostRobotError, NoRobotError)
    assert issubclass(TakenError, RefusedError)
    assert issubclass(RefusedError, RobotError)
