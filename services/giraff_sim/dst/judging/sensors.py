"""The ultrasonic sensors as the judge sees them: which way they look, and which have just sent a ping."""

from collections.abc import Iterator

from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_sim.world.sonar import Sonar
from giraff_sim.world.world import World


def looks_along(mount: Ultrasonic, way: float) -> bool:
    """`way`: above 0 forward, else backward."""
    return (abs(mount.yaw) < 1.0) == (way > 0.0)


class NewPings:
    """Asked after each step of the world."""

    def __init__(self, world: World, robot: RobotConfig) -> None:
        self._sonars = {name: world.sonars[mount.index] for name, mount in robot.of(Ultrasonic).items()}
        self._seen = {name: sonar.pings for name, sonar in self._sonars.items()}

    def pop_new(self) -> Iterator[tuple[str, Sonar]]:
        """The sensors that have sent a ping since this was asked last."""
        for name, sonar in self._sonars.items():
            if sonar.pings != self._seen[name]:
                self._seen[name] = sonar.pings
                yield name, sonar
