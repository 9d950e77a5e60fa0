"""What a judge must know of two wheels: their frames, their motors' pins, and which way these drive the robot."""

from typing import Final

from giraff_base.config import BaseConfig
from giraff_core.robot import RobotConfig
from giraff_schemas.wire import DriveFrame, Frame, SpeedFrame
from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.bodies.wheels.pins import Pins, WheelRequest
from giraff_sim.world.body import BoundedMotion, Demand

_CREEPING_COUNTS: Final = 4  # of both motors: less is what rounding leaves of a turn in place
_CREEPING: Final = 0.02  # m/s


class WheelsJudge:
    """Implements `giraff_sim.world.body.BodyJudge`."""

    def __init__(self, body: WheelsBody, robot: RobotConfig, config: BaseConfig, outlives_us: int) -> None:
        """`outlives_us`: for so long a frame may have effect."""
        self._body = body
        self._robot, self._drive = robot, body.drive
        self._pins = Pins(body, robot, config, outlives_us)

    def asked(self, frame: Frame, now_us: int) -> Demand | None:
        if not isinstance(frame, DriveFrame | SpeedFrame):
            return None
        asked = WheelRequest.by(frame, self._robot, self._drive)
        self._pins.asked(asked, now_us)
        track_width = self._robot.kinematics.track_width
        return Demand(
            text=str(asked),
            boot_id=frame.boot_id,
            is_nothing=asked.left == asked.right == 0.0,
            linear=(asked.left + asked.right) / 2.0,
            angular=(asked.right - asked.left) / track_width,
            linear_off=asked.off,
            angular_off=2.0 * asked.off / track_width,
        )

    def note(self, now_us: int) -> None:
        self._pins.note(now_us)

    def wrong(self, now_us: int) -> str:
        return self._pins.judge(now_us)

    def goes(self, way: BoundedMotion) -> bool:
        if way == "any":
            return True
        counts = sum(self._body.drives)
        plant = self._body.plant
        # An encoder that slips makes its wheel turn faster, and a turn in place travel by what is not counted.
        uncounted = (each.speed - each.counted_speed for each in (plant.left, plant.right))
        speed = plant.speed - sum(uncounted) / 2.0
        # Where the board holds speeds, it gives unlike motors unlike power to turn in place.
        if self._drive.asks_for_speeds and not (abs(speed) > _CREEPING and counts * speed > 0.0):
            return False  # no power keeps the middle going: it turns, or what it had is slowed down
        if way == "forward":
            return counts > _CREEPING_COUNTS
        if way == "backward":
            return counts < -_CREEPING_COUNTS
        return abs(counts) > _CREEPING_COUNTS
