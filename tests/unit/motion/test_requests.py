"""Which requests begin a motion, and why others do not."""

import math
import re
from typing import Any

import msgspec
import pytest

from giraff_motion.config import MotionConfig
from giraff_schemas.messages import RobotTime
from giraff_schemas.motion import (
    Arc,
    GoTo,
    MotionArc,
    MotionCancel,
    MotionGo,
    MotionMove,
    MotionRequest,
    MotionTurn,
    Turn,
)
from tests.unit.motion.bench import Bench


@pytest.mark.parametrize(
    ("kind", "values", "words"),
    [
        (MotionMove, {"distance": 0.0}, "asks for no motion"),
        (MotionMove, {"distance": 2000.0}, "distance is 2000: it must be within -1000..1000 m; are these millimetres"),
        (MotionTurn, {"angle": 720.0}, "angle is 720: it must be within .*; are these degrees"),
        (MotionArc, {"radius": 0.0, "angle": 1.0}, "radius is 0: it must be within"),
        (MotionArc, {"radius": -1.0, "angle": 1.0}, "radius is -1: it must be within"),
        (MotionMove, {"distance": math.nan}, "nan"),
        (MotionMove, {"distance": 1.0, "speed": 3.0}, r"speed is 3: it must be within 0.06..0.6 m/s"),
        (MotionMove, {"distance": 1.0, "speed": 0.0}, r"speed is 0: it must be within"),
        (MotionTurn, {"angle": 1.0, "turn_speed": 30.0}, r"turn_speed is 30: it must be within"),
        (MotionMove, {"distance": 1.0, "time_limit": -1.0}, r"time_limit is -1: it must be within"),
        (MotionGo, {"steps": ()}, "asks for no motion"),
        (MotionGo, {"steps": (Turn(angle=1.0), Arc(radius=1e9, angle=1.0))}, "step 2: radius is"),
        (MotionGo, {"steps": (GoTo(x=5e5, y=0.0),)}, "the way to x, y is 500000"),
        (MotionGo, {"steps": (Turn(angle=1.0),) * 1001}, "these are 1001 steps"),
        (MotionMove, {"distance": 1.0, "id": 0}, "its id is 0"),
        (MotionMove, {"distance": 1.0, "instance": ""}, "its instance is empty"),
        (
            MotionMove,
            {"distance": 1.0, "tick": RobotTime(epoch=7, robot_ns=98_000_000_000)},
            "it was wished 2.2 s ago",
        ),
        (
            MotionMove,
            {"distance": 1.0, "tick": RobotTime(epoch=8, robot_ns=100_000_000_000)},
            "of another start of base",
        ),
        (MotionMove, {"distance": 1.0, "tick": RobotTime(epoch=7, robot_ns=101_000_000_000)}, "or of another robot"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_plain_words(
    bench: Bench, kind: type[MotionRequest], values: dict[str, Any], words: str
) -> None:
    answer = bench.ask(kind, **values)
    assert not answer.accepted
    assert re.search(words, str(answer.reason)), answer.reason
    bench.run(1.0)
    assert bench.said == []


def test_the_same_request_again_begins_nothing(bench: Bench) -> None:
    wish = bench.wish(MotionMove, distance=0.3)
    assert bench.policy.on_request(wish, bench.now).accepted
    assert bench.policy.on_request(wish, bench.now).accepted
    state = bench.finish()
    assert state.outcome == "arrived"
    assert bench.floor.pose.x == pytest.approx(0.3, abs=0.01)
    bench.run(0.5)
    count = len(bench.said)
    assert bench.policy.on_request(wish, bench.now).accepted  # the answer of the first time
    bench.run(2.0)
    assert (bench.state(), len(bench.said)) == (state, count)


def test_an_old_request_that_nobody_remembers_begins_nothing(bench: Bench) -> None:
    old = bench.wish(MotionMove, distance=0.3)
    bench.run(1.2)
    answer = bench.policy.on_request(old, bench.now)
    assert not answer.accepted
    assert "it was wished 1.2 s ago" in str(answer.reason)


def test_what_is_told_of_who_has_asked_is_not_longer_than_a_name(bench: Bench) -> None:
    bench.begin(MotionMove, distance=1.0, by="a" * 60_000)
    assert bench.state().by == "a" * 100
    bench.policy.on_cancel(MotionCancel(by="a" * 60_000), bench.now)
    assert len(str(bench.state().reason)) == 300


def test_a_request_with_a_word_that_is_not_known_is_none() -> None:
    wish = msgspec.structs.asdict(Bench().wish(MotionMove, distance=1.0))
    assert msgspec.convert(wish, MotionMove).distance == 1.0
    with pytest.raises(msgspec.ValidationError, match="sped"):
        msgspec.convert(wish | {"sped": 0.1}, MotionMove)


def test_it_is_refused_while_nobody_tells_who_drives(bench: Bench) -> None:
    bench.lease_is_told = False
    bench.run(1.2)
    assert "the guard is not heard" in bench.refused(MotionMove, distance=1.0)


def test_one_motion_at_a_time(bench: Bench) -> None:
    bench.begin(MotionMove, distance=5.0)
    assert "a motion of somebody goes on" in bench.refused(MotionTurn, angle=1.0)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"speed": 0.05}, "the least must not be more"),
        ({"least_turn_speed": 1.0}, "the least must not be more"),
        ({"patience": math.nan}, "patience is nan"),
    ],
)
def test_a_senseless_configuration_is_refused_in_clear_words(table: dict[str, Any], words: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=words):
        msgspec.convert(table, MotionConfig)
