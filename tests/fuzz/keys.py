"""Fuzzes one key in the whole robot in one process: decoding, the policies behind it, the board's C behind them."""

import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from fnmatch import fnmatch
from functools import partial
from typing import Any, Final

import msgspec

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.policy import KeyboardPolicy
from giraff_schemas import camera
from giraff_schemas.codec import DecodeError, decode, encode
from giraff_schemas.localization import LocalizationGlobal, LocalizationSetPose
from giraff_schemas.messages import Lease, RobotTime, Tick
from giraff_schemas.motion import Arc, GoTo, MotionArc, MotionCancel, MotionGo, MotionMove, MotionTurn, Move, Turn
from giraff_schemas.places import Goal, PlaceAdd, PlacesGo, PlacesSet
from giraff_schemas.requests import EStopEngage, EStopReset, OdomReset, OdomSetPose
from giraff_schemas.topics import (
    DRIVING_QUERIES,
    ESTOP_ENGAGE,
    ESTOP_RESET,
    LOCALIZATION_GLOBAL,
    LOCALIZATION_SET_POSE,
    MOTION_ARC,
    MOTION_CANCEL,
    MOTION_GO,
    MOTION_MOVE,
    MOTION_TURN,
    ODOM_ECHOES,
    ODOM_RESET,
    ODOM_SET_POSE,
    PLACES_CANCEL,
    PLACES_GO,
    PLACES_SET,
    QUERIES,
    TOPICS,
    VISUAL_ODOM,
    Query,
    Topic,
)
from giraff_schemas.trouble import Trouble
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.hosts.network import Message
from tests.fuzz.growth import Growth
from tests.fuzz.payloads import payload
from tests.loop.loops import FULL_TILT, SEES, arm, closed_loop, hold
from tests.sim.robots import proving_room
from tests.support.operators import said as command
from tests.support.robots import ROBOT
from tests.unit.schemas.samples import an_example

KEYS: Final[tuple[Topic[Any] | Query[Any, Any], ...]] = (
    # No part of the simulated robot hears what cameras say, but base hears what giraff_vision does.
    *(topic for topic in TOPICS if topic.schema.__module__ != camera.__name__),
    VISUAL_ODOM,
    *(query for query in QUERIES if query is not ODOM_ECHOES),  # it changes nothing, and is read as the others are
    *DRIVING_QUERIES,
)
_AT_ONCE: Final = 15
"""Payloads each simulated ms: an inbox of 20 that is read every 10 ms loses some, one of 200 none."""
_TRUTHS: Final = 40
_OTHER_EPOCH: Final = 0xABCD1234

_OLD: Final = RobotTime(epoch=7, robot_ns=5_000_000_000)
REQUESTS: Final[dict[str, msgspec.Struct]] = {
    ESTOP_ENGAGE.key: EStopEngage(by="somebody", reason=Trouble("no reason")),
    ESTOP_RESET.key: EStopReset(by="somebody", id=0, tick=_OLD),
    ODOM_RESET.key: OdomReset(by="somebody", id=1),
    ODOM_SET_POSE.key: OdomSetPose(by="somebody", id=2, x=1.0, y=-1.0, yaw=0.5),
    LOCALIZATION_SET_POSE.key: LocalizationSetPose(by="somebody", id=7, x=1.0, y=-1.0, yaw=0.5),
    LOCALIZATION_GLOBAL.key: LocalizationGlobal(by="somebody", id=8),
    PLACES_SET.key: PlacesSet(by="somebody", id=9, change=PlaceAdd(name="kitchen")),
    MOTION_MOVE.key: MotionMove(by="somebody", id=3, instance="asker", tick=_OLD, distance=1.0),
    MOTION_TURN.key: MotionTurn(by="somebody", id=4, instance="asker", tick=_OLD, angle=-1.5, turn_speed=0.5),
    MOTION_ARC.key: MotionArc(by="somebody", id=5, instance="asker", tick=_OLD, radius=0.5, angle=1.5, time_limit=10.0),
    MOTION_GO.key: MotionGo(
        by="somebody",
        id=6,
        instance="asker",
        tick=_OLD,
        steps=(Move(distance=1.0), Turn(angle=1.0), Arc(radius=1.0, angle=1.0), GoTo(x=1.0, y=1.0)),
    ),
    MOTION_CANCEL.key: MotionCancel(by="somebody", id=6),
    PLACES_GO.key: PlacesGo(by="somebody", id=10, instance="asker", tick=_OLD, goal=Goal(x=1.0, y=1.0, yaw=0.5)),
    PLACES_CANCEL.key: MotionCancel(by="somebody", id=10),
}
"""By key, what may be asked there; that one resets no latch, and those begin no motion."""

