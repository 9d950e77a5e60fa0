"""The robot in ROS 2: what it says, to ROS; what ROS asks, to `cmd_vel/<operator>` and base's emergency stop."""

from __future__ import annotations

from giraff_core.io import IO
from giraff_core.operator import OperatorService
from giraff_core.robot import RobotConfig
from giraff_ros2.cameras import OpenSource
from giraff_ros2.config import Ros2Config
from giraff_ros2.estop import StopCalls
from giraff_ros2.goal import Goals
from giraff_ros2.hand.twist_hand import TwistHand
from giraff_ros2.port import Received, Refused, RosPort
from giraff_ros2.robot_in_ros import RobotInRos
from giraff_ros2.topics import ESTOP_ENGAGED, GOAL_POSE
from giraff_schemas.topics import ESTOP
from giraff_schemas.trouble import WELL


class Ros2(OperatorService):
    """Reads and writes as the table of services says. ROS is reached through a `RosPort`."""

    def __init__(
        self, io: IO, config: Ros2Config, robot: RobotConfig, ros: RosPort, open_source: OpenSource | None = None
    ) -> None:
        """`open_source`: looks at a camera of the robot; None: nobody of ROS does."""
        self._io, self._ros = io, ros
        by = f"{config.operator}@{io.hostname}"
        self._twists = TwistHand(config, robot, io.instance)
        self._stops, self._goals = StopCalls(io, by), Goals(io, by)
        self._says = RobotInRos(io, robot, ros, open_source)
        self._estops = io.inbox(ESTOP)
        super().__init__(io, self._twists, wakes=False)
        self.link = ros

    def turn(self, now: float) -> None:
        # Before the ticks: a message is of one that was heard before it.
        for each in self._ros.take():
            self._take(each, now)
        self._twists.look(self._ros.publishers(), self._ros.answered, now)
        for call in self._ros.calls():
            self._stops.on_call(call, now)
        for estop in self._estops.take():
            self._stops.on_estop(estop, now)
        self._stops.poll(now)
        if (engaged := self._stops.news()) is not None:
            self._ros.publish(ESTOP_ENGAGED, engaged)
        if self._goals.is_active and self._twists.wishes(now):
            self._goals.cancel("somebody drives by /cmd_vel", now)
        self._goals.turn(now)
        self._twists.paused = self._goals.is_active or self._stops.asked
        super().turn(now)
        self._says.turn(now)
        self._io.set_notice("ros", self._ros.trouble())
        self._io.set_notice("goal", self._goals.trouble)
        if not self._speaks:
            self._io.set_notice("hand", WELL)
            self._io.set_notice("lease", WELL)

    def end(self) -> None:
        super().end()
        self._says.close()

    def _take(self, each: Received | Refused, now: float) -> None:
        match each:
            case Refused():
                self._twists.on_refused(each, now)
            case Received() if each.topic == GOAL_POSE:
                self._goals.on_goal(each, now)
            case Received():
                self._twists.on_twist(each, now)
                self.timer.hurry("ros2", now)
