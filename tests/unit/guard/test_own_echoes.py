"""Whether a sensor hears its own pings, or those of another robot."""

import random

import pytest

from giraff_core.kinematics.pose import Pose
from giraff_guard.limits import DriveDirection
from giraff_guard.senses.ultrasonic.silence_trust import OwnEchoes, Ping
from tests.unit.guard.senses import CONFIG, CYCLE, SIDES, Senses


@pytest.mark.parametrize("way", SIDES)
@pytest.mark.parametrize(
    ("speed", "changes", "is_own"),
    [
        (0.4, 1.0, True),
        (-0.4, 1.0, True),
        (0.4, 0.95, True),  # a slanted wall
        (0.4, 0.0, False),  # a ping that comes at the same time after each of its own
        (0.4, 0.3, False),  # one that drifts
        (-0.4, 0.0, False),
        (0.14, 0.5, False),  # the pings of another robot ahead, which go one way alone
        (0.05, 0.0, False),  # too little way between two pings to tell
    ],
)
def test_only_echoes_that_follow_the_robots_motion_keep_a_trust(
    senses: Senses, speed: float, changes: float, is_own: bool, way: DriveDirection
) -> None:
    senses.linear = speed
    moved = speed * CYCLE * (1.0 if way == "forward" else -1.0)
    heard_at = 3.5 if moved * changes > 0.0 else 1.0
    for number in range(round(2.1 / abs(moved))):
        heard_at -= changes * moved + (0.002 if number % 2 else -0.002)
        senses.cycle(dict.fromkeys(SIDES[way], heard_at))
    trouble = senses.troubles()[SIDES[way][0]]
    assert (not trouble) == is_own, trouble
    assert is_own or senses.allowed(way) < CONFIG.untrusted_speed + 1e-9


def test_another_robots_pings_at_any_time_are_its_own_echoes_by_a_rare_chance_only() -> None:
    chance, own, proofs = random.Random(2), OwnEchoes(0.0), 0
    for number in range(3300):  # ten minutes at the speed of one that is not trusted
        heard_at = chance.uniform(0.02, 10.3)  # of 60 ms between two pings, 23 ms are within reach
        ping = Ping(number, min(4.0, heard_at), heard_at < 4.0, Pose(0.026 * number, 0.0, 0.0))
        proofs += own.on_ping(ping)
    assert proofs <= 2


def test_one_echo_that_agrees_may_be_another_robots() -> None:
    own = OwnEchoes(0.0)
    told = [own.on_ping(Ping(number, 2.0 - x, True, Pose(x, 0.0, 0.0))) for number, x in enumerate((0.0, 0.3, 0.6))]
    assert told == [False, False, True]