Truths = dict[str, list[bytes]]
"""By key: what was said on it."""


class Counted(msgspec.Struct, kw_only=True):
    """What became of the payloads of one key."""

    payloads: int = 0
    sound: int = 0
    """That were samples, or requests, and reached whoever takes them."""
    driven_ms: int = 0
    growth_bytes: int = 0


def fuzz_key(row: Topic[Any] | Query[Any, Any], wanted: int, seed: int) -> Counted:
    """Throw `wanted` payloads at a robot of its own."""
    with armed_robot() as (loop, truths):
        return fuzz_key_of(loop, truths, row, wanted, seed, Growth())


def fuzz_key_of(
    loop: ClosedLoop,
    truths: Truths,
    row: Topic[Any] | Query[Any, Any],
    wanted: int,
    seed: int,
    growth: Growth | None = None,
    *,
    drives: bool = True,
) -> Counted:
    """Throw `wanted` payloads at a robot that is armed, in a level hand, and leave it so.

    It must drive in between if `drives`, or if it is not armed any more.
    """
    chance = random.Random(f"{seed}/{row.key}")
    keyboard = KeyboardPolicy(KeyboardConfig(), ROBOT, "keyboard-1")
    said = truths[row.key]
    assert loop.newest["base"].armed, loop.newest["base"].reason
    if row is ESTOP_RESET:
        engage(loop)
        old = RobotTime(epoch=_OTHER_EPOCH, robot_ns=loop.robot_ns)
        said = [encode(EStopReset(by="somebody", id=loop.newest["estop"].id, tick=old))]

    def turn() -> None:
        assert command(keyboard, loop.simulation.now_us * 1e-6).neutral

    counted = throw(loop, said, partial(_deliver, loop, keyboard, row), turn, wanted, chance, growth)
    if row is ESTOP_RESET:
        assert loop.newest["estop"].engaged, "a mutated reset has cleared the emergency stop"
    if row in (ESTOP_ENGAGE, ESTOP_RESET):
        release(loop)
    if drives or not loop.newest["base"].armed:
        drive(loop)
        rest(loop)
    return counted


def throw(
    loop: ClosedLoop,
    truths: Sequence[bytes],
    deliver: Callable[[bytes], bool],
    turn: Callable[[], None],
    wanted: int,
    chance: random.Random,
    growth: Growth | None,
) -> Counted:
    """Throw `wanted` payloads, some in each step, which ends with `turn`. `deliver`: whether it takes one for sound."""
    counted = Counted()
    since_us = loop.simulation.now_us
    while counted.payloads < wanted:
        for _ in range(_AT_ONCE):
            counted.payloads += 1
            counted.sound += deliver(payload(truths, chance))
        loop.step()
        turn()
        if counted.payloads % 1000 < _AT_ONCE or counted.payloads >= wanted:
            counted.driven_ms += loop.simulation.record.window(since_us, loop.simulation.now_us).driven_ms
            since_us = loop.simulation.now_us
        if growth is not None:
            growth.look(counted.payloads / wanted)
            counted.growth_bytes = growth.bytes
    return counted


