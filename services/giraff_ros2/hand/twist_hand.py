"""The publishers of `/cmd_vel` as an operator's hand. No I/O and no clock.

`teleop_twist_keyboard` sends one message for a key press and then none, so a publisher that is there and silent is a
hand at rest, which arms the robot. A process that is frozen is there and silent, too, and drives on when it wakes. So
rest needs a proof: a message of zero, or the answer of the process to a question of now.
"""

import math
from collections import deque
from collections.abc import Callable, Iterable
from typing import Final

from giraff_core.freshness import age
from giraff_core.operator import Fault, Hand, Operator, Wish
from giraff_ros2.answers import Answers
from giraff_ros2.config import Ros2Config
from giraff_ros2.hand.publisher import ANSWERS, CALM, LASTS, Publisher
from giraff_ros2.port import OTHER_LIBRARY, USE_RMW_ZENOH, Received, Refused, RosPublisher
from giraff_ros2.topics import CMD_VEL, CMD_VEL_STAMPED
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble

RESTS: Final = 30.0
"""s after its last message for which a publisher is a hand at rest, and no longer."""
_GONE: Final = 1.0  # s for which the end of a publisher that drove is told
_MOST: Final = 32  # publishers that are remembered
_TOKEN_WITHIN: Final = 1.0  # s. Messages and tokens come in any order

_NO_TOKEN: Final = Trouble(
    f"messages on /cmd_vel count for nothing: no token has the id of their publisher, {OTHER_LIBRARY}", USE_RMW_ZENOH
)
_STOPPING: Final = Trouble("/giraff/estop was called, and base has not yet confirmed the emergency stop")
_LET_REST: Final = f"let it rest, or publish zero, for {CALM:g} s"


class TwistHand(Hand):
    """Feed it what comes, then let it `review`. Times are monotonic, s."""

    def __init__(self, config: Ros2Config, instance: str) -> None:
        # Nobody takes the robot by being there: the lease is asked for by a message that moves alone.
        super().__init__(Operator(config.operator, instance, asks_from_start=False))
        self.paused = False
        """Another part of this service drives, and this hand says nothing."""
        self.stopping = False
        """An emergency stop was asked for here, and is not confirmed."""
        self._publishers: dict[bytes, Publisher] = {}
        self._refused, self._refused_at = NO_TROUBLE, -math.inf
        self._ticks: deque[tuple[float, RobotTime | None]] = deque(maxlen=200)
        self._lost = NO_TROUBLE  # why the hand does not count until it has rested
        self._calm_since = math.inf

    def on_twist(self, received: Received, now: float) -> None:
        """Take a message of a Twist, with or without a stamp."""
        self._of(received.gid, now).on_twist(received, self.operator.tick)

    def on_refused(self, refused: Refused, now: float) -> None:
        """Take that a sample was no message."""
        self._refused, self._refused_at = refused.trouble, now

    def review(self, publishers: Iterable[RosPublisher], answers: Callable[[str], Answers], now: float) -> None:
        """Take who is there now, and what each has answered. What has come before is judged together with it."""
        there = {each.gid: each for each in publishers if each.topic in (CMD_VEL, CMD_VEL_STAMPED)}
        for gid in [*there][:_MOST]:
            self._of(gid, now).node = there[gid].node
        for gid, publisher in self._publishers.items():
            is_there = gid in there
            publisher.watch(now, answers(there[gid].process).newest if is_there else -math.inf, is_there=is_there)
        self._ticks.append((now, self.operator.tick))
        judged = self._judge(now)
        if isinstance(judged, Fault):
            self._lost, self._calm_since = judged.trouble, math.inf
        elif judged is None or judged.takes:
            self._calm_since = math.inf
        else:
            self._calm_since = min(self._calm_since, now)
            if now - self._calm_since >= CALM:
                self._lost = NO_TROUBLE

    def token_fault(self, now: float) -> Trouble:
        """Return why whole messages that came lately count for nothing; NO_TROUBLE: each publisher has a token."""
        strangers = (each for each in self._publishers.values() if not each.was_there)
        is_told = any(now - each.seen > _TOKEN_WITHIN and each.was_heard_since(now - RESTS) for each in strangers)
        return _NO_TOKEN if is_told else NO_TROUBLE

    def poll(self, now: float) -> Wish | Fault | None:
        """Return what ROS asks; None: nobody of ROS has a hand on this robot."""
        if self.stopping:
            return Fault(_STOPPING, self.operator.tick)
        if self.paused:
            return None
        judged = self._judge(now)
        if isinstance(judged, Wish) and self._lost:
            return Fault(Trouble(self._lost.what, self._lost.remedy or _LET_REST), judged.tick)
        return judged

    def _judge(self, now: float) -> Wish | Fault | None:
        """Return what is asked now, without what was before."""
        known = self._publishers.values()
        movers = [each for each in known if each.is_there and each.moves(now)]
        resting = [each for each in known if each.is_there and now - each.came <= RESTS]
        if fault := self._fault(movers, now):
            return Fault(fault, self.operator.tick) if movers or resting or self._spoke(now) else None
        for mover in movers:
            if mover.is_lost:
                return Fault(_asleep(mover.node), self.operator.tick)
            newest = self.operator.tick
            if newest is not None and age(mover.tick, newest) <= LASTS:
                return Wish(*mover.asks, mover.tick, takes=True)
        if not resting:
            return None
        proofs = {each.node: each.proven(now) for each in resting}
        asleep = [node for node, at in proofs.items() if math.isinf(at)]
        if asleep:
            return Fault(_asleep(asleep[0]), self.operator.tick)
        return Wish(0.0, 0.0, self._tick_at(min(proofs.values())))

    def _fault(self, movers: list[Publisher], now: float) -> Trouble:
        if len(movers) > 1:
            names = " and ".join(sorted(each.node for each in movers))
            return Trouble(f"{names} drive at once", "let one of them rest")
        for each in self._publishers.values():
            if each.was_there and not each.is_there and each.asks != (0.0, 0.0) and now - each.came <= _GONE:
                return Trouble(f"{each.node} was driving, and is not there any more", "start it again")
            # What was refused is no motion; the message before it goes on to age.
            if now - each.refused_at <= LASTS and not each.moves(now):
                return each.refused
        if now - self._refused_at <= LASTS:
            return self._refused
        return self.operator.fault(now)

    def _spoke(self, now: float) -> bool:
        """Tell whether anybody has published lately."""
        is_heard = any(each.was_heard_since(now - _GONE) for each in self._publishers.values())
        return is_heard or now - self._refused_at <= _GONE

    def _tick_at(self, at: float) -> RobotTime | None:
        """Return the robot's newest tick at that time: never one of later than the proof."""
        return next((tick for seen, tick in reversed(self._ticks) if seen <= at), None)

    def _of(self, gid: bytes, now: float) -> Publisher:
        if gid not in self._publishers:
            if len(self._publishers) >= _MOST:
                # Who has no token goes first: a flood of invented publishers drives out nobody.
                del self._publishers[
                    min(self._publishers.items(), key=lambda each: (each[1].was_there, each[1].came))[0]
                ]
            self._publishers[gid] = Publisher(now)
        return self._publishers[gid]


def _asleep(node: str) -> Trouble:
    return Trouble(
        f"the process of {node} did not answer for {ANSWERS:g} s, and may have been frozen",
        f"look at it; then {_LET_REST}",
    )
