"""The robot in ROS 2: what it says goes to ROS, and what ROS asks to guard, base's stop, motion and places."""

from collections.abc import Callable
from typing import Any, Final

from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__Bool as Bool

from giraff_core.estop.request import EStopRequest, Request
from giraff_core.io import IO, Inbox
from giraff_core.operator import OperatorService
from giraff_core.picture.receiver import OpenSource
from giraff_core.robot import RobotConfig
from giraff_core.senses import SENSED
from giraff_core.timer import Timer
from giraff_ros2.config import Ros2Config
from giraff_ros2.goal import Goals
from giraff_ros2.hand.twist_hand import TwistHand
from giraff_ros2.port import Call, Received, Refused, RosPort
from giraff_ros2.robot_in_ros import RobotInRos
from giraff_ros2.topics import ESTOP_ENGAGED, GOAL_POSE
from giraff_schemas.actions import ROS
from giraff_schemas.messages import EStop, Lease, Sample, Tick
from giraff_schemas.requests import EStopAnswer, EStopEngage
from giraff_schemas.topics import (
    BASE,
    BATTERY,
    ESTOP,
    ESTOP_ENGAGE,
    GUARD,
    MAP,
    MOTION,
    ODOM,
    OPERATOR_CMD_VEL,
    PLACES,
    POSE,
    ROUTE,
    TILT,
    Topic,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_KEPT: Final = 20
"""Samples of a topic between two turns of which none is left out."""
_ANSWERS_WITHIN: Final = 3.0
"""s after which a call of `~/estop` is answered that base has not confirmed. The stop goes on being asked for."""
_MOST: Final = 16  # calls that wait


class StopCalls:
    """Calls of `~/estop`: all that wait are one stop. Times are monotonic, s.

    There is no release from ROS: who releases a stop must see the robot.
    """

    def __init__(self, io: IO, by: str) -> None:
        """`by`: who asks, for people."""

        def engage(settles: Callable[[EStopAnswer], bool | str], off: bool) -> Request:
            return io.ask(ESTOP_ENGAGE, EStopEngage(by=by, reason=Trouble("service estop of ROS"), off=off), settles)

        self._request = EStopRequest(engage, is_open=io.is_open)
        self._calls: list[tuple[Call, float]] = []
        self._told: bool | None = None
        self._newest: EStop | None = None

    @property
    def asked(self) -> bool:
        """Tell whether a stop was asked for that base has not confirmed."""
        return self._request.asked

    def on_call(self, call: Call, now: float) -> None:
        """Somebody wants a stop. One that stands is asked for once more: its release may be on its way."""
        self._request.engage()
        if len(self._calls) < _MOST:
            self._calls.append((call, now))
        else:
            call.answer(False, f"{_MOST} calls wait for base's word already")

    def on_estop(self, sample: EStop) -> None:
        """Take what base says of its stop."""
        self._newest = sample
        self._request.on_sample(sample)

    def poll(self, now: float) -> None:
        """Go on asking, and answer calls."""
        confirmed = self._request.poll(now)
        for call, at in self._calls:
            if confirmed or now - at >= _ANSWERS_WITHIN:
                call.answer(confirmed, self._request.outcome.line(ROS))
        self._calls = [(call, at) for call, at in self._calls if not confirmed and now - at < _ANSWERS_WITHIN]

    def news(self) -> bool | None:
        """Return whether the stop is engaged where that has changed since the last call; None: it has not."""
        if self._newest is None or self._newest.engaged == self._told:
            return None
        self._told = self._newest.engaged
        return self._told


class Ros2(OperatorService):
    """Reads and writes as the table of services says. ROS is reached through a `RosPort`."""

    def __init__(
        self, io: IO, config: Ros2Config, robot: RobotConfig, ros: RosPort, open_source: OpenSource | None = None
    ) -> None:
        """`open_source`: looks at a camera of the robot; None: ROS is shown no pictures."""
        self._io, self._ros = io, ros
        by = f"{config.operator}@{io.hostname}"
        self._twists = TwistHand(config, io.instance)
        self._stops, self._goals = StopCalls(io, by), Goals(io, by)
        self._says = RobotInRos(robot, ros, open_source, by)
        # All is looked at fifty times a second, as often as an operator speaks. Of odometry, which comes more often,
        # the newest goes on: ROS's own drivers of wheels publish it at that rate.
        waiting: list[Topic[Any]] = [BASE, GUARD, ESTOP, BATTERY, *SENSED.values(), TILT, POSE, MAP]
        waiting += [PLACES, MOTION, ROUTE]
        self._heard: list[Inbox[Any]] = [io.inbox(ODOM, 1, wakes=False)]
        self._heard += [io.inbox(topic, _KEPT, wakes=False) for topic in waiting]
        super().__init__(io, self._twists, wakes=False)
        self.link = ros
        self._pace = Timer(OPERATOR_CMD_VEL.rate_hz)
        self.timers = (*self.timers, self._pace)

    def turn(self, now: float) -> None:
        # Before the ticks: a message is of one that was heard before it.
        for each in self._ros.pop_all():
            self._on_received(each, now)
        self._twists.review(self._ros.publishers(), self._ros.answers, now)
        self.read_inboxes(now)
        if is_due := self._pace.due(now):
            for sample in (sample for inbox in self._heard for sample in inbox.pop_all()):
                self._on_sample(sample, now)
        for call in self._ros.calls():
            self._stops.on_call(call, now)
        self._stops.poll(now)
        if (engaged := self._stops.news()) is not None:
            self._ros.publish(ESTOP_ENGAGED, Bool(engaged))
        if self._stops.asked:
            self._goals.cancel("a stop was asked for", now)
        self._goals.turn(now, self._twists.operator.holder)
        self._twists.paused, self._twists.stopping = self._goals.is_active, self._stops.asked
        self.say(now)
        if is_due:
            self._says.turn(now)
            self._report(now)

    def on_tick(self, tick: Tick, now: float) -> None:
        super().on_tick(tick, now)
        self._goals.on_tick(tick, now)

    def on_lease(self, lease: Lease, now: float) -> None:
        super().on_lease(lease, now)
        self._says.on_sample(lease, now)

    def end(self) -> None:
        super().end()
        self._says.close()

    def _on_sample(self, sample: Sample, now: float) -> None:
        self._says.on_sample(sample, now)
        self._goals.on_sample(sample, now)
        if isinstance(sample, EStop):
            self._stops.on_estop(sample)

    def _on_received(self, each: Received | Refused, now: float) -> None:
        match each:
            case Refused() if each.topic == GOAL_POSE:
                self._goals.on_refused(each.trouble, now)
                return
            case Refused():
                self._twists.on_refused(each, now)
            case Received() if each.topic == GOAL_POSE:
                processes = (one.process for one in self._ros.publishers() if one.gid == each.gid)
                process = next(processes, None)
                self._goals.on_goal(each, None if process is None else self._ros.answers(process), now)
                return
            case Received():
                self._twists.on_twist(each, now)
                self.timer.fire_now("ros2", now)
        # Also zero, which stops: it is the key that somebody presses in fright.
        self._goals.cancel("a message came on /cmd_vel", now)

    def _report(self, now: float) -> None:
        self._io.set_notice("ros", self._ros.trouble())
        self._io.set_notice("publisher", self._twists.token_fault(now))
        self._io.set_notice("goal", self._goals.trouble)
        if not self._speaks:
            self._io.set_notice("hand", NO_TROUBLE)
            self._io.set_notice("lease", NO_TROUBLE)
