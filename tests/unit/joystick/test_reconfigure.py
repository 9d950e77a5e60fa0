"""What is tightened while the joystick is held counts at once."""

import msgspec

from giraff_core.live import Live
from giraff_joystick.policy import JoystickPolicy
from giraff_schemas.messages import DriveCommand
from tests.support.operators import said
from tests.unit.joystick.frames import ANGLE, ROBOT, tilt_frame
from tests.unit.joystick.hands import MODAL_TREMOR, readings, tilted


def held(joystick: JoystickPolicy, begin: float, seconds: float, degrees: float) -> DriveCommand:
    """Hold it tilted forward from this moment; what is asked in the end."""
    now = begin
    for x, y, z in readings(lambda _: tilted(degrees), seconds, tremor=MODAL_TREMOR):
        now += 0.02
        joystick.on_frame(tilt_frame(x / 100, y / 100, z / 100, robot_ns=round(now * 1e9)), now)
    return said(joystick, now)


def test_a_wider_dead_zone() -> None:
    live = Live(ANGLE)
    joystick = JoystickPolicy(live, ROBOT, "me")
    assert held(joystick, 0.0, 1.0, 15.0).linear_x > 0.0
    live.replace(msgspec.structs.replace(ANGLE, dead_zone_deg=20.0))
    assert held(joystick, 1.0, 0.1, 15.0).neutral


def test_a_hand_that_must_move_more() -> None:
    live = Live(ANGLE)
    joystick = JoystickPolicy(live, ROBOT, "me")
    assert held(joystick, 0.0, 3.0, 30.0).source == "hand"
    live.replace(msgspec.structs.replace(ANGLE, stillness=0.5))
    command = held(joystick, 3.0, 0.1, 30.0)
    assert command.source == "fault"
    assert "nobody holds it" in str(command.reason)
