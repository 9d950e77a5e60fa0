"""Where echoes came from, as odometry keeps it for a view that is opened late."""

from collections import defaultdict
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_core.io import Inbox
from giraff_core.kinematics.echoes import CELL, MOST_CELLS, Echoes
from giraff_odometry.config import OdometryConfig
from giraff_odometry.service import Odometry
from giraff_schemas.codec import encode
from giraff_schemas.messages import Odometry as Pose
from giraff_schemas.messages import Range, RangeState, RobotTime
from giraff_schemas.requests import EchoMap, OdomEchoes, OdomReset
from giraff_schemas.topics import ODOM_ECHOES, ODOM_RESET, RANGE, WHEELS
from tests.support.robots import ULTRASONIC
from tests.unit.odometry.robots import BOOTED_S, PERIOD_US, ROBOT, wheels

EPOCH = 3
LEFT = ULTRASONIC["front_left"]


def pose(at_ms: int, x: float, yaw: float = 0.0, jumps: int = 0) -> Pose:
    return Pose(
        instance="one",
        x=x,
        y=0.0,
        yaw=yaw,
        linear_x=0.0,
        angular_z=0.0,
        path=0.0,
        jumps=jumps,
        covariance=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        board_us=0,
        boot_id=1,
        tick=RobotTime(EPOCH, 1 + at_ms * 1_000_000),
    )


def echo(at_ms: int, distance: float | None, sensor: str = "front_left") -> Range:
    tick = RobotTime(EPOCH, 1 + at_ms * 1_000_000)
    state: RangeState = "clear" if distance is None else "echo"
    return Range(sensor=sensor, state=state, range=distance, echo_us=0, tick=tick)


@pytest.fixture
def echoes() -> Echoes:
    """A robot has driven 0.5 m ahead within 500 ms."""
    kept = Echoes(ULTRASONIC)
    for ms in range(0, 501, 10):
        kept.on_odometry(pose(ms, ms / 1000))
    return kept


def test_an_echo_is_placed_where_the_robot_was_when_it_was_measured(echoes: Echoes) -> None:
    assert echoes.add(echo(200, 1.0))
    assert not echoes.add(echo(200, 1.0)), "it is no other cell"
    x, y = LEFT.x + 0.2 + 1.0, LEFT.y
    assert echoes.points == [pytest.approx((x, y), abs=CELL / 2)]


@pytest.mark.parametrize(
    "reading",
    [echo(200, None), echo(900, 1.0), echo(200, 1.0, "nose"), msgspec.structs.replace(echo(200, 1.0), tick=None)],
    ids=["clear", "ahead of odometry", "unknown sensor", "without a moment"],
)
def test_what_has_no_place_is_left_out(echoes: Echoes, reading: Range) -> None:
    assert not echoes.add(reading)
    assert echoes.points == []


def test_a_pose_that_is_set_forgets_all_and_old_readings_stay_away(echoes: Echoes) -> None:
    echoes.add(echo(200, 1.0))
    assert echoes.on_odometry(pose(510, 0.0, jumps=1))
    assert not echoes.add(echo(200, 1.0)), "it was measured in the other frame"
    assert echoes.map("one") == EchoMap(instance="one", jumps=1, cell=CELL, columns=(), rows=())


def test_memory_and_answer_are_bounded_and_the_oldest_goes(echoes: Echoes) -> None:
    for number in range(MOST_CELLS + 10):
        echoes.add(echo(0, number * CELL))
    kept = echoes.map("one")
    assert len(kept.columns) == MOST_CELLS
    assert kept.columns[-1] - kept.columns[0] == MOST_CELLS - 1
    assert min(kept.columns) == round(LEFT.x / CELL) + 10
    assert len(encode(kept)) < 32_000


def test_cells_of_another_frame_are_not_taken(echoes: Echoes) -> None:
    echoes.add(echo(200, 1.0))
    earlier = echoes.map("one")
    late = Echoes(ULTRASONIC)
    assert not late.join(earlier), "nothing is known of the frame as yet"
    late.on_odometry(pose(900, 0.5))
    assert not late.join(msgspec.structs.replace(earlier, jumps=1))
    assert not late.join(msgspec.structs.replace(earlier, instance="two"))
    assert late.points == []
    assert late.join(earlier)
    assert late.points == echoes.points


def test_odometry_keeps_echoes_and_answers_who_asks() -> None:
    inboxes = defaultdict[str, Inbox[Any]](lambda: Inbox(200))
    io = MagicMock(instance="one")
    io.monotonic.return_value = 0.0
    io.inbox.side_effect = io.requests.side_effect = lambda row, **_: inboxes[row.key]
    service = Odometry(io, OdometryConfig(), ROBOT)

    def answer(query: Any, request: msgspec.Struct) -> Any:
        asked = SimpleNamespace(request=request, answer=MagicMock())
        inboxes[query.key].accept(asked)
        service.turn(0.0)
        return asked.answer.call_args.args[0]

    for step in range(11):
        inboxes[WHEELS.key].accept(wheels(20 * step, 20 * step, step * PERIOD_US))  # 0.1 m in 0.1 s
    heard = msgspec.structs.replace(echo(0, 1.0), tick=RobotTime(EPOCH, round((BOOTED_S + 0.05) * 1e9)))
    inboxes[RANGE.key].accept(heard)
    kept = answer(ODOM_ECHOES, OdomEchoes(by="ann"))
    assert (kept.instance, kept.jumps, len(kept.columns)) == ("one", 0, 1)
    assert kept.columns[0] * CELL == pytest.approx(LEFT.x + 0.05 + 1.0, abs=CELL / 2)
    answer(ODOM_RESET, OdomReset(by="ann", id=1))
    inboxes[WHEELS.key].accept(wheels(220, 220, 11 * PERIOD_US))
    kept = answer(ODOM_ECHOES, OdomEchoes(by="ann"))
    assert (kept.jumps, kept.columns) == (1, ())


def test_an_echo_from_beyond_every_room_is_none() -> None:
    """One such reading ended a view, and an answer that no integer holds ended odometry's turn."""
    echoes = Echoes(ULTRASONIC)
    echoes.on_odometry(pose(0, 0.0))
    assert [echoes.add(echo(0, distance)) for distance in (1e19, 1e308)] == [False, False]
    assert echoes.points == []
