"""The ranger: ultrasonic pings to `range/<sensor>`, switches to `bumper/<name>`."""

from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_core.senses import Bumper, Ultrasonic
from giraff_ranger.config import RangerConfig
from giraff_ranger.policy import RangerPolicy
from giraff_schemas.topics import BUMPER, RANGE, TICK
from giraff_schemas.wire import RangeFrame
from giraff_schemas.wires.bumper import BumperFrame


class Ranger:
    """Reads the ranger board and `tick`, which it hands down to the board; writes `range/<sensor>`
    and `bumper/<name>`.

    While the board is silent so is this service: what that means for the robot is the guard's to judge.
    """

    timers = ()

    def __init__(
        self, io: IO, config: RangerConfig, robot: RobotConfig, policy: type[RangerPolicy] = RangerPolicy
    ) -> None:
        self._io = io
        self._policy = policy(robot, config.board_type)
        self.link = io.board(config.port, config.board_type)
        self._clock = io.inbox(TICK, limit=1)
        for transform in self._policy.transforms():
            io.frame(transform.child, transform)
        self._ranges = {name: io.publisher(RANGE.at(name)) for name in robot.of(Ultrasonic)}
        self._bumps = {name: io.publisher(BUMPER.at(name)) for name in robot.of(Bumper)}

    def turn(self, now: float) -> None:
        policy, link = self._policy, self.link
        frames = list(link.poll(now))
        for frame in frames:
            if isinstance(frame, RangeFrame) and (sample := policy.on_frame(frame)) is not None:
                self._ranges[sample.sensor].put(sample)
            elif isinstance(frame, BumperFrame):
                for bump in policy.on_bumpers(frame, now):
                    self._bumps[bump.sensor].put(bump)
        if frames:
            if (request := policy.bumper_request(now)) is not None:
                link.send(request)
            for name, fault in policy.faults.items():
                self._io.set_fault(name, fault)
        for tick in self._clock.pop_all():
            if (down := policy.on_tick(tick, now)) is not None:
                link.send(down)
        self._io.set_fault("board", link.fault)

    def end(self) -> None:
        """Nothing is left to say: silence is what the guard judges."""
