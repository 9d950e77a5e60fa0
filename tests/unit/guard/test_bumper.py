"""A bumper stops its way at once and holds it until the robot has moved away; it knows nothing of any other way."""

import msgspec
import pytest

from giraff_core.live import Live
from giraff_core.senses import Bumper, UnknownSensor
from giraff_guard.obstacles import Obstacles
from giraff_guard.policy import HEARD, numbers_unheard
from giraff_schemas.bumper import Bump
from tests.support import robots
from tests.unit.guard.senses import CONFIG, ROBOT, Senses, opened

BUMPED = msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"front": Bumper(index=0, way="forward")})


def bump(senses: Senses, *, pressed: bool, age: float = 0.0) -> bool:
    return senses.obstacles.on_sensed(Bump(sensor="front", pressed=pressed, tick=senses.ago(age)), senses.now)


def let_go() -> Senses:
    """At rest, and every sensor heard for so long that no way is held back."""
    senses = opened(BUMPED)
    drive_on(senses, 0.0, 0.6)
    return senses


@pytest.fixture
def driving() -> Senses:
    """Forward, with every sensor heard."""
    senses = let_go()
    assert senses.verdict().clearance == "free"
    senses.linear = 0.3
    senses.asked = (0.3, 0.0)
    senses.wait(0.04)
    return senses


def drive_on(senses: Senses, linear: float, seconds: float, *, pressed: bool = False, angular: float = 0.0) -> None:
    senses.linear, senses.angular = linear, angular
    for _ in range(round(seconds / 0.02)):
        senses.wait(0.02)
        bump(senses, pressed=pressed)
        senses.hear(None)
    senses.linear = senses.angular = 0.0


def test_a_push_stops_its_way_at_once_and_no_other(driving: Senses) -> None:
    assert bump(driving, pressed=True), "it cannot wait for the next decision"
    judged = driving.verdict()
    assert (judged.clearance, judged.sensor, judged.allowed) == ("blocked", "front", 0.0)
    assert judged.reason.what == "front is pushed: something touches it, or its wire is cut"
    assert judged.reason.remedy == "turn or back up"
    assert (driving.allowed("backward"), driving.allowed("turn_left")) == (0.6, ROBOT.max_angular_speed)
    assert driving.passes(0.5, 0.0) == (0.0, 0.0)


def test_its_way_stays_blocked_until_the_robot_has_backed_away(driving: Senses) -> None:
    drive_on(driving, 0.0, 0.1, pressed=True)
    drive_on(driving, 0.0, 0.3)
    assert "was pushed here" in str(driving.verdict().reason)
    drive_on(driving, 0.2, 0.9)  # pushed along by hand: nearer is not away
    drive_on(driving, -0.2, 1.8)
    assert driving.verdict().clearance == "blocked"
    drive_on(driving, -0.2, 0.2)
    assert driving.verdict().sensor != "front"


def test_turning_away_frees_it(driving: Senses) -> None:
    drive_on(driving, 0.0, 0.1, pressed=True)
    drive_on(driving, 0.0, 1.5, angular=1.0)
    assert driving.verdict().sensor == "front"
    drive_on(driving, 0.0, 0.1, angular=1.0)
    assert driving.verdict().sensor != "front"


def test_where_the_wheels_cannot_be_followed_it_has_to_back_away_anew(driving: Senses) -> None:
    drive_on(driving, 0.0, 0.1, pressed=True)
    drive_on(driving, -0.2, 0.9)
    driving.report(boot_id=2)
    drive_on(driving, -0.2, 0.2)
    assert driving.verdict().sensor == "front"


def test_what_was_only_asked_for_takes_the_robot_away_from_nothing(driving: Senses) -> None:
    """The wheels are not heard, and the robot stands."""
    drive_on(driving, 0.0, 0.1, pressed=True)
    driving.asked = (-0.3, 0.0)
    for _ in range(150):
        driving.wait(0.02, wheels=False)
        bump(driving, pressed=False)
        driving.hear(None)
    driving.asked = (0.0, 0.0)
    drive_on(driving, 0.0, 0.2)
    assert driving.verdict().sensor == "front"


def test_where_it_was_pushed_is_not_known_while_the_wheels_are_not_heard(driving: Senses) -> None:
    """The guard reckons on by what it has passed, and base has stopped the robot."""
    driving.linear = 0.0
    for step in range(100):
        driving.wait(0.02, wheels=False)
        bump(driving, pressed=step > 50)
        driving.hear(None)
    driving.asked = (0.0, 0.0)
    drive_on(driving, 0.0, 0.2)
    assert "was pushed here" in str(driving.verdict().reason)


def test_a_new_epoch_does_not_open_the_way(driving: Senses) -> None:
    drive_on(driving, 0.0, 0.1, pressed=True)
    drive_on(driving, 0.0, 0.1)
    driving.obstacles.forget()
    drive_on(driving, 0.0, 0.3)
    assert "was pushed here" in str(driving.verdict().reason)


def test_a_sample_of_another_type_under_its_name_says_nothing() -> None:
    senses = opened(BUMPED)
    bump(senses, pressed=False)
    before = senses.judge()
    wrong = Bump(sensor="rear", pressed=True, tick=senses.now)
    assert not senses.obstacles.on_sensed(wrong, senses.now)
    senses.hear(0.3, "front")
    assert senses.judge() == before


@pytest.mark.parametrize(("age", "why"), [(None, "has not been heard yet"), (0.45, "is stale (0.5 s old)")])
def test_one_that_is_not_heard_blocks_its_way(age: float | None, why: str) -> None:
    senses = opened(BUMPED)
    if age is not None:
        bump(senses, pressed=False, age=age)
    judged = senses.verdict()
    assert (judged.clearance, judged.sensor) == ("blocked", "front")
    assert why in judged.reason.what
    assert why in str(senses.troubles()["front"])
    assert senses.allowed("backward") == 0.6


def test_what_drives_its_way_relies_on_it() -> None:
    senses = opened(BUMPED)
    bump(senses, pressed=False, age=0.35)
    senses.judge()
    assert senses.limit(0.3).range_tick == senses.ago(0.35)
    assert senses.limit(-0.3).range_tick != senses.ago(0.35)
    unheard = opened(BUMPED).limit(0.3).range_tick
    assert unheard is not None
    assert unheard.robot_ns == 0


def test_a_sensor_of_a_type_that_nobody_knows_is_never_passed_over() -> None:
    robot = msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"nose": UnknownSensor(named="bumber")})
    with pytest.raises(ValueError, match=r"sensors.nose\] is of the type 'bumber', .* known are: bumper, camera, "):
        Obstacles(Live(CONFIG), robot)


def test_what_was_heard_is_numbered_by_type_and_then_by_name() -> None:
    robot = msgspec.structs.replace(ROBOT, sensors=dict(reversed(robots.BUMPED.sensors.items())))
    numbered = [f"sensor {name}" for name in ("front_left", "front_right", "rear", "back", "front")]
    assert list(numbers_unheard(robot)) == [*HEARD, *numbered]
