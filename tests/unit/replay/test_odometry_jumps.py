"""A recording in which the pose of odometry was set: nobody recorded by whom and to what."""

from collections.abc import Callable, Mapping

import msgspec
import pytest

from giraff_cli.replay.agreement import Agreement
from giraff_cli.replay.policies import RecordedSamples, replay_odometry
from giraff_core.kinematics.calibration import Calibration
from giraff_core.live import Live
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.codec import stamped
from giraff_schemas.requests import OdomReset, OdomSetPose
from tests.unit.odometry.robots import PERIOD_US, ROBOT, wheels

UNSURE = msgspec.structs.replace(ROBOT, calibration=Calibration())
"""Nobody has calibrated it."""
Wish = Callable[[OdometryPolicy], object]
SAMPLES = 400


def replayed(
    wishes: Mapping[int, Wish], *, from_: int = 0, drift: float = 1.0, field: str = "x", turning: int = 0
) -> Agreement:
    """Four seconds of a bend, in which somebody wishes something after so many samples.

    Recorded from the sample `from_` on. `drift`: of what odometry said, `field` is larger by this factor. For the
    first `turning` samples the robot turns on the spot, and shakes.
    """
    odometry, said = OdometryPolicy(Live(OdometryConfig()), UNSURE), RecordedSamples()
    for step in range(SAMPLES):
        on = max(0, step - turning)
        turned, shaken = 5 * min(step, turning), 6 * (step % 2)
        heard = wheels(10 * on - turned - shaken, 14 * on + turned, step * PERIOD_US)
        told = odometry.on_wheels(heard)
        assert told is not None
        if step >= from_:
            said.add(stamped(heard, step, step * 10, "base-1"))
            drifted = msgspec.structs.replace(told, **{field: getattr(told, field) * drift})
            said.add(stamped(drifted, step, step * 10 + 1, "odometry-1"))
        if wish := wishes.get(step):
            wish(odometry)
    return replay_odometry(said, OdometryConfig(), UNSURE)


def reset(odometry: OdometryPolicy) -> None:
    odometry.on_reset(OdomReset(by="ann", id=odometry.jumps + 1000))


def there(odometry: OdometryPolicy) -> None:
    odometry.on_set_pose(OdomSetPose(by="ann", id=odometry.jumps + 1000, x=3.0, y=4.0, yaw=2.0, position_sd=0.1))


def both(odometry: OdometryPolicy) -> None:
    reset(odometry)
    there(odometry)


@pytest.mark.parametrize(
    ("wishes", "left_out"),
    [
        ({}, 1),
        ({100: reset}, 1),
        ({100: there}, 2),
        ({100: both}, 2),
        ({100: there, 200: reset, 300: there}, 3),
    ],
)
@pytest.mark.parametrize("from_", [0, 50])
def test_it_goes_on_behind_each_jump(wishes: dict[int, Wish], left_out: int, from_: int) -> None:
    found = replayed(wishes, from_=from_)
    assert found.first == ""
    assert (found.equal, found.compared, found.left_out) == (SAMPLES - from_ - left_out,) * 2 + (left_out,)


@pytest.mark.parametrize("from_", [0, 50, 53])
def test_a_path_is_known_once_it_grows(from_: int) -> None:
    """A recording that begins amid the shaking of a turn does not say how far back the robot was."""
    found = replayed({}, from_=from_, turning=100)
    assert (found.first, found.equal) == ("", SAMPLES - from_ - 1)


def test_what_could_not_be_followed_before_the_recording_is_no_difference() -> None:
    def lose(odometry: OdometryPolicy) -> None:
        odometry.breaks += 1

    assert replayed({20: lose}, from_=50).first == ""


@pytest.mark.parametrize("field", ["x", "path"])
def test_what_is_otherwise_shows_behind_a_jump_too(field: str) -> None:
    assert replayed({100: reset}, drift=1.01, field=field).share < 0.1
