"""The ultrasonic sensors as one sense of the guard."""

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.senses.ultrasonic.facing import Facing
from giraff_guard.senses.ultrasonic.sensor import Sensor
from giraff_guard.source import Beam, Sight, Source
from giraff_schemas.messages import Range, RobotTime
from giraff_schemas.trouble import Trouble


class UltrasonicSource(Source):
    """All ultrasonic sensors of one robot."""

    sense, sees_ahead = Ultrasonic, True

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        super().__init__(live, robot)
        self._robot = robot
        self.forget()

    def forget(self) -> None:
        """Begin anew: nothing that was heard has a known age."""
        limits = Limits(self.live, self._robot)
        self._sensors = {name: Sensor(name, pose, self.live) for name, pose in self._robot.of(Ultrasonic).items()}
        sensors = list(self._sensors.values())
        self._facing = {way: Facing(way, limits, sensors) for way in SIGN}

    def on_sample(self, sample: Range, motion: RecentTravel, now: RobotTime) -> list[Beam]:
        """Take a reading. A good one is a beam."""
        sensor = self._sensors[sample.sensor]
        sensor.on_range(sample, motion, now)
        ping = sensor.newest
        if ping is None:
            return []
        beam = Beam(
            sensor=sensor.name,
            mount=sensor.mount,
            half_cone=sensor.half_cone,
            robot_ns=ping.robot_ns,
            place=ping.place,
            distance=ping.distance,
            is_echo=ping.echo,
            is_repeated=ping is sensor.heard,
            is_sure=ping is sensor.last_confirmed,
        )
        return [beam]

    def covers(self, way: DriveDirection) -> list[str]:
        """Return the sensors that look along a direction."""
        return [sensor.name for sensor in self._facing[way].sensors]

    def sight(self, sensor: str, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> Sight:
        """Return what a sensor tells of a direction."""
        return self._facing[way].sight(self._sensors[sensor], motion, now)

    def trouble(self, sensor: str, motion: RecentTravel, now: RobotTime) -> Trouble:
        """Return why a sensor does not count, or why its silence does not."""
        each = self._sensors[sensor]
        return each.blindness() or each.distrust(motion, now)
