"""The robot before the wall, on the network: what it hears, and motions that giraff_motion does for it."""

import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import closing
from typing import Any, Final

from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.pose_history import FutureError, GapError, PastError, PoseHistory
from giraff_core.motion.result import MotionResult
from giraff_core.motion.wish import Wish
from giraff_node.motion_client import TURN, MotionClient
from giraff_schemas.messages import Lease, Odometry, Range, Sample
from giraff_schemas.motion import Step
from giraff_schemas.services import MOTION
from giraff_schemas.topics import LEASE, ODOM, RANGE, Topic
from giraff_schemas.wire import ECHO_US_PER_M
from giraff_setup.ultrasonic.fit import Echo
from giraff_setup.ultrasonic.procedure import SPEED, TURN_SPEED, StoppedError
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.program import user_at_host

_PATIENCE: Final = 3.0  # s
_RELEASED_WITHIN: Final = 10.0
"""s. The guard ends the lease of a motion that is over after 2 s, unless the robot file says otherwise."""
_PING_EVERY: Final = 0.4
"""s at most, of one sensor that runs: they come at 5.6 Hz."""
_UNHEARD: Final = "odometry is not heard; check that giraff_base and giraff_odometry run, and the network to them"
_MOST_WAITING: Final = 200
"""Pings whose pose has not come yet."""


class NetworkStand:
    """As `Stand`."""

    def __init__(self, connection: RobotConnection, senses: Topic[Any] = RANGE) -> None:
        """`senses`: the topic of what is calibrated."""
        self._connection = connection
        self._hearing = Hearing()
        for topic in (ODOM, senses, LEASE):
            connection.subscribe(topic)

    def place(self) -> Pose:
        """As `Stand`."""
        self._wait(lambda: self._hearing.place is not None, _PATIENCE)
        self.idle()
        if (place := self._hearing.place) is None:
            raise StoppedError(_UNHEARD)
        self._require_whole()
        return place

    def listen(self, sensors: Sequence[str], pings: int) -> list[Echo]:
        """As `Stand`."""
        self.idle()
        heard = self._hearing.echoes
        heard.clear()

        def is_enough() -> bool:
            count = Counter(echo.sensor for echo in heard)
            return all(count[name] >= pings for name in sensors)

        self._wait(is_enough, _PATIENCE + pings * _PING_EVERY)
        self._require_whole()
        return list(heard)

    def perform(self, steps: Sequence[Step]) -> tuple[MotionResult, list[Echo]]:
        """As `Stand`. Ctrl-C ends the motion first."""
        self.idle()
        self._hearing.echoes.clear()
        wish = Wish(steps, speed=SPEED, turn_speed=TURN_SPEED)
        client = MotionClient(self._connection.session, self._connection.robot, user_at_host(), wish)
        with closing(client):
            try:
                result = self._follow(client, _PATIENCE)
            except BaseException:
                client.cancel(time.monotonic())
                self._follow(client, None)
                raise
        if result is None:
            raise StoppedError("the robot's clock is not heard; check that giraff_base runs")
        if not result.arrived:
            raise StoppedError(f"the motion ended before its end ({result.outcome}): {result.reason}")
        self._require_whole()
        return result, list(self._hearing.echoes)

    def idle(self) -> str:
        """As `Stand`."""
        self._connection.dispatch(self)
        return ""

    def wait_released(self) -> None:
        """As `HeldRest`."""
        self._wait(lambda: not self._hearing.motion_holds_lease, _RELEASED_WITHIN)
        if self._hearing.motion_holds_lease:
            raise StoppedError("giraff_motion still holds the lease; wait until the robot rests, then begin again")

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """As a `Listener`."""
        del topic, key, at_ns
        self._hearing.on_sample(sample)

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """Nobody asks who comes and goes."""

    def _follow(self, client: MotionClient, patience: float | None) -> MotionResult | None:
        """Return how the motion ended; None: nobody was asked within `patience` s."""
        began = time.monotonic()
        while (result := client.turn(now := time.monotonic())) is None:
            if patience is not None and not client.has_asked and now - began > patience:
                return None
            self.idle()
            time.sleep(TURN)
        return result

    def _wait(self, holds: Callable[[], bool], patience: float) -> None:
        deadline = time.monotonic() + patience
        self.idle()
        while not holds() and time.monotonic() < deadline:
            time.sleep(TURN)
            self.idle()

    def _require_whole(self) -> None:
        if self._hearing.fault:
            raise StoppedError(self._hearing.fault)


class Hearing:
    """Puts pings and odometry together by the robot's clock. No I/O and no clock of its own."""

    def __init__(self) -> None:
        self._history = PoseHistory()
        self._waiting: list[Range] = []
        self._segment: tuple[object, ...] | None = None
        self.echoes: list[Echo] = []
        """In the order in which they came. Whoever uses them takes them away."""
        self.fault = ""
        """Reason why poses before and after do not belong together; empty: they do."""
        self.motion_holds_lease = False

    @property
    def place(self) -> Pose | None:
        """The newest pose; None: none was heard."""
        newest = self._history.newest()
        return None if newest is None else newest[0]

    def on_sample(self, sample: Sample) -> None:
        """Take a sample of odometry, of a sensor, or of the lease."""
        if isinstance(sample, Odometry):
            segment = (sample.segment, sample.breaks, sample.tick.epoch)
            if self._segment not in {None, segment}:
                self.fault = "odometry was set, began anew or lost the wheels meanwhile; begin again"
            self._segment = segment
            self._history.on_odometry(sample)
        elif isinstance(sample, Range):
            self._waiting = [*self._waiting, sample][-_MOST_WAITING:]
        elif isinstance(sample, Lease):
            self.motion_holds_lease = sample.operator == MOTION.name
        self._waiting = [each for each in self._waiting if not self._settle(each)]

    def _settle(self, reading: Range) -> bool:
        """Add a ping whose pose is known; return whether it need not wait any longer."""
        if reading.tick is None:
            return True
        try:
            at = self._history.at(reading.tick)
        except FutureError:
            return False
        except (GapError, PastError):
            return True
        far = reading.echo_us / ECHO_US_PER_M if reading.state == "echo" else None
        self.echoes.append(Echo(reading.sensor, far, at))
        return True
