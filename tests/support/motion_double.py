"""In the place of giraff_motion and its robot, on a network of one process: it says what it is told to say."""

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
from giraff_schemas.topics import MOTION, MOTION_CANCEL, MOTION_GO, MOTION_HOLD, TICK, Topic, alive_key, key_of
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


class MotionDouble:
    """It accepts what it is asked, moves for `takes` s, and ends as `outcome`."""

    def __init__(self, session: Session, clock: Clock, robot: str) -> None:
        self.asked: list[MotionGo] = []
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
        session.declare_subscriber(key_of(robot, MOTION_HOLD), self._on_hold)
        session.answer(key_of(robot, MOTION_GO), self._on_go)
        session.answer(key_of(robot, MOTION_CANCEL), self._on_cancel)
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
        if not (self.asked and self.speaks and not self.refusal):
            return
        wish = self.asked[-1].id
        if not self._ended and self._clock.monotonic() - self._began >= self.takes:
            self._ended = self.outcome
        if not self._ended:
            self.say(MOTION, motion_state(wish))
        elif self._ended == "arrived":
            there = Displacement(path=0.998, x=0.998, y=0.0, yaw=0.0)
            self.say(MOTION, motion_state(wish, "ended", "arrived", achieved=there))
        elif self._ended == "blocked":
            self.say(MOTION, motion_state(wish, "ended", "blocked", sensor="front_left", reason=Trouble(BLOCKED)))
        else:
            self.say(MOTION, motion_state(wish, "ended", self._ended, reason=Trouble(f"it is {self._ended}")))

    def _on_hold(self, received: Any) -> None:
        self.holds.append((self._clock.monotonic(), msgspec.msgpack.decode(received.payload, type=MotionHold)))

    def _on_go(self, payload: bytes) -> tuple[float, bytes] | None:
        request = msgspec.msgpack.decode(payload, type=MotionGo)
        if not self.asked or self.asked[-1].id != request.id:
            self._began, self._ended = self._clock.monotonic(), ""
        self.asked.append(request)
        return (
            (0.02, encode(MotionAnswer(accepted=not self.refusal, reason=Trouble(self.refusal))))
            if self.answers
            else None
        )

    def _on_cancel(self, payload: bytes) -> tuple[float, bytes] | None:
        self.cancelled.append(msgspec.msgpack.decode(payload, type=MotionCancel))
        self._ended = "cancelled"
        return (0.02, encode(MotionAnswer(accepted=True))) if self.answers else None
