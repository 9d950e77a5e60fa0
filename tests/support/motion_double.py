"""In the place of giraff_motion, giraff_places and their robot, on a network of one process.

It says what it is told to say.
"""

from itertools import count
from typing import Any

import msgspec

from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import RobotTime, Sample, Tick
from giraff_schemas.motion import (
    NOWHERE,
    Displacement,
    MotionAnswer,
    MotionCancel,
    MotionGo,
    MotionHold,
    MotionState,
    Outcome,
    Stage,
)
from giraff_schemas.places import Goal, PlacesGo, RouteState
from giraff_schemas.topics import (
    MOTION,
    MOTION_CANCEL,
    MOTION_GO,
    MOTION_HOLD,
    PLACES_CANCEL,
    PLACES_GO,
    PLACES_HOLD,
    ROUTE,
    TICK,
    Topic,
    alive_key,
    key_of,
)
from giraff_schemas.trouble import Trouble
from tests.support.one_process import Clock, Session

EPOCH = 7
BLOCKED = "front_left blocks: front_left sees something at 0.30 m; turn left or back up"


def motion_state(wish: int, stage: Stage = "moving", outcome: Outcome = "", **changes: Any) -> MotionState:
    """A metre that was asked for, and half of it gone."""
    gone = Displacement(path=0.5, x=0.5, y=0.01, yaw=0.02)
    known: dict[str, Any] = {
        "by": "ann@desk",
        "step": 1,
        "steps": 1,
        "asked": msgspec.structs.replace(NOWHERE, path=1.0, x=1.0),
        "achieved": gone,
        "covariance": (0.0001, 0.0, 0.0, 0.0004, 0.0, 0.0009),
        "elapsed": 2.0,
        "time_limit": 8.0,
        "sensor": "",
    }
    return MotionState(id=wish, stage=stage, outcome=outcome, **known | changes)


def route_state(wish: int, stage: Stage = "moving", outcome: Outcome = "", **changes: Any) -> RouteState:
    """A route of five legs to the kitchen, and its second one."""
    route = {
        "step": 2,
        "steps": 5,
        "asked": msgspec.structs.replace(NOWHERE, path=7.9),
        "achieved": msgspec.structs.replace(NOWHERE, path=3.2),
        "place": "kitchen",
        "goal": Goal(x=6.3, y=1.8, yaw=1.57),
        "corners": ((1.0, 3.0), (4.1, 3.0), (6.3, 1.8)),
    }
    state = motion_state(wish, stage, outcome)
    known = {
        name: getattr(state, name) for name in MotionState.__struct_fields__ if name not in Sample.__struct_fields__
    }
    return RouteState(**known | route | changes)


class MotionDouble:
    """It accepts what it is asked, moves for `takes` s, and ends as `outcome`."""

    def __init__(self, session: Session, clock: Clock, robot: str) -> None:
        self.asked: list[MotionGo] = []
        self.routes: list[PlacesGo] = []
        """Asked for; what else is heard and said is then of the newest of them."""
        self.cancelled: list[MotionCancel] = []
        self.holds: list[tuple[float, MotionHold]] = []
        """With when each came, s."""
        self.ticks = self.answers = self.speaks = True
        """What comes of it."""
        self.refusal = ""
        self.takes = 1.0
        self.outcome: Outcome = "arrived"
        self.instance = "one"
        self._session, self._clock, self._robot = session, clock, robot
        self._ended: Outcome = ""
        self._began = 0.0
        self._seq = count()
        self.token = session.declare_token(alive_key(robot, "base", "1"))
        self.token.__enter__()
        for hold, cancel in ((MOTION_HOLD, MOTION_CANCEL), (PLACES_HOLD, PLACES_CANCEL)):
            session.declare_subscriber(key_of(robot, hold), self._on_hold)
            session.answer(key_of(robot, cancel), self._on_cancel)
        session.answer(key_of(robot, MOTION_GO), self._on_go)
        session.answer(key_of(robot, PLACES_GO), self._on_route)
        clock.every(0.02, self._tick)
        clock.every(0.1, self._tell)

    def now(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=self._clock.monotonic_ns() + 1)

    def say(self, topic: Topic[Any], sample: Sample) -> None:
        data = encode(stamped(sample, next(self._seq), 0, self.instance))
        self._session.put(key_of(self._robot, topic), data, encoding=encoding_of(topic.schema))

    def _tick(self) -> None:
        if self.ticks:
            now = self.now()
            self.say(TICK, Tick(epoch=now.epoch, robot_ns=now.robot_ns))

    def _tell(self) -> None:
        if not ((self.asked or self.routes) and self.speaks and not self.refusal):
            return
        if not self._ended and self._clock.monotonic() - self._began >= self.takes:
            self._ended = self.outcome
        if self.routes:
            self._tell_route(self.routes[-1].id)
            return
        wish = self.asked[-1].id
        if not self._ended:
            self.say(MOTION, motion_state(wish))
        elif self._ended == "arrived":
            there = Displacement(path=0.998, x=0.998, y=0.0, yaw=0.0)
            self.say(MOTION, motion_state(wish, "ended", "arrived", achieved=there))
        elif self._ended == "blocked":
            self.say(MOTION, motion_state(wish, "ended", "blocked", sensor="front_left", reason=Trouble(BLOCKED)))
        else:
            self.say(MOTION, motion_state(wish, "ended", self._ended, reason=Trouble(f"it is {self._ended}")))

    def _tell_route(self, wish: int) -> None:
        at, elapsed = (4.1, 2.2), self._clock.monotonic() - self._began
        whole = msgspec.structs.replace(NOWHERE, path=7.9)
        if not self._ended:
            waits = elapsed > self.takes / 2
            reason = Trouble(BLOCKED if waits else "")
            state = route_state(wish, "waiting" if waits else "moving", at=at if waits else None, reason=reason)
        elif self._ended == "arrived":
            state = route_state(wish, "ended", "arrived", step=5, achieved=whole, at=(6.3, 1.8))
        else:
            why = Trouble(BLOCKED if self._ended == "blocked" else f"it is {self._ended}")
            sensor = "front_left" if self._ended == "blocked" else ""
            state = route_state(wish, "ended", self._ended, at=at, sensor=sensor, reason=why)
        self.say(ROUTE, msgspec.structs.replace(state, elapsed=elapsed))

    def _on_hold(self, received: Any) -> None:
        self.holds.append((self._clock.monotonic(), msgspec.msgpack.decode(received.payload, type=MotionHold)))

    def _on_go(self, payload: bytes) -> tuple[float, bytes] | None:
        return self._on_request(self.asked, msgspec.msgpack.decode(payload, type=MotionGo))

    def _on_route(self, payload: bytes) -> tuple[float, bytes] | None:
        return self._on_request(self.routes, msgspec.msgpack.decode(payload, type=PlacesGo))

    def _on_request(self, asked: list[Any], request: MotionGo | PlacesGo) -> tuple[float, bytes] | None:
        if not asked or asked[-1].id != request.id:
            self._began, self._ended = self._clock.monotonic(), ""
        asked.append(request)
        return (
            (0.02, encode(MotionAnswer(accepted=not self.refusal, reason=Trouble(self.refusal))))
            if self.answers
            else None
        )

    def _on_cancel(self, payload: bytes) -> tuple[float, bytes] | None:
        self.cancelled.append(msgspec.msgpack.decode(payload, type=MotionCancel))
        self._ended = "cancelled"
        return (0.02, encode(MotionAnswer(accepted=True))) if self.answers else None
