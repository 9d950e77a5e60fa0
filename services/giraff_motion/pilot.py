"""Makes a goal of a request: within what the robot can do, and with what was learned of it."""

from typing import Final

from giraff_core.bounds import Bounds
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_motion.config import MotionConfig
from giraff_motion.driver import Coast, Rest
from giraff_motion.goal import Goal, Travel
from giraff_motion.legs import Limits
from giraff_motion.localized import Localized
from giraff_motion.route import Route
from giraff_schemas.messages import Odometry
from giraff_schemas.motion import MotionRequest, steps_of

_BEGINS: Final = 1.0
"""s until it is armed."""
_NOMINAL: Final = 2.0
"""Times what it takes when nothing is in its way, it may take."""
_LONGEST: Final = Bounds(0.1, 86_400.0, "s")


class Pilot:
    """Of one robot."""

    def __init__(self, live: Live[MotionConfig], robot: RobotConfig, localized: Localized) -> None:
        self._live, self._robot, self._localized = live, robot, localized
        self._coasts = {False: Coast(), True: Coast()}
        """Along the floor, and of turns."""

    def begin(self, request: MotionRequest, odometry: Odometry, now: float) -> Goal:
        """Raises ValueError, in plain words, where the request cannot be met."""
        floor, spot = self._limits(request)
        travel = Travel(self._robot, odometry)
        way = Route(steps_of(request), travel.start, floor, spot, self._localized)
        if request.time_limit is not None:
            _LONGEST.require("time_limit", request.time_limit)
        nominal = _BEGINS + sum(planned.seconds for planned in way.legs)
        limit = request.time_limit or min(_NOMINAL * nominal, _LONGEST.high)
        config = self._live.config
        rest = Rest(config.rest_speed, config.rest_turn_speed, config.rest_time)
        return Goal(request, way, travel, rest, self._coasts, config.patience, limit, now)

    def _limits(self, request: MotionRequest) -> tuple[Limits, Limits]:
        config, robot = self._live.config, self._robot
        speed, turn_speed = request.speed, request.turn_speed
        if speed is not None:
            Bounds(config.least_speed, robot.max_wheel_speed, "m/s").require("speed", speed)
        if turn_speed is not None:
            Bounds(config.least_turn_speed, robot.max_angular_speed, "rad/s").require("turn_speed", turn_speed)
        floor = Limits(
            top=min(speed or config.speed, robot.max_wheel_speed),
            least=config.least_speed,
            deceleration=config.deceleration,
            tolerance=config.position_tolerance,
        )
        spot = Limits(
            top=min(turn_speed or config.turn_speed, robot.max_angular_speed),
            least=config.least_turn_speed,
            deceleration=config.turn_deceleration,
            tolerance=config.heading_tolerance,
        )
        return floor, spot
