"""One publisher of `/cmd_vel`: its messages, how old they are, and whether it is awake."""

import math
from typing import Final

from giraff_ros2.port import Received
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble

OLD: Final = 0.2
"""s. A message that comes later than the quickest of the last minute by more than this is old."""
LASTS: Final = 0.4
"""s that one message asks for, as one press of a key does."""
ANSWERS: Final = 0.6
"""s for which the answer of a process proves that it is awake. It is asked 20 times a second."""
CALM: Final = 1.0
"""s of rest after which what was lost counts again. A process that wakes and drives on never has it."""
_STREAM: Final = 5  # messages
_STREAM_PERIOD: Final = 1.0  # s between two of them at most: some drive by few messages a second
_FIRST_ANSWER: Final = 1.0  # s until a process counts as one that cannot answer
_BUCKET: Final = 10.0  # s of a publisher's messages, of which the smallest offset is kept
_BUCKETS: Final = 6

_OLD: Final = Trouble(
    f"a message of {{node}} is more than {OLD:g} s older than those before it, or the clock of its host was set back",
    "check the network between ROS and this host; after a clock was set, wait a minute",
)
_NO_NUMBER: Final = Trouble("a message of {node} has a speed that is not a number", "check what {node} publishes")


class PublisherClock:
    """Tells old messages of a publisher from new ones, though nobody knows how its clock and this host's differ.

    It measures the offset between both clocks with the delay of the way.
    A process that wakes pours out what it has held. The offset of such a message is worse than those before it. Nobody
    knows how old the first message is; the first quick one shows it.
    """

    def __init__(self) -> None:
        self._best: dict[int, float] = {}  # s, the smallest offset by number of the bucket

    def lateness(self, sent_ns: int, at: float) -> float:
        """Take a message, and return how much later it is than the quickest one lately, s.

        `sent_ns`: ns of any clock of the sender. `at`: s, monotonic, when it came.
        """
        offset, bucket = at - sent_ns * 1e-9, int(at // _BUCKET)
        self._best[bucket] = min(offset, self._best.get(bucket, offset))
        quickest = min(self._best.values())
        # Looked at before what is too long ago goes: after a long silence the first message still has one to compare.
        self._best = {number: best for number, best in self._best.items() if number > bucket - _BUCKETS}
        return offset - quickest


class Publisher:
    """Feed it its messages in their order. Times are monotonic, s."""

    def __init__(self, now: float) -> None:
        self.node = "a publisher that no token names"
        self.is_there = False
        """Its token is. That proves nothing: a frozen process keeps it for a minute."""
        self.was_there = False
        self.is_lost = False
        """It was asleep, or could not prove that it was not, and has not rested since for long enough."""
        self.answered = -math.inf
        """When the newest question was asked that its process has answered."""
        self.came = -math.inf
        """When its newest message came that counts."""
        self.asks = (0.0, 0.0)
        """m/s and rad/s, of that message."""
        self.tick: RobotTime | None = None
        """The robot's newest when that message came."""
        self.refused = NO_TROUBLE
        """Why its newest message that was refused does not count."""
        self.refused_at = -math.inf
        self._clock = PublisherClock()
        self.seen = now
        self._in_stream = 0
        self._can_answer = False
        self._calm_since = math.inf

    def watch(self, now: float, answered: float, *, is_there: bool) -> None:
        """Take whether its token is there, and when its process has answered: often, so that no lapse is missed."""
        self.is_there, self.was_there = is_there, is_there or self.was_there
        self.answered, self._can_answer = answered, self._can_answer or not math.isinf(answered)
        if self.moves(now):
            self._calm_since = math.inf
        elif math.isinf(self.proven(now)):
            self.is_lost, self._calm_since = not math.isinf(self.came), math.inf
        else:
            self._calm_since = min(self._calm_since, now)
            self.is_lost = self.is_lost and now - self._calm_since < CALM

    def on_twist(self, received: Received, tick: RobotTime | None) -> None:
        """Take a message. `tick`: the robot's newest now."""
        twist = getattr(received.message, "twist", received.message)
        asks = float(twist.linear.x) + 0.0, float(twist.angular.z) + 0.0  # + 0.0 makes a plain zero of a negative one
        late = self._clock.lateness(received.sent_ns, received.at)
        if not all(map(math.isfinite, asks)):
            self._refuse(_NO_NUMBER, received.at)
        elif late > OLD:
            self._refuse(_OLD, received.at)
        else:
            self._in_stream = self._in_stream + 1 if received.at - self.came <= _STREAM_PERIOD else 1
            self.asks, self.tick, self.came = asks, tick, received.at

    def was_heard_since(self, at: float) -> bool:
        """Tell whether a message of it came after that time, also one that was refused."""
        return max(self.came, self.refused_at) >= at

    def moves(self, now: float) -> bool:
        """Tell whether it asks for motion now."""
        return self.asks != (0.0, 0.0) and now - self.came <= LASTS

    def proven(self, now: float) -> float:
        """Return when it was proven for the last time that it rests, and is awake; -inf: it is not proven now."""
        if self.asks == (0.0, 0.0) and now - self.came <= LASTS:
            return self.came
        if now - self.answered <= ANSWERS:
            return self.answered
        if not self._can_answer and now - self.seen > _FIRST_ANSWER:
            # None of rmw_zenoh's. A stream that breaks off may be a frozen process, single messages are a person.
            return now if self.asks == (0.0, 0.0) or self._in_stream < _STREAM else -math.inf
        return -math.inf

    def _refuse(self, why: Trouble, at: float) -> None:
        self.refused = Trouble(why.what.format(node=self.node), why.remedy.format(node=self.node))
        self.refused_at = at