def engage(loop: ClosedLoop) -> None:
    deliver(loop, ESTOP_ENGAGE.key, EStopEngage(by="test", reason=Trouble("whatever comes")))
    loop.run(1.0)
    assert loop.newest["estop"].engaged, loop.newest["estop"]


def release(loop: ClosedLoop) -> None:
    """Reset the emergency stop as somebody does who is there, once base has taken all that was asked."""
    loop.run(1.0)
    tick = loop.newest["tick"]
    now = RobotTime(epoch=tick.epoch, robot_ns=tick.robot_ns)
    deliver(loop, ESTOP_RESET.key, EStopReset(by="test", id=loop.newest["estop"].id, tick=now))
    loop.run(1.0)
    assert not loop.newest["estop"].engaged, loop.newest["estop"]


def deliver(loop: ClosedLoop, key: str, message: msgspec.Struct) -> None:
    """To whoever takes the key, at once."""
    for taker in loop.network.takers(key):
        taker.deliver(Message(key, message))


def drive(loop: ClosedLoop) -> None:
    """Whatever was thrown at it left no damage."""
    steer(loop, 1.0, x=FULL_TILT)
    assert loop.newest["wheels"].left_velocity > 0.1, loop.newest["base"].reason


def rest(loop: ClosedLoop) -> None:
    """Back up to about where it drove from, and stand in a level hand for longer than anything counts of that."""
    hold(loop, x=-FULL_TILT)
    until_us = loop.simulation.now_us + 3_000_000
    while loop.simulation.world.plant.pose.x > 0.3 and loop.simulation.now_us < until_us:
        loop.step()
    hold(loop)
    loop.run(2.0)


def steer(loop: ClosedLoop, seconds: float, x: float = 0.0, y: float = 0.0) -> None:
    """Ask, arm, and hold the joystick so, as an operator does who may have lost the lease."""
    hold(loop, x, y)
    loop.run(0.5)
    arm(loop)
    hold(loop, x, y)
    loop.run(seconds)


@contextmanager
def armed_robot() -> Iterator[tuple[ClosedLoop, Truths]]:
    """And by key what was said while it drove, longer ago than anything counts."""
    with closed_loop(proving_room(), SEES) as loop:
        loop.start("motion")
        truths: Truths = {row.key: [] for row in KEYS}
        drive(loop)
        for _ in range(_TRUTHS):
            loop.run(0.02)
            for key, sample in loop.newest.items():
                [row] = [row for row in TOPICS if fnmatch(key, row.key)]
                truths[row.key].append(encode(sample))
        for row in (row for row in KEYS if isinstance(row, Topic)):
            truths[row.key] = truths[row.key] or [msgspec.msgpack.encode(an_example(row.schema))]
        for key, request in REQUESTS.items():
            truths[key].append(encode(request))
        hold(loop)
        loop.run(2.0)
        arm(loop)
        yield loop, truths


def _name(row: Topic[Any], data: bytes) -> str:
    """What `data` says the key's name is, if it can be one: the codec stops what differs, and all else behind it."""
    try:
        said = msgspec.msgpack.decode(data).get(row.names)
    except (AttributeError, msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        said = None
    return said if isinstance(said, str) and said and not set(said) & set("/*$#?") else "nobody"


def _deliver(loop: ClosedLoop, keyboard: KeyboardPolicy, row: Topic[Any] | Query[Any, Any], data: bytes) -> bool:
    """As `Node` does it with what arrives on a key."""
    try:
        message: Any
        key = row.key
        if isinstance(row, Query):
            message = msgspec.msgpack.decode(data, type=row.request)
        else:
            key = key.replace("*", _name(row, data))
            message = decode(row, key, data)
    except (DecodeError, msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return False
    deliver(loop, key, message)
    if isinstance(message, Tick):
        keyboard.operator.on_tick(message, loop.simulation.now_us * 1e-6)
    elif isinstance(message, Lease):
        keyboard.operator.on_lease(message)
    return True
