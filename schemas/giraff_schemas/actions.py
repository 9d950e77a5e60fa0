"""Steps that a person takes, and the words of each screen for them."""

from collections.abc import Mapping
from typing import Final, Literal

Action = Literal["", "hold_level", "ask", "take", "start", "release", "run"]
"""A step that a remedy ends with. Empty: it ends with none.

`hold_level` arms the robot, `ask` and `take` get the lease, `start` brings an operator, `release` ends the emergency
stop, `run` is a command at the robot's computer.
"""
ActionWords = Mapping[Action, str]
"""Words for each action. `{}` stands for its argument."""

RESET_COMMAND: Final = "giraff estop reset"
_RUN: Final = "run `{}`"
_SCRIPT: Final = "call robot.arm()"
_KEYS: Final = "press an arrow key or c to ask, then let go of all keys to arm"
_TILT: Final = "tilt the hand to ask, then hold it level to arm"
_PAGE: Final = "begin to drive on the page, which says how to arm"
_ROS: Final = "publish a speed on cmd_vel to ask, then zero speeds to arm"

ANY: Final[ActionWords] = {
    "hold_level": "hold the hand level for {}",
    "ask": "tilt or press a key to ask, then hold level with no key pressed to arm",
    "take": "tilt or press a drive key to take it, then hold level with no key pressed to arm",
    "start": "start giraff drive or giraff_joystick",
    "release": f"{_RUN.format(RESET_COMMAND)} to release it",
    "run": _RUN,
}
"""Words for a reader whose hand is not known."""
KEYS: Final[ActionWords] = {
    "hold_level": "let go of all keys for {}",
    "ask": _KEYS,
    "take": "press an arrow key to take it, then let go of all keys to arm",
    "start": _KEYS,
    "release": "press r to release it",
    "run": _RUN,
}
TILT: Final[ActionWords] = {
    **ANY,
    "ask": _TILT,
    "take": "tilt the hand to take it, then hold it level to arm",
    "start": _TILT,
}
PAGE: Final[ActionWords] = {
    **ANY,
    "hold_level": "hold the page's control still for {}",
    "ask": _PAGE,
    "take": "begin to drive on the page to take it; the page says how to arm",
    "start": _PAGE,
    "release": "tap Release on the page",
}
SCRIPT: Final[ActionWords] = {
    **ANY,
    "hold_level": _SCRIPT,
    "ask": _SCRIPT,
    "take": _SCRIPT,
    "start": _SCRIPT,
    "release": f"{_RUN.format(RESET_COMMAND)} to release it, and {_SCRIPT}",
}
ROS: Final[ActionWords] = {
    **ANY,
    "hold_level": "publish zero speeds on cmd_vel for {}",
    "ask": _ROS,
    "take": _ROS,
    "start": _ROS,
}
BY_OPERATOR: Final[Mapping[str, ActionWords]] = {
    "joystick": TILT,
    "keyboard": KEYS,
    "ros2": ROS,
    "script": SCRIPT,
    "web": PAGE,
}
"""Words of the hand that drives, by the name of its operator. Any other operator is told the words of ANY."""
