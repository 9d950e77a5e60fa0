"""The ultrasonic sensors as one sense of the guard."""

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_guard.limits import DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.ultrasonic.direction import UltrasonicDirection
from giraff_guard.ultrasonic.memory import Echoes
from giraff_guard.ultrasonic.sensor import Sensor
from giraff_schemas.messages import DirectionLimit, Range, RobotTime
from giraff_schemas.trouble import Trouble


class UltrasonicSource:
    """All ultrasonic sensors of one robot: a `Source`."""

    takes = Range

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        self._live, self._robot = live, robot
        self._largest = robot.max_angular_speed
        self.forget()

    def forget(self) -> None:
        """Begin anew: nothing that was heard has a known age."""
        live, robot = self._live, self._robot
        limits = Limits(live, robot)
        self.names = {name: Sensor(name, pose, live) for name, pose in robot.of(Ultrasonic).items()}
        self._echoes = Echoes(limits)
        sensors = list(self.names.values())
        self._directions: dict[DriveDirection, UltrasonicDirection] = {
            "forward": UltrasonicDirection("forward", limits, sensors),
            "backward": UltrasonicDirection("backward", limits, sensors),
        }

    def on_sample(self, sample: Range, motion: RecentTravel, now: RobotTime) -> None:
        """A reading."""
        sensor = self.names[sample.sensor]
        sensor.on_range(sample, motion, now)
        for way in self._directions.values():
            way.on_reading(sensor)
        if sensor.newest is not None and motion.heard:
            self._echoes.on_ping(sensor, sensor.newest, motion.travel)

    def lose_place(self) -> None:
        """Nobody knows where the echoes are now."""
        self._echoes.clear()

    def straight(self, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> DirectionLimit:
        """What is heard, remembered, and no longer heard allows so much."""
        self._echoes.forget(now.robot_ns, motion.travel)
        return self._directions[way].judge(motion, self._echoes, now)

    def curve(
        self, way: DriveDirection, curvature: float, motion: RecentTravel, now: RobotTime
    ) -> tuple[float, Trouble] | None:
        """What is remembered allows so much: no sensor looks along a curve."""
        return self._echoes.curve(motion.place, way, now.robot_ns, curvature)

    def room(self, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> float:
        """What this way's sensors hear now, and what is remembered there."""
        return self._directions[way].room(motion, self._echoes, now)

    def turn(self, motion: RecentTravel) -> DirectionLimit | None:
        """Turning in place sweeps nothing beyond the footprint's disc; what touches that is turned past slowly."""
        creep = self._live.config.creep_angular
        sensor = self._echoes.touching(motion.place)
        if not sensor or creep >= self._largest:
            return None
        reason = f"{sensor} has heard something that touches the robot's side"
        return DirectionLimit(allowed=creep, clearance="creep", sensor=sensor, reason=Trouble(reason))

    def relied_on(self, way: DriveDirection, now: RobotTime) -> RobotTime | None:
        """The oldest of the newest readings of this way's sensors."""
        return self._directions[way].relied_on(now)

    def troubles(self, motion: RecentTravel, now: RobotTime) -> dict[str, Trouble]:
        """By sensor: why it does not count, or why its silence does not."""
        return {name: sensor.blindness(now) or sensor.distrust(motion, now) for name, sensor in self.names.items()}

    def freer_side(self, way: DriveDirection) -> str:
        """Where they see farther."""
        return self._directions[way].freer_side()
