"""What the table [joystick] may say."""

import math

import msgspec
import pytest

from giraff_joystick.config import JoystickConfig


def test_the_defaults_are_valid() -> None:
    assert msgspec.convert({}, JoystickConfig) == JoystickConfig()


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"port": ""}, "port is empty"),
        ({"operator": "a/b"}, "cannot be part of a key"),
        ({"curve": "square"}, "Invalid enum value 'square'"),
        ({"dead_zone_deg": 0.0}, "dead_zone_deg is 0.0"),
        ({"dead_zone_deg": 40.0}, "dead_zone_deg is 40.0"),
        ({"dead_zone_deg": math.nan}, "dead_zone_deg is nan"),
        ({"full_tilt_deg": 91.0}, "full_tilt_deg 91.0"),
        ({"full_tilt_deg": math.inf}, "full_tilt_deg inf"),
        ({"stillness": 0.0}, "stillness is 0: it must be within"),
        ({"stillness": math.nan}, "stillness is nan"),
        ({"mount_yaw": 90.0}, "mount_yaw is 90: it must be within"),
        ({"mount_roll": math.nan}, "mount_roll is nan"),
        ({"ports": "/dev/x"}, "unknown field `ports`"),
    ],
)
def test_a_senseless_value_is_refused_in_clear_words(table: dict[str, object], words: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=words):
        msgspec.convert(table, JoystickConfig)


def test_what_a_robot_file_leaves_out_is_what_hands_were_tried_with() -> None:
    """docs/operator.md has the figures that stand on them."""
    default = JoystickConfig()
    assert (default.curve, default.dead_zone_deg, default.full_tilt_deg) == ("angle", 8.0, 35.0)
    assert default.stillness == 0.045
